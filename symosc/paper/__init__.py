"""The paper's claims, recomputed and judged; its figures, as printed and corrected; and the report
on both.

claims.toml has the statements, claims reads them, checks compute the evidence, pictures and figures
draw, run does all of it in processes, report puts it together.
"""
