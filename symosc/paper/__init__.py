"""The paper's claims, recomputed and judged; its figures, as printed and corrected."""
