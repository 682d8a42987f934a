"""Words: sequences of mappings in order of time, such as P2 and then P3; and which mapping may
follow which.

The paper writes a word like a composition of functions, from right to left: P32 = P3∘P2 applies P2
first. That text is its mapping structure. `read_word` checks a text and makes a `Word` of it, and
``str`` a text of a `Word`. Only `cycle` takes a text apart without the check, because that text was
written by ``str``. A list that a user gives reads like the text. Where there is one belt its
mappings are S1, B1 and A1, and a word is a text such as B1∘A1.
`Trajectory.word` and `Word.labels` are in order of time, a text (`Scene.structure`,
`PeriodicOrbit.word`) is from right to left.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeAlias

from symosc.base.arguments import FLAG, WORD, public, require
from symosc.base.errors import SymoscError, brief, shown
from symosc.friction import MAPS, MOST_BELTS, Map, geometry

#: The mappings of another number of belts than two, by label.
OF_BELTS = geometry(MOST_BELTS).maps
#: What the mappings of two belts are called beside other ones: P1, P2 and P3 are S1, B1 and A1.
ALONE = dict(zip(MAPS, OF_BELTS, strict=False))
PAIRED = {label: paper for paper, label in ALONE.items()}
#: How words of other laws than the paper's begin.
OTHER_LABELS = re.compile(r"[SBAUD]\d")
#: The mappings of any number of belts by label, with the modes of the engine.
KNOWN_MAPS = MAPS | OF_BELTS


class WordError(SymoscError, ValueError):
    """A word that cannot be read, or that no motion can follow.

    Attributes
    ----------
    word : str
        What was given.
    step : tuple of str or None
        The two labels, in order of time, of the step that is impossible.

    Examples
    --------
    >>> from symosc import WordError, read_word
    >>> try:
    ...     read_word("P52")
    ... except WordError as error:
    ...     print(error.step)
    ('P2', 'P5')
    """

    def __init__(self, word: str, reason: str, step: tuple[str, str] | None = None) -> None:
        self.word = word
        self.reason = reason
        self.step = step
        super().__init__(f"mapping structure {brief(word)}: {reason}")


class Word(NamedTuple):
    """A sequence of mappings; ``str`` writes it as the paper does.

    Two words are equal if they are one cycle: ``read_word("P23") == read_word("P32")``. All answers
    about orbits write the rotation `cycle`.

    Attributes
    ----------
    labels : tuple of str
        "P1" to "P8", or "S1", "B1" and "A1" of one belt, in order of time: the reverse of the text.

    Examples
    --------
    >>> from symosc import read_word
    >>> word = read_word("P4645")
    >>> word.labels, str(word)
    (('P5', 'P4', 'P6', 'P4'), 'P4645')
    >>> str(word.cycle), word == read_word("P6454")
    ('P6454', True)
    """

    labels: tuple[str, ...]

    @property
    def cycle(self) -> Word:
        """The rotation whose labels, in order of time, come first in the alphabet.

        All results about orbits write this rotation.
        """
        first = first_of_cycle(self.labels)
        return Word(self.labels[first:] + self.labels[:first])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Word):
            return NotImplemented
        return tuple(self.cycle) == tuple(other.cycle)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(tuple(self.cycle))

    def latex(self) -> str:
        """Return the word in LaTeX as a composition of mappings, such as P32 = P3∘P2."""
        composed = r" \circ ".join(map(latex_label, reversed(self.labels)))
        if len(self.labels) > 1 and self.labels[0] in MAPS:
            return f"P_{{{str(self)[1:]}}} = {composed}"
        return composed

    def _repr_latex_(self) -> str:
        return f"${self.latex()}$"

    @property
    def maps(self) -> tuple[Map, ...]:
        """The mappings of the word, as rows of `KNOWN_MAPS`, in order of time."""
        return tuple(KNOWN_MAPS[label] for label in self.labels)

    def exits(self) -> tuple[str | None, ...]:
        """Return for each map whether the next one moves "below" or "above" the belt, if the map is
        a stick.

        The last map is followed by the first one, as on a periodic orbit. The entry is None for a
        flight, and for a stick if the next map is no flight that begins at its belt.
        """
        sides: list[str | None] = []
        for step, after in zip(self.maps, [*self.maps[1:], self.maps[0]], strict=True):
            leaves = step.sticks and not after.sticks and after.start.boundary == step.end.boundary
            if after.domain == step.end.boundary:  # a belt has the number of the domain below it
                side = "below"
            else:
                side = "above"
            sides.append(side if leaves else None)
        return tuple(sides)

    def __str__(self) -> str:
        in_text = self.labels[::-1]
        if in_text and all(label in MAPS for label in in_text):
            return "P" + "".join(label[1] for label in in_text)
        return "∘".join(in_text)  # of another number of belts than two


def first_of_cycle(labels: Sequence[str]) -> int:
    """Return the index at which the least rotation of `labels` begins, by the order of the labels."""
    count = len(labels)
    twice = [*labels, *labels]  # which has every rotation as a slice
    return min(range(count), key=lambda i: twice[i : i + count], default=0)


def cycle(word: str) -> str:
    """Return the text of `Word.cycle` for the text of a word that ``str`` wrote.

    P32 for P32 and for P23; "" for "". A word with grazes passes too, which `read_word` refuses.
    """
    return str(written(word).cycle)


def written(text: str) -> Word:
    """Return the word whose text ``str`` wrote."""
    if text.startswith("P"):
        in_text = [f"P{digit}" for digit in text[1:]]
    else:
        in_text = [label for label in text.split("∘") if label]
    return Word(tuple(reversed(in_text)))


def latex_label(label: str) -> str:
    """Return the label of a mapping in LaTeX."""
    return f"{label[0]}_{{{label[1:]}}}" if len(label) > 2 else f"{label[0]}_{label[1:]}"


def of_belts(word: Word, belts: int) -> Word:
    """Return a word with the labels of a law of so many belts.

    Raise WordError if it is about a belt that there is not.
    """
    names = PAIRED if belts == 2 else ALONE
    labels = tuple(names.get(label, label) for label in word.labels)
    for given, label in zip(word.labels, labels, strict=True):
        row = KNOWN_MAPS[label]
        belt = max(row.start.boundary, row.end.boundary)
        if belt <= belts:
            continue
        if belts == 1:
            there = "there is one belt: its mappings are S1, B1 and A1"
        else:
            there = f"there are {belts} belts"
        raise WordError(str(word), f"{given} is at belt {belt}, and {there}")
    return Word(labels)


#: The greatest length up to which labels are printed in full, and that of a repeated group that is
#: looked for.
MOST_PRINTED = 40
LONGEST_PART = 64
#: A group that is repeated less often is not written as one.
LEAST_TIMES = 3


class Labels(list[str]):
    """Labels of mappings in order of time: a list that prints short where it is long.

    Examples
    --------
    >>> from symosc import simulate
    >>> simulate("fig5", t_end=300).word
    <98 mappings: P1 P2 P1 P3 (P1 P2)×47>
    """

    def __repr__(self) -> str:
        if len(self) <= MOST_PRINTED:
            return super().__repr__()
        return f"<{len(self):,} mappings: {collapsed(self)}>"


def collapsed(labels: Sequence[str]) -> str:
    """Return labels as text in which a group that is repeated up to the end is written once: P1 P3
    (P1 P2)×46.

    After the last whole group there may be the beginning of one more.
    """
    if len(labels) <= MOST_PRINTED:
        return " ".join(labels)
    # The repetitions that cover most labels.
    begin = 0
    length = 1
    times = 0
    count = len(labels)
    for period in range(1, min(LONGEST_PART, count // LEAST_TIMES) + 1):
        # From the end: the last label that is not repeated a period later.
        last_other = next(
            (n for n in range(count - 1 - period, -1, -1) if labels[n] != labels[n + period]), -1
        )
        repeated = (count - 1 - last_other) // period
        if repeated * period > length * times:
            begin = last_other + 1
            length = period
            times = repeated
    if times < LEAST_TIMES:
        return f"{' '.join(labels[: MOST_PRINTED // 2])} … {' '.join(labels[-MOST_PRINTED // 2 :])}"
    group = labels[begin : begin + length]
    head = labels[:begin]
    tail = labels[begin + times * length :]
    if len(head) > MOST_PRINTED:
        beginning: Sequence[str] = [*head[:MOST_PRINTED], "…"]
    else:
        beginning = head
    return " ".join([*beginning, f"({' '.join(group)})×{times}", *tail])


#: The most mappings of a word, and the most characters of its text.
MOST_MAPPINGS = 10_000
LONGEST_TEXT = 8 * MOST_MAPPINGS
#: What `read_word` reads.
WordLike: TypeAlias = str | Iterable[str] | Word


@public
def read_word(word: WordLike, *, closed: bool = True, grazing: bool = False) -> Word:
    """Read a mapping structure and check that a motion can follow it.

    Parameters
    ----------
    word : str, iterable of str or Word
        "P32", "P3∘P2", "P3 P2", ["P3", "P2"]: each applies P2 first. Of one belt "A1∘B1", "A1 B1"
        and so on.
    closed : bool
        Whether the first map follows the last one, as on a periodic orbit.
    grazing : bool
        Whether a flight may come back to the domain that it came from, which takes a graze.

    Raises
    ------
    WordError
        If it cannot be read or has an impossible step, which the message names.
    ParameterError
        If `closed` or `grazing` is neither True nor False.

    Examples
    --------
    >>> from symosc import read_word
    >>> str(read_word(["P3", "P2"])), read_word("P32").labels
    ('P32', ('P2', 'P3'))
    """
    require(WORD, word=word)
    require(FLAG, closed=closed, grazing=grazing)
    if isinstance(word, Word):
        labels = word.labels
        text = str(word)
    else:
        labels, text = _read(word)
    for before, after in itertools.pairwise((*labels, labels[0]) if closed else labels):
        if reason := why_not(before, after, grazing=grazing):
            raise WordError(text, reason, (before, after))
    return Word(labels)


def why_not(before: str, after: str, *, grazing: bool = False) -> str:
    """Return why no motion can do mapping `before` and then mapping `after`, or "" if one can."""
    first = KNOWN_MAPS[before]
    second = KNOWN_MAPS[after]
    ends = first.end
    starts = second.start
    step = f"{after} cannot follow {before}"
    if ends.boundary != starts.boundary:
        return (
            f"{step}: {before} ends on {ends}, at belt {ends.boundary}, and {after} starts on "
            f"{starts}"
        )
    if first.sticks and second.sticks:
        return (
            f"{step}: a stick ends by slipping off belt {ends.boundary}, so a flight must come next"
        )
    if first.domain == second.domain and not grazing:
        return (
            f"{step}: {before} comes from Ω{first.domain} and {after} goes back there, which only "
            "a graze does"
        )
    return ""


def _read(word: str | Iterable[object]) -> tuple[tuple[str, ...], str]:
    """Return the labels of a word in order of time, and its text."""
    if isinstance(word, str):
        parts: list[object] = [part for part in re.split(r"[\s,*·∘]+", word) if part]
        text = word.strip()
    else:
        parts = list(itertools.islice(word, MOST_MAPPINGS + 1))
        text = "∘".join(part if isinstance(part, str) else shown(part) for part in parts)
    if len(parts) > MOST_MAPPINGS or len(text) > LONGEST_TEXT:
        raise WordError(text, f"may have at most {MOST_MAPPINGS:,} mappings")
    labels: list[str] = []
    for part in parts:
        read = _labels_of(part)
        if not read:
            allowed = "the mappings are P1 to P8, written P32, P3∘P2 or ['P3', 'P2']"
            if any(label in PAIRED for label in labels) or OTHER_LABELS.match(text):
                allowed = (
                    "the mappings of one belt are S1, B1 and A1, written A1∘B1, 'A1 B1' or "
                    "['A1', 'B1'], those of more belts S1, B1, A1, U12, D21 and so on"
                )
            raise WordError(text, f"{shown(part)} is not a mapping; {allowed}")
        labels += read
    if not labels:
        raise WordError(repr(text), "is empty; write for example P32, which applies P2 first")
    if len({label in MAPS for label in labels}) > 1:
        reason = "mixes mappings of two belts (P1 to P8) with those of other laws (S1, B1, A1 ...)"
        raise WordError(text, reason)
    return tuple(reversed(labels)), text


def _labels_of(part: object) -> list[str]:
    """Return the labels of mappings in one part of a word's text, such as P32; empty for any other
    text.
    """
    if not isinstance(part, str):
        return []
    if part in OF_BELTS:
        return [str(part)]
    match = re.fullmatch(r"P_?\{?([1-8]+)\}?", part)
    if match is None:
        return []
    return [f"P{digit}" for digit in match.group(1)]
