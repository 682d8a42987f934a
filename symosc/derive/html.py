"""Checked chapters as HTML: a piece for a report, or a page of its own. Formulas are MathML."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable
from typing import Any

from symosc.derive import bibliography, front, notation
from symosc.derive.blocks import KINDS, Begin, End, Illustration, Table
from symosc.derive.displays import Display, cell, grouped, marks, rows
from symosc.derive.figures import svg
from symosc.derive.mathml import font_style, formula, words
from symosc.derive.numbering import CITATION, Numbering, resolved
from symosc.derive.scope import Scope
from symosc.derive.steps import Heading, Prose

Words = Callable[[str], str]
STYLE = """
body { font: 1.05rem/1.55 Georgia, serif; max-width: 54rem; margin: 2rem auto; padding: 0 1rem; color: #111; }
h1 { line-height: 1.2; } h2 { margin-top: 2.6rem; }
.steps, .cells { border-collapse: collapse; margin: .6rem 0; }
.steps td { padding: .2rem .3rem; vertical-align: middle; } .steps td:first-child { text-align: right; }
.steps td:last-child { white-space: nowrap; padding-left: 1.5rem; color: #555; }
.cells { border-top: 1px solid; border-bottom: 1px solid; font-size: .95em; }
.cells th { border-bottom: 1px solid; text-align: left; } .cells td, .cells th { padding: .3rem .7rem .3rem 0; }
.statement { border-left: 3px solid #999; padding-left: .9rem; margin: 1rem 0; } .proof { padding-left: .9rem; }
.wide { overflow: auto hidden; padding-bottom: .2em; }
figure { margin: 1.2rem 0; } figure img { max-width: 100%; height: auto; }
sup.checked { font-variant: small-caps; color: #555; } .tight { white-space: nowrap; }
"""


def page(chapters: list[Any], scope: Scope, numbers: Numbering) -> str:
    """Return chapters as one file that needs no other."""
    said = _speaker(numbers)
    title = said(front.TITLE)
    contents = "".join(
        f'<li value="{each.number}"><a href="#sec-{each.number}">{said(each.title)}</a></li>' for each in chapters
    )
    texts = [front.ABSTRACT, front.LEGEND, front.how_to_cite(), front.scene_numbers(scope)]
    out = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
        '<meta name="viewport" content="width=device-width">',
        f"<style>{STYLE}{font_style()}</style></head><body>",
        f"<h1>{title}</h1>",
        *(_paragraph(said(text)) for text in texts if text),
        f"<h2>Contents</h2><ol>{contents}</ol>",
    ]
    if len(chapters) > 1:
        out.append(f'<h2 id="notation">Notation</h2>\n{_cells(notation.HEADS, notation.rows(), said)}')
    for each in chapters:
        heading = f'<h2 id="sec-{each.number}">{each.number}. {said(each.title)}</h2>'
        out += [heading, chapter(each, scope, numbers, 3)]
    cited = bibliography.cited("".join(texts) + _latex(chapters, scope))
    items = "".join(f'<li id="ref-{key}">{words(bibliography.plain_line(key))}</li>' for key in cited)
    out += [f"<h2>References</h2><ul>{items}</ul>", "</body></html>"]
    return "\n".join(out) + "\n"


def _latex(chapters: list[Any], scope: Scope) -> str:
    from symosc.derive.latex_pages import chapter as latex_chapter

    return "".join(latex_chapter(each, scope, Numbering([(each.key, each.items)])) for each in chapters)


def chapter(checked: Any, scope: Scope, numbers: Numbering, level: int) -> str:
    """Return a chapter without its title; `level` is that of its headings. Formula 4.2 has the anchor step-4.2."""
    said, counts = _speaker(numbers), [0, 0, 0]
    out = []
    for part in grouped(checked):
        if isinstance(part, Display):
            out.append(_display(part, scope, said))
            continue
        item, sup = part.item, f' <sup class="checked">{marks(part)}</sup>' if part.evidence else ""
        if isinstance(item, Heading):
            out.append(f"<h{level}>{said(item.text)}</h{level}>")
        elif isinstance(item, Prose):
            out.append(_paragraph(f"{said(item.text)}{sup}"))
        elif isinstance(item, Begin):
            out.append(_opening(item, checked.number, counts, said))
        elif isinstance(item, End):
            out.append("</div>")
        elif isinstance(item, Table):
            counts[1] += 1
            name = f"{checked.number}.{counts[1]}"
            caption = f'<p id="tab-{name}"><strong>Table {name}.</strong> {said(item.caption)}{sup}</p>'
            body = [[cell(value, scope) for value in row] for row in item.rows]
            out.append(f"{caption}\n{_cells(item.heads, body, said)}")
        elif isinstance(item, Illustration):
            counts[2] += 1
            out.append(_figure(item, f"{checked.number}.{counts[2]}", said))
    return "\n".join(out)


def _speaker(numbers: Numbering) -> Words:
    """Return what turns LaTeX text into HTML, references into links, citations into brackets."""

    def link(label: str, shown: str) -> str:
        kind, number = label.partition(":")[0], shown.strip("()")
        return rf"\hyperlink{{{'step' if kind == 'eq' else kind}-{number}}}{{{shown}}}"

    def said(text: str) -> str:
        text = resolved(text, numbers, link)
        return words(CITATION.sub(lambda found: f"[{found[2]}{', ' + found[1] if found[1] else ''}]", text))

    return said


def _opening(item: Begin, number: int, counts: list[int], said: Words) -> str:
    title = f" ({said(item.title)})" if item.title else ""
    if item.kind == "proof":
        return f'<div class="proof"><em>Proof{title}.</em>'
    counts[0] += 1
    name = f"{number}.{counts[0]}"
    return f'<div class="statement" id="thm-{name}"><strong>{KINDS[item.kind]} {name}{title}.</strong>'


def _display(display: Display, scope: Scope, said: Words) -> str:
    lines = [_row(line, each, last, said) for row, each in rows(display, scope) for line, last in _last(row)]
    reason = f"{_paragraph(said(display.reason))}\n" if display.reason else ""
    body = "\n".join(lines)
    return f'{reason}<div class="wide"><table class="steps">\n{body}\n</table></div>'


def _last(lines: list[str]) -> list[tuple[str, bool]]:
    return [(line, line is lines[-1]) for line in lines]


def _row(line: str, each: Any, last: bool, said: Words) -> str:
    note = each.step.note
    if note:
        line = line.replace(rf" \quad\text{{{note}}}", "").replace(rf"&\quad \text{{{note}}}", "&")
    left, _, right = line.partition("&")
    sides = [formula(side, display=True) if side.strip() else "" for side in (left, right)]
    remark = f' <span class="remark">{said(note)}</span>' if note and last else ""
    if not last:
        return f"<tr><td>{sides[0]}</td><td>{sides[1]}</td><td></td></tr>"
    label = f'<td title="{each.evidence.kind}">({each.number}&nbsp;{each.mark})</td>'
    return f'<tr id="step-{each.number}"><td>{sides[0]}</td><td>{sides[1]}{remark}</td>{label}</tr>'


def _cells(heads: Any, body: Any, said: Words) -> str:
    top = "".join(f"<th>{said(head)}</th>" for head in heads)
    lines = "\n".join("<tr>" + "".join(f"<td>{said(value)}</td>" for value in row) + "</tr>" for row in body)
    return f'<div class="wide"><table class="cells">\n<tr>{top}</tr>\n{lines}\n</table></div>'


def _figure(item: Illustration, number: str, said: Words) -> str:
    source = b64encode(svg(item.key).encode()).decode()
    image = f'<img src="data:image/svg+xml;base64,{source}" alt="Figure {number}">'
    caption = f"<figcaption><strong>Figure {number}.</strong> {said(item.caption)}</figcaption>"
    return f'<figure id="fig-{number}"><div class="wide">{image}</div>{caption}</figure>'


def _paragraph(text: str) -> str:
    """Return a paragraph; one with formulas scrolls where the window is narrower than a formula."""
    return f'<p class="wide">{text}</p>' if "<math" in text else f"<p>{text}</p>"
