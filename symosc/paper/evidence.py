"""What a check returns: a verdict, and the numbers that it follows from."""

from __future__ import annotations

from dataclasses import dataclass, field

CONFIRMED = "confirmed"
#: What the paper lays down, and this program with it: there is nothing to find out.
DEFINITION = "by definition"
CORRECTED = "confirmed with a correction"
NOT_AS_PRINTED = "not as printed"
UNDECIDED = "cannot be decided"
VERDICTS = (CONFIRMED, DEFINITION, CORRECTED, NOT_AS_PRINTED, UNDECIDED)


@dataclass(frozen=True)
class Evidence:
    """The outcome of one check.

    Attributes
    ----------
    verdict : str
        One of VERDICTS; computed from the numbers, never taken from the claims file.
    finding : str
        What was found, in one or two sentences with the decisive numbers in them.
    numbers : dict of str to str
        Every number the verdict rests on, by a readable name, as text with its digits (and how sure it is, where that
        is not plain). Never empty.
    """

    verdict: str
    finding: str
    numbers: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ValueError(f"verdict = {self.verdict!r}: must be one of {', '.join(VERDICTS)}")
        if not self.numbers:
            raise ValueError("numbers = {}: evidence needs at least one computed number")
