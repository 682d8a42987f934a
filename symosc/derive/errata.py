"""The errors and gaps of the paper, each once: the list behind the supplement, the report and the letter."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from symosc.derive.records import RecordsError, kebab, one_of, records
from symosc.derive.unicode_words import unicode_words

ERRATA_FILE = Path(__file__).with_name("errata.toml")
SEVERITIES = {
    "wrong": "a statement that does not hold",
    "gap": "something is left out that the statement needs",
    "typo": "a sign, word or number, without consequence once it is read right",
}
TEXTS = ("where", "printed", "holds", "proof")


@dataclass(frozen=True)
class Erratum:
    """An error or gap of the paper, counted once however many claims it shows in.

    Attributes
    ----------
    number : int
        Its place in the list, from 1: the number that it has everywhere.
    id : str
    severity : str
        Key of SEVERITIES.
    where, printed, holds : str
        Place in the paper, what stands there, and what does hold.
    proof : str
        Why, in about two lines.
    shown : str
        What of the supplement shows it, as LaTeX; may be empty.
    """

    number: int
    id: str
    severity: str
    where: str
    printed: str
    holds: str
    proof: str
    shown: str = ""

    def in_unicode(self) -> Erratum:
        """Return the erratum with texts that need no LaTeX, for the report and the letter."""
        said = {name: unicode_words(getattr(self, name)) for name in TEXTS}
        return Erratum(self.number, self.id, self.severity, shown=self.shown, **said)


def read_errata(path: Path = ERRATA_FILE) -> tuple[Erratum, ...]:
    """Read the errata, with texts in LaTeX, in the order of the paper.

    Raises
    ------
    RecordsError
        For a file that is no TOML; a key that is unknown, missing or no text; an id twice; an unknown severity.
    """
    rows = records(path, "erratum", ("id", "severity", *TEXTS), ("shown",))
    for row in rows:
        kebab(path.name, row["id"])
        one_of(f"{path.name}, erratum {row['id']}", "severity", row["severity"], SEVERITIES)
    if len({row["id"] for row in rows}) < len(rows):
        raise RecordsError(path.name, "an id is there twice")
    return tuple(Erratum(number, **row) for number, row in enumerate(rows, 1))
