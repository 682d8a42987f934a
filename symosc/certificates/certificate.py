"""The result of a proof: an object with a short repr, and a JSON file that `symosc verify` proves
again.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

from symosc.base.aliases import Record
from symosc.base.arguments import public
from symosc.base.display.drawable import Drawable
from symosc.base.exact import show
from symosc.base.files import write_text
from symosc.model import OSCILLATOR_NAMES, PARAMETER_NAMES, Model, Parameters

#: The format that every certificate file names.
FORMAT = "symosc certificate 1"
#: Digits of an enclosure's middle that are shown.
SHOWN_DIGITS = 17
STARTS = ("t0", "x0", "v0")
#: What a file calls the passage of a corner in place of the kind of an event.
CORNER = "corner"


def provable(p: Parameters, v0: Fraction) -> tuple[str, ...]:
    """Return the parameters and start values by which `certify` can prove derivatives (`wrt`), if
    `v0` is as given.
    """
    # What takes a start off its belt; k, and c too, where they are 0; what an undamped resonance
    # depends on.
    left_out = [name for n in p.law.boundaries if v0 == p.belt(n) for name in (f"v{n}", "v0")]
    if p.k == 0:
        if p.c == 0:
            left_out += ["k", "c"]
        else:
            left_out += ["k"]
    elif p.c == 0 and p.k == p.m * p.Omega**2 and p.B0:
        left_out += ["m", "c", "k", "Omega"]
    return tuple(name for name in (*PARAMETER_NAMES, *STARTS) if name not in left_out)


def oscillator_entry(p: Model) -> Record:
    """Return the entry `parameters` of a file: the eleven numbers, or a law with its belts."""
    if isinstance(p, Parameters):
        return dict(p.as_dict())
    return law_entry(p)


def law_entry(p: Model) -> Record:
    """Return the entry `parameters` of a file about any law: the numbers of all belts in a list."""
    entry: Record = {name: show(getattr(p, name)) for name in OSCILLATOR_NAMES}
    entry["belts"] = [
        {
            "v": show(belt.v),
            "curve": [[show(w), show(mu)] for w, mu in belt.curve or ((Fraction(0), belt.mu),)],
            "slope": show(belt.slope),
            "mu_s": show(belt.mu if belt.mu_s is None else belt.mu_s),
        }
        for belt in p.law.belts
    ]
    return entry


@dataclass(frozen=True, repr=False)
class Certificate(Drawable):
    """A proven statement, with enclosures rounded outward.

    Attributes
    ----------
    kind : str
        "trajectory", "orbit", "branch", "window" or "atlas"; "settled" for a trajectory that is
        proven to settle on an orbit.
    proven : bool
        Whether all of it is proven.
    message : str
        What is proven, in the words of the checker; otherwise what could not be proven, and where.
    events : tuple
        The proven events: (kind, source, target, (t_low, t_high), (x_low, x_high)), the numbers as
        decimals. Of a trajectory that settles, those of its last periods only. Corners of a
        friction curve are no events; the file has them.
    points, multipliers : tuple
        Of an orbit: enclosures of the switching points, and of the multipliers.
    stable : bool or None
        Of an orbit: whether it is stable; None if that is undecided.
    statement : dict
        What the file says: exact input as rational numbers, enclosures as decimals.
    derivatives : tuple
        With ``certify(wrt=...)``: for each event enclosures of its dt and of its dx by all names.

    Examples
    --------
    >>> from symosc import certify
    >>> certify("fig6")
    <Certificate of a trajectory: proven, 3 events>
    >>> kind, source, target, (t_low, t_high), x = certify("fig6").events[0]
    >>> kind, source, target, t_low[:12], t_high[:12]
    ('slip', 'belt2', 'Omega2', '1.5826058214', '1.5826058214')
    """

    _drawn_by = "certificate_figure"
    _made_by = "certify(...)"

    kind: str
    proven: bool
    message: str
    events: tuple[Any, ...] = ()
    points: tuple[Any, ...] = ()
    multipliers: tuple[Any, ...] = ()
    stable: bool | None = None
    statement: Record = field(default_factory=dict)
    derivatives: tuple[Any, ...] = ()

    def as_dict(self) -> Record:
        """Return the contents of the file written by `to_json`."""
        about = {
            "format": FORMAT,
            "kind": self.kind,
            "proven": self.proven,
            "message": self.message,
        }
        return about | self.statement

    @public
    def to_json(self, path: str | Path) -> None:
        """Write the certificate as JSON ("-": to standard output).

        OutputError if it cannot be written.
        """
        write_text(path, json.dumps(self.as_dict(), indent=1) + "\n")

    def __repr__(self) -> str:
        if self.kind == "trajectory":
            count = f", {len(self.events)} event{'' if len(self.events) == 1 else 's'}"
        else:
            count = ""
        if self.kind == "orbit":
            article = "an"
        else:
            article = "a"
        return (
            f"<Certificate of {article} {self.kind}: "
            f"{'proven' if self.proven else 'not proven'}{count}>"
        )


def made_by(digits: int) -> Record:
    """Return {"made_by": text}, the entry of a file that names symosc, the version of python-flint,
    and the `digits` in which the engine computed what is proposed.
    """
    from symosc.certificates.balls import FLINT_VERSION

    return {"made_by": f"symosc, python-flint {FLINT_VERSION}, {digits} digits"}


def stated(
    kind: str, proven: bool, message: str, statement: Record, points: tuple[Any, ...] = ()
) -> Certificate:
    """Make a certificate from `statement`, the contents of its file.

    An orbit has its switching points in `points`.
    """
    events = []
    for row in proven_rows(statement):
        enclosures = [tuple(row[name]) for name in "tx" if name in row]
        events.append((row["kind"], row["source"], row["target"], *enclosures))
    multipliers = tuple(
        (tuple(row["re"]), tuple(row["im"])) for row in statement.get("multipliers", ())
    )
    changes = tuple(
        tuple(tuple(map(tuple, row[d])) for d in ("dt", "dx"))
        for row in statement.get("derivatives", ())
    )
    stable = statement.get("stable")
    return Certificate(
        kind,
        proven,
        message,
        events=tuple(events),
        points=points,
        multipliers=multipliers,
        stable=stable,
        statement=statement,
        derivatives=changes,
    )


def confirmed(
    kind: str, statement: Record, points: tuple[Any, ...] = (), **limits: int
) -> Certificate:
    """Let the independent checker prove a statement, the contents of a file, within `limits`.

    Return a certificate with its verdict.
    """
    from symosc.certificates.verify_orbits import judge

    code, answer = judge({"format": FORMAT, "kind": kind, "proven": True} | statement, **limits)
    if code:
        return stated(kind, False, f"not confirmed by the checker: {answer}", statement, points)
    return stated(kind, True, answer.splitlines()[0].removeprefix("proven: "), statement, points)


def proven_rows(statement: Record) -> list[Record]:
    """Return the events in the contents of a file as dicts.

    Of a motion that settles, the last ones before t_end. Corners are none.
    """
    rows = statement.get("last") or statement.get("events") or ()
    return [row for row in rows if row["kind"] != CORNER]


def common_digits(low: str, high: str) -> str:
    """Round both ends of an enclosure to the most digits that give one text, and return it; else
    "low … high".
    """
    for digits in range(SHOWN_DIGITS, 0, -1):
        shown = {f"{Decimal(end):.{digits}g}" for end in (low, high)}
        if len(shown) == 1:
            return shown.pop()
    return f"{low} … {high}"


def common_complex(re: tuple[str, str], im: tuple[str, str]) -> str:
    """Return a complex number as text, each part with the digits common to its ends.

    Only `re` if `im` is exactly 0.
    """
    if im == ("0", "0"):
        imaginary = ""
    else:
        imaginary = f" + {common_digits(*im)} i".replace("+ -", "- ")
    return common_digits(*re) + imaginary
