"""What `symosc grazing --solve` prints: for which values of one parameter, or of two, a window has a property."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from symosc.aliases import Order
from symosc.cli.output import write, write_json
from symosc.display.progress import late_bar
from symosc.mappings.theorem7_cases import place

if TYPE_CHECKING:
    from symosc.model import Parameters


def solve(
    p: Parameters | None,
    mappings: list[str],
    names: str,
    phases: str | None,
    order: Order,
    *,
    as_latex: bool = False,
    as_json: bool = False,
    output: str | None = None,
    piped: bool = False,
) -> None:
    """Print the answers for all mappings, and draw one that is a region; p = None asks with letters."""
    asked = read_names(names)
    if p is None and not isinstance(asked, str):
        raise click.UsageError("--solve NAME,NAME needs numbers: give a SCENE, or every parameter by --set")
    if output is not None and (p is None or isinstance(asked, str) or phases is None or len(mappings) != 1):
        raise click.UsageError("--solve --plot draws one region: give numbers, NAME,NAME, one --map and --phase")
    asked_of, found = _depending(mappings, asked), []
    with late_bar(True, "solve", "maps") as advance:
        for count, mapping in enumerate(asked_of, start=1):
            found += _answers(p, mapping, asked, phases, order)
            if advance:
                advance(count / len(asked_of), count)
    if output is not None:
        _draw(found[0], output)
    if piped:
        return
    if as_json:
        write_json(
            {"parameters": None if p is None else p.as_dict(), "order": order, "answers": list(map(_data, found))}
        )
        return
    for answer in found:
        write(answer.latex() if as_latex else answer.text())


def _draw(answer: Any, output: str) -> None:
    from symosc.plot.drawing import check_suffix, save

    check_suffix(output)
    save(answer.plot(), output)


def read_names(text: str) -> Any:
    """Return the name, or the pair of names, of the option ``--solve``."""
    names = [name.strip() for name in text.split(",")]
    if not all(names) or len(names) > 2:
        raise click.BadParameter(f"{text!r} is not NAME or NAME,NAME, such as Omega", param_hint="--solve")
    return names[0] if len(names) == 1 else tuple(names)


def read_phase_option(text: str | None) -> Any:
    """Return the phase, or the pair (low, high), of the option ``--phase``."""
    if text is None:
        return None
    low, colon, high = text.partition(":")
    if colon and not (low.strip() and high.strip()):
        raise click.BadParameter(f"{text!r} is not PHASE or LOW:HIGH, such as pi:3*pi/2", param_hint="--phase")
    return (low, high) if colon else text


def _depending(mappings: list[str], asked: Any) -> list[str]:
    """Return the given mappings; all that depend on what is asked if none is given."""
    if mappings:
        return mappings
    names = (asked,) if isinstance(asked, str) else asked
    belts = {name for name in names if name in ("v1", "v2")}
    every = ("P2", "P3", "P5", "P6")
    return [mapping for mapping in every if belts <= {f"v{place(mapping).boundary}"}] or list(every)


def _answers(p: Parameters | None, mapping: str, asked: Any, phases: str | None, order: Order) -> list[Any]:
    from symosc.symbolic.inverse import values_containing, values_empty, values_everything

    if phases is not None:
        return [values_containing(p, mapping, asked, read_phase_option(phases), order)]
    return [values_empty(p, mapping, asked), values_everything(p, mapping, asked, order)]


def _data(answer: Any) -> dict[str, Any]:
    from symosc.symbolic.inverse import Answers, ParameterRegion, condition_text, interval_text

    question = answer.question
    data: dict[str, Any] = {"map": question.mapping, "names": list(question.names), "question": question.text()}
    if isinstance(answer, Answers):
        data["answers"] = [
            {"condition": condition_text(each.condition), "values": interval_text(each.values)} for each in answer
        ]
    elif isinstance(answer, ParameterRegion):
        data |= {"condition": condition_text(answer.condition), "allowed": condition_text(answer.allowed)}
    else:
        data["values"] = interval_text(answer.values)
    return data | {"latex": answer.latex()}
