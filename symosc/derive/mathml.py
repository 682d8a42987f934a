"""LaTeX text and formulas as HTML and MathML: what a browser shows without any script.

It reads what the chapters write, not LaTeX in general.
"""

from __future__ import annotations

import re
from base64 import b64encode
from functools import cache
from html import escape
from pathlib import Path

from latex2mathml.converter import convert

FUNCTION = "<m[io]>(?:sin|cos|sinh|cosh|coth|arcsin|det)</m[io]>"
SPACE = '<mspace width="0.17em" />'
WORDS = {"emph": "em", "textbf": "strong", "texttt": "code", "textsc": "small"}
ITEMS = re.compile(r"\\begin\{(enumerate|itemize)\}(.*?)\\end\{\1\}", re.DOTALL)
ITEM = re.compile(r"\\item(?:\[([^\]]*)\])?\s*")
ITEM_MARK = r"\\LIST \1 "
#: Ends of a list that a display divides: its parts are paragraphs, each with its number.
DIVIDED = re.compile(r"\\(?:begin|end)\{(?:enumerate|itemize)\}")
LINK = re.compile(r"\\hyperlink\{([^{}]*)\}\{([^{}]*)\}")
#: Letters of a name that a user chose, as `latex_text` writes them.
LETTER = re.compile(r"\\symbol\{(\d+)\}|\\letter\{(\d+)\}\{\w+\}")
KEPT = "\ue000"  # in their place while the rest is read
# MathML has no sizes of brackets that are set by hand: they grow by themselves.
SIZES = re.compile(r"\\(?:bigg|Bigg|big|Big)[lr]?(?![a-z])")


#: A font for formulas: without one browsers show dots over letters too small to count, and brackets
#: that do not grow.
FONT_NAME = "Symosc Math"
FONT_FILE = Path(__file__).parent / "fonts" / "symosc-math.woff2"


@cache
def font_style() -> str:
    """Return CSS that embeds the math font shipped with the package, so that a page needs no other
    file.
    """
    data = b64encode(FONT_FILE.read_bytes()).decode()
    face = f'font-family: "{FONT_NAME}"; src: url("data:font/woff2;base64,{data}") format("woff2");'
    return (
        f'@font-face {{ {face} }}\nmath {{ font-family: "{FONT_NAME}", math; font-size: 1.15em; '
        f"}}\n"
    )


def words(text: str) -> str:
    """Return a paragraph of LaTeX, with formulas between dollars, as HTML."""
    letters = [chr(int(match[1] or match[2])) for match in LETTER.finditer(text)]
    text = LETTER.sub(KEPT, text)
    text = ITEMS.sub(
        lambda match: rf"\OPENLIST {ITEM.sub(ITEM_MARK, match[2].strip())} \CLOSELIST", text
    )
    text = ITEM.sub(r"\1 ", DIVIDED.sub("", text))
    # Pieces of text and formulas alternate between the dollars.
    pieces = enumerate(text.split("$"))
    html = "".join(formula(piece) if i % 2 else _plain_text(piece) for i, piece in pieces)
    # No line begins with the comma after a formula.
    html = re.sub(r"(<math(?:(?!<math).)*</math>[,.;:)]+)", r'<span class="tight">\1</span>', html)
    remaining_letters = iter(letters)
    return re.sub(KEPT, lambda _: escape(next(remaining_letters), quote=False), html)


def formula(latex: str, display: bool = False) -> str:
    """Return a LaTeX formula as MathML, displayed or inside a line."""
    # A bar that stands for "taken at" has no partner; the converter would look for one.
    latex = SIZES.sub("", latex.strip().replace(r"\,|_", r"\vert_").replace("}|_", r"}\vert_"))
    mathml: str = convert(latex)
    # Named functions need a space between them and a letter; capital Greek stands upright; accents
    # sit on their letter.
    mathml = re.sub(rf"({FUNCTION})(?=<m[ifs])", r"\1" + SPACE, mathml)
    mathml = re.sub(rf"(</mi>|</msup>|</msub>|</mfrac>)(?={FUNCTION})", r"\1" + SPACE, mathml)
    mathml = re.sub(r"<mi>(?=&#x003(?:9[1-9A-F]|A[0-9]);)", '<mi mathvariant="normal">', mathml)
    mathml = mathml.replace("<mover>", '<mover accent="true">')
    return mathml.replace('display="inline"', 'displaystyle="true"' if display else "", 1)


def _plain_text(text: str) -> str:
    """Return HTML of a text outside formulas: its LaTeX commands as elements, dashes and quotes as
    signs.
    """
    text = escape(text.replace("-{}-", "\0"), quote=False)
    for command, element in WORDS.items():
        text = re.sub(rf"\\{command}\{{([^{{}}]*)\}}", rf"<{element}>\1</{element}>", text)
    text = LINK.sub(r'<a href="#\1">\2</a>', text)
    text = (
        text.replace(r"\LIST", "<li>").replace(r"\OPENLIST", "<ul>").replace(r"\CLOSELIST", "</ul>")
    )
    text = (
        text.replace("--", "–")
        .replace("\0", "--")
        .replace("~", "&nbsp;")
        .replace(r"\'o", "ó")
        .replace(r"{\o}", "ø")
        .replace(r"\o ", "ø")
        .replace("\\ ", " ")
    )
    return text.replace("``", "“").replace("''", "”")
