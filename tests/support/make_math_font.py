"""Make the font of the formulas in HTML.

`python tests/support/make_math_font.py latinmodern-math.otf`.

A part of Latin Modern Math (Debian: fonts-lmodern), under another name as its license asks. Needs
fonttools and brotli.
"""

from __future__ import annotations

import sys

from fontTools import subset

from symosc.derive.mathml import FONT_FILE, FONT_NAME

LETTERS = [
    (0x20, 0x7E),
    (0x391, 0x3A1),
    (0x3A3, 0x3A9),
    (0x3B1, 0x3C9),
    (0x1D41A, 0x1D433),
    (0x1D434, 0x1D467),
]
LETTERS += [
    (0x1D6E2, 0x1D71B),
    (0x300, 0x304),
    (0x306, 0x308),
    (0x2C6, 0x2C7),
    (0x2D8, 0x2DC),
    (0x2061, 0x2064),
]
SIGNS = "\u00a0¨¬¯±´·×÷ϕϵϑ‖…′″‴ℓℎℝ𝒯←↑→↓↔↦⇒⇔∀∂∃∅∆∇∈∉∏∑−∓∖∘√∝∞∣∥∧∨∩∪∫∼≈≠≡≤≥≪≫⊂⊆⋅⋮⋯⌈⌉⌊⌋⟨⟩□■–—"


def make(source: str) -> None:
    """Write the font that is shipped."""
    options = subset.Options(
        flavor="woff2", layout_features=["ssty", "dtls", "flac"], hinting=False, name_IDs=["*"]
    )
    font = subset.load_font(source, options)
    part = subset.Subsetter(options)
    part.populate(
        text=SIGNS, unicodes=[code for low, high in LETTERS for code in range(low, high + 1)]
    )
    part.subset(font)
    names = {1: FONT_NAME, 4: FONT_NAME, 6: FONT_NAME.replace(" ", ""), 16: FONT_NAME}
    for record in font["name"].names:
        if record.nameID in names:
            record.string = names[record.nameID]
    font["CFF "].cff.fontNames = [names[6]]
    for key in ("FullName", "FamilyName"):
        setattr(font["CFF "].cff.topDictIndex[0], key, FONT_NAME)
    subset.save_font(font, str(FONT_FILE), options)


if __name__ == "__main__":
    make(sys.argv[1])
