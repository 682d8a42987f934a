"""LaTeX of the derivations as HTML, with formulas in MathML: what a browser shows without any script.

It reads what `symosc derive` writes, not LaTeX in general: sections, paragraphs, and `align` with one formula a row.
"""

from __future__ import annotations

import re
from html import escape

from latex2mathml.converter import convert

DISPLAY = re.compile(r"(.*?)\\begin\{align\}\n(.*?)\n\\end\{align\}", re.DOTALL)
HEADING = re.compile(r"\\(section|subsection)\{(.*)\}")
TAG = re.compile(r" ?\\tag\{([\d.]+)\\,\\textsc\{(\w)\}\}")
# A remark at the end of a row is words, which a browser can break.
REMARK = re.compile(r" ?(?:\\quad ?)?\\text\{((?:[^{}$]|\$[^$]*\$)*)\}$")
FUNCTION = "<m[io]>(?:sin|cos|sinh|cosh|arcsin|det)</m[io]>"
SPACE = '<mspace width="0.17em" />'
KINDS = {"e": "exact", "s": "sign", "n": "numeric"}
WORDS = {"emph": "em", "textbf": "strong", "texttt": "code"}


def chapter_html(latex: str, level: int = 3) -> str:
    """Return a chapter of derivations, given as LaTeX; `level` is that of its sections' headings.

    The chapter's own heading is left out. A formula's number is a link target, `step-4.2` for 4.2.
    """
    blocks = []
    for block in latex.split("\n\n"):
        lines = "\n".join(line for line in block.splitlines() if not line.startswith("%"))
        heading, display = HEADING.fullmatch(lines), DISPLAY.fullmatch(lines)
        if heading:
            blocks += [f"<h{level}>{words(heading[2])}</h{level}>"] if heading[1] == "subsection" else []
        elif display:
            blocks += [f"<p>{words(display[1].strip())}</p>"] if display[1].strip() else []
            rows = "\n".join(_row(row) for row in display[2].split(" \\\\\n"))
            blocks.append(f'<div class="wide"><table class="steps">\n{rows}\n</table></div>')
        else:
            blocks.append(f"<p>{words(lines)}</p>")
    return "\n".join(blocks)


def words(text: str) -> str:
    """Return a paragraph of LaTeX, with formulas between dollars, as HTML."""
    parts = text.split("$")
    html = "".join(formula(part) if odd % 2 else _plain(part) for odd, part in enumerate(parts))
    # No line begins with the comma after a formula.
    return re.sub(r"(<math(?:(?!<math).)*</math>[,.;:)]+)", r'<span class="tight">\1</span>', html)


def formula(latex: str, display: bool = False) -> str:
    """Return a formula as MathML."""
    # A bar that stands for "taken at" has no partner; the converter would look for one.
    mathml: str = convert(latex.strip().replace(r"\,|_", r"\vert_"))
    # Named functions need a space between them and a letter; capital Greek stands upright; accents sit on their letter.
    mathml = re.sub(rf"({FUNCTION})(?=<m[ifs])", r"\1" + SPACE, mathml)
    mathml = re.sub(rf"(</mi>|</msup>|</msub>|</mfrac>)(?={FUNCTION})", r"\1" + SPACE, mathml)
    mathml = re.sub(r"<mi>(?=&#x003(?:9[1-9A-F]|A[0-9]);)", '<mi mathvariant="normal">', mathml)
    mathml = mathml.replace("<mover>", '<mover accent="true">')
    return mathml.replace('display="inline"', 'displaystyle="true"' if display else "", 1)


def _row(row: str) -> str:
    tag = TAG.search(row)
    row = TAG.sub("", row).replace(r" \notag", "")
    remark = REMARK.search(row)
    left, _, right = REMARK.sub("", row).partition("&")
    after = f' <span class="remark">{words(remark[1])}</span>' if remark else ""
    label = f"({tag[1]}&nbsp;{tag[2]})" if tag else ""
    anchor = f' id="step-{tag[1]}"' if tag else ""
    title = f' title="{KINDS[tag[2]]}"' if tag else ""
    sides = [formula(side, display=True) if side.strip() else "" for side in (left, right)]
    return f"<tr{anchor}><td>{sides[0]}</td><td>{sides[1]}{after}</td><td{title}>{label}</td></tr>"


def _plain(text: str) -> str:
    text = escape(text, quote=False)
    for command, element in WORDS.items():
        text = re.sub(rf"\\{command}\{{([^{{}}]*)\}}", rf"<{element}>\1</{element}>", text)
    text = text.replace("--", "–").replace("~", "&nbsp;").replace(r"\'o", "ó").replace("\\ ", " ")
    return text.replace("``", "“").replace("''", "”")
