"""Speed beside error: this package's own, and other people's solvers on the same scenes."""
