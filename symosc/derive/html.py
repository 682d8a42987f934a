"""Checked chapters as HTML: a piece for a report, or a page of its own. Formulas are MathML."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterable, Sequence

from symosc.derive import citation, front
from symosc.derive.document import MARKS, Checked, NumberedStep, cell, resolved, rows, texts
from symosc.derive.figures import svg
from symosc.derive.mathml import font_style, formula, words
from symosc.derive.notation import HEADS, NOTATION
from symosc.derive.scope import Scope
from symosc.derive.steps import Begin, End, Heading, Illustration, Prose, Table

ToHtml = Callable[[str], str]
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


def page(chapters: list[Checked], scope: Scope, numbers: dict[str, str]) -> str:
    """Return chapters as one file that needs no other."""
    html = _converter(numbers)
    title = html(front.TITLE)
    contents = "".join(
        f'<li value="{each.number}"><a href="#sec-{each.number}">{html(each.title)}</a></li>' for each in chapters
    )
    opening = [front.ABSTRACT, front.LEGEND, front.how_to_cite(), front.scene_numbers(scope)]
    out = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>',
        '<meta name="viewport" content="width=device-width">',
        f"<style>{STYLE}{font_style()}</style></head><body>",
        f"<h1>{title}</h1>",
        *(_paragraph(html(text)) for text in opening if text),
        f"<h2>Contents</h2><ol>{contents}</ol>",
    ]
    if len(chapters) > 1:
        out.append(f'<h2 id="notation">Notation</h2>\n{_cells(HEADS, NOTATION, html)}')
    for each in chapters:
        heading = f'<h2 id="sec-{each.number}">{each.number}. {html(each.title)}</h2>'
        out += [heading, chapter(each, scope, numbers, 3)]
    cited = citation.cited("".join(opening) + texts(chapters))
    items = "".join(f'<li id="ref-{key}">{words(citation.plain_line(key))}</li>' for key in cited)
    out += [f"<h2>References</h2><ul>{items}</ul>", "</body></html>"]
    return "\n".join(out) + "\n"


def chapter(checked: Checked, scope: Scope, numbers: dict[str, str], level: int) -> str:
    """Return a chapter without its title; `level` is that of its headings. Formula 4.2 has the anchor step-4.2."""
    html, counts = _converter(numbers), dict.fromkeys(("thm", "tab", "fig"), 0)
    out = []

    def next_number(kind: str) -> str:
        counts[kind] += 1
        return f"{checked.number}.{counts[kind]}"

    for part in checked.grouped():
        if isinstance(part, list):
            out.append(_display(part, scope, html))
            continue
        item, mark = part.item, f' <sup class="checked">{part.marks}</sup>' if part.evidence else ""
        if isinstance(item, Heading):
            out.append(f"<h{level}>{html(item.text)}</h{level}>")
        elif isinstance(item, Prose):
            out.append(_paragraph(f"{html(item.text)}{mark}"))
        elif isinstance(item, Begin):
            title = f" ({html(item.title)})" if item.title else ""
            if item.kind == "proof":
                out.append(f'<div class="proof"><em>Proof{title}.</em>')
                continue
            name = next_number("thm")
            opening = f"<strong>{item.kind.title()} {name}{title}.</strong>"
            out.append(f'<div class="statement" id="thm-{name}">{opening}')
        elif isinstance(item, End):
            out.append("</div>")
        elif isinstance(item, Table):
            name = next_number("tab")
            caption = f'<p id="tab-{name}"><strong>Table {name}.</strong> {html(item.caption)}{mark}</p>'
            body = [[cell(value, scope) for value in row] for row in item.rows]
            out.append(f"{caption}\n{_cells(item.heads, body, html)}")
        elif isinstance(item, Illustration):
            name = next_number("fig")
            source = b64encode(svg(item.key).encode()).decode()
            image = f'<img src="data:image/svg+xml;base64,{source}" alt="Figure {name}">'
            caption = f"<figcaption><strong>Figure {name}.</strong> {html(item.caption)}</figcaption>"
            out.append(f'<figure id="fig-{name}"><div class="wide">{image}</div>{caption}</figure>')
    return "\n".join(out)


def _converter(numbers: dict[str, str]) -> ToHtml:
    """Return what turns LaTeX text into HTML, references into links, citations into brackets."""

    def link(label: str, shown: str) -> str:
        kind, number = label.partition(":")[0], shown.strip("()")
        return rf"\hyperlink{{{'step' if kind == 'eq' else kind}-{number}}}{{{shown}}}"

    def html(text: str) -> str:
        text = resolved(text, numbers, link)
        return words(citation.CITATION.sub(lambda found: f"[{found[2]}{', ' + found[1] if found[1] else ''}]", text))

    return html


def _display(display: list[NumberedStep], scope: Scope, html: ToHtml) -> str:
    body = []
    for lines, each in rows(display, scope):
        note = each.step.note
        for line in lines:
            if note:
                line = line.replace(rf" \quad\text{{{note}}}", "").replace(rf"&\quad \text{{{note}}}", "&")
            left, _, right = line.partition("&")
            sides = [formula(side, display=True) if side.strip() else "" for side in (left, right)]
            body.append(f"<tr><td>{sides[0]}</td><td>{sides[1]}</td><td></td></tr>")
        # The last line has the note and the number.
        remark = f' <span class="remark">{html(note)}</span>' if note else ""
        label = f'<td title="{each.evidence.kind}">({each.number}&nbsp;{MARKS[each.evidence.kind]})</td>'
        body[-1] = f'<tr id="step-{each.number}"><td>{sides[0]}</td><td>{sides[1]}{remark}</td>{label}</tr>'
    return '<div class="wide"><table class="steps">\n' + "\n".join(body) + "\n</table></div>"


def _cells(heads: Sequence[str], body: Iterable[Sequence[str]], html: ToHtml) -> str:
    top = "".join(f"<th>{html(head)}</th>" for head in heads)
    lines = "\n".join("<tr>" + "".join(f"<td>{html(value)}</td>" for value in row) + "</tr>" for row in body)
    return f'<div class="wide"><table class="cells">\n<tr>{top}</tr>\n{lines}\n</table></div>'


def _paragraph(text: str) -> str:
    """Return a paragraph; one with formulas scrolls where the window is narrower than a formula."""
    return f'<p class="wide">{text}</p>' if "<math" in text else f"<p>{text}</p>"
