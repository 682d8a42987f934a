"""The checks: each returns an Evidence, and is called by the claims that name it in claims.toml."""
