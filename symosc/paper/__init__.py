"""The paper's claims, recomputed and judged; its figures, as printed and corrected; and the report on both.

claims and errata are data (TOML), checks compute the evidence, coverage tells what of the paper they are on, pictures,
drawings and oscillator draw, run, report and letter put all together.
May import: everything but cli.

One more claim: an entry in claims, and a function in checks that returns an Evidence.
"""
