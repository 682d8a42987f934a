"""The paper's claims, recomputed and judged; its figures, as printed and corrected; and the report on both.

claims are data (TOML), checks compute the evidence, pictures and drawings draw, run and report put all together.
May import: everything but cli.

One more claim: an entry in claims, and a function in checks that returns an Evidence.
"""
