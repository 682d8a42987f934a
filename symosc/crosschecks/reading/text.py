"""Tables as text: any delimiter, alphabet and decimal sign, comments, lines about the data, a header
or none.
"""

from __future__ import annotations

import csv
import io
import re
import sys
from array import array
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from itertools import chain, islice
from typing import NamedTuple

import numpy as np

from symosc.base.aliases import Record
from symosc.base.errors import ParameterError
from symosc.base.exact import MOST_CHARACTERS, NOT_FINITE, NUMBER
from symosc.crosschecks.reading.names import ID_COLUMN, KIND_COLUMN, USUAL_NAMES, plain
from symosc.crosschecks.reading.tables import ADVICE_SAMPLES, ColumnTable
from symosc.crosschecks.samples import check_kind, read_cell

# "sep=" begins no comment, but a line by which a spreadsheet says which delimiter it uses.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
#: Delimiters, the likelier first; None: blanks.
DELIMITERS = (";", "\t", ",", "|", None)
BRACKETS = set("[]{}()")
LONGEST_LINE = MOST_EMPTY_LINES = 1_000_000
# Lines that may hold the header.
HEAD_LINES = 1000
# So many of their last ones show what the rows are like.
TYPICAL_LINES = 50
# Text has no zero byte in its first lines.
FIRST_LINES = 10
# So many bytes show the encoding.
ENCODING_BYTES = 4096
MARKS = {b"\xff\xfe\0\0": "utf-32", b"\0\0\xfe\xff": "utf-32", b"\xff\xfe": "utf-16",
         b"\xfe\xff": "utf-16", b"\xef\xbb\xbf": "utf-8-sig"}  # fmt: skip


class TextLine(NamedTuple):
    """A line of a text file that is not empty: its number, its text, and whether it holds data."""

    number: int
    text: str
    has_data: bool


class Rows(NamedTuple):
    """What the rows of a table are like: their delimiter, how many cells they have, the places of
    the numbers among these, and some of them.
    """

    delimiter: str | None
    width: int
    numbers: frozenset[int]
    typical: list[list[str]]


class TextTable(NamedTuple):
    """A text table: the headers that it may have, the best first, and its rows.

    A row is the number of its line and its cells; they are read once. `header_notes` say, by the
    number of a header, what was left out of it, or that its line could have been a sample.
    """

    headers: list[list[str]]
    rows: Iterator[tuple[int, list[str]]]
    form: Rows
    header_notes: dict[int, str]


class TextRows(NamedTuple):
    """A text table as it stands: the names in its header, and its rows with their lines' numbers."""

    names: list[str]
    rows: list[tuple[int, list[str]]]


def read_text(file: io.BufferedReader, where: str) -> ColumnTable:
    """Return the table in a text file; its columns are read when they are chosen."""
    table = read_table(file, where)

    def peek(place: int) -> list[float]:
        cells = [row[place] for row in table.form.typical if len(row) > place]
        return [float(plain_number(cell)) for cell in cells[:ADVICE_SAMPLES]]

    return ColumnTable(
        table.headers, partial(_columns, table), peek=peek, header_notes=table.header_notes
    )


def _columns(table: TextTable, places: Mapping[str, int]) -> Record:
    """Return the chosen columns of a text table: numbers, and the text of ids and kinds."""
    texts: dict[str, list[str]] = {role: [] for role in places if role in (ID_COLUMN, KIND_COLUMN)}
    values = {role: array("d") for role in places if role not in texts}
    chosen = [(role, places[role], values[role]) for role in values]
    for row, (number, cells) in enumerate(table.rows):
        for role, place, column in chosen:
            try:
                column.append(read_cell(role, plain_number(cells[place])))
            except ParameterError as error:
                what = f"{error.allowed} (line {number})"
                raise ParameterError(f"{role}[{row}]", cells[place], what) from None
        for role, text in texts.items():
            if role == KIND_COLUMN:
                _check_kind(row, number, cells[places[role]])
            text.append(sys.intern(cells[places[role]]))  # one string for all rows of an id
    columns: Record = {role: np.array(column) for role, column in values.items()}
    return columns | {role: np.array(text) for role, text in texts.items()}


def _check_kind(row: int, line: int, kind: str) -> None:
    """Raise ParameterError, with the number of the line, unless a cell is a kind of event."""
    try:
        check_kind(row, kind)
    except ParameterError as error:
        what = f"{error.allowed} (line {line})"
        raise ParameterError(error.name, error.value, what) from None


def read_table(file: io.BufferedReader, where: str) -> TextTable:
    """Return a text table.

    Its header is the first of the lines before the data that has as many cells as these, or a
    comment, as numpy.savetxt writes it. Without a header the columns have their numbers for names.
    """
    lines = _lines(file, where)
    head = list(islice(lines, HEAD_LINES))  # enough lines to find the header in
    if not head:
        what = "is empty; its first line must name the columns, such as t,x,v"
        raise ParameterError("file", where, what)
    texts = [line.text for line in head if line.has_data]
    form = _form_of_rows(texts or [head[-1].text])
    begin = _begin_of_data(head, form)
    above = [line.text for line in head[:begin] if line.has_data]
    comments = [line.text.lstrip("".join(COMMENT_SIGNS) + " ") for line in head[:begin]
                if not line.has_data]  # fmt: skip
    headers, notes = _headers(above, comments[::-1], form)
    rows = _rows(chain(head[begin:], lines), form, where)
    return TextTable(headers, rows, form, notes)


def read_rows(
    file: io.BufferedReader, where: str, is_header: Callable[[list[str]], bool]
) -> TextRows:
    """Return the names and the rows of a text table whose header `is_header` knows by its names.

    All lines below the header are rows, whatever they hold; text stays text.
    """
    lines = _lines(file, where)
    head = list(islice(lines, HEAD_LINES))
    texts = [line.text for line in head if line.has_data]
    if not texts:
        raise ParameterError("file", where, "is empty")
    likely = _form_of_rows(texts).delimiter
    for i, line in enumerate(head):
        text = line.text if line.has_data else line.text.lstrip("".join(COMMENT_SIGNS) + " ")
        for delimiter in (likely, *DELIMITERS):
            names = _split_names(text, delimiter, None)
            if is_header(names):
                form = Rows(delimiter, len(names), frozenset(), [])
                return TextRows(names, list(_rows(chain(head[i + 1 :], lines), form, where)))
    return TextRows(_split_names(texts[0], likely, None), [])


# -- rows ------------------------------------------------------------------------------------------


def _form_of_rows(texts: Sequence[str]) -> Rows:
    """Return what the rows of a table are like, by the last ones of these lines."""
    telling = texts[-TYPICAL_LINES:]
    # A file that is cut off may end anywhere.
    telling = telling[:-1] if len(telling) > 10 else telling

    def rows_with(delimiter: str | None) -> list[list[str]]:
        """Return the cells of the rows, if a delimiter separates them: of lines with numbers."""
        try:
            split = [_split_cells(text, delimiter) for text in telling]
        except csv.Error:  # quotes that this sign does not separate
            return []
        if delimiter == "," and any(map(_has_decimal_commas, telling)):
            return []
        return [row for row in split if any(map(is_number, row))]

    rows = {delimiter: rows_with(delimiter) for delimiter in DELIMITERS}
    most = max(map(len, rows.values()))

    def score(delimiter: str | None) -> tuple[float, int]:
        # A damaged line may be a number by a delimiter that makes no rows of the others.
        if 2 * len(rows[delimiter]) <= most:
            return (0.0, 0)
        cells = [cell for row in rows[delimiter] for cell in row if cell]
        numbers = sum(map(is_number, cells))
        return (numbers / max(len(cells), 1), numbers)

    scores = {delimiter: score(delimiter) for delimiter in DELIMITERS}
    best = max(DELIMITERS, key=lambda delimiter: scores[delimiter])  # of equals the first
    if scores[best] == (0.0, 0):  # no numbers: a header alone
        best = next((sign for sign in DELIMITERS[:-1] if sign and sign in telling[-1]), None)
    split = [_split_cells(text, best) for text in telling]
    typical = [row for row in split if any(map(is_number, row))] or split
    counts = Counter(map(len, typical))
    width = max(counts, key=lambda count: (counts[count], count))
    typical = [row for row in typical if len(row) == width]
    # Delimiters at the ends of rows separate nothing.
    while width > 1 and not any(row[width - 1] for row in typical):
        width -= 1
    numbers = frozenset(
        place
        for place in range(width)
        if 2 * sum(is_number(row[place]) for row in typical) >= len(typical)
    )
    return Rows(best, width, numbers, [row[:width] for row in typical])


def _has_decimal_commas(line: str) -> bool:
    """Return whether blanks separate numbers with decimal commas: "0,5, 1,5" or "0,5 1,5"."""
    cells = line.split()
    inner = [cell.rstrip(",") for cell in cells]
    return len(cells) > 1 and all(map(is_number, inner)) and any("," in cell for cell in inner)


def _begin_of_data(head: Sequence[TextLine], form: Rows) -> int:
    """Return the number of the first line of data.

    It is the first whose cells are numbers where those of the rows are, or a line just before it
    that has some of them; numbers that count the columns are names.
    """

    def numbers_in(line: TextLine) -> int:
        """Return how many of the numbers of a row a line has; -1 if it is no row."""
        cells = _split_cells(line.text, form.delimiter)
        if not line.has_data or len(cells) <= max(form.numbers, default=0):
            return -1
        return sum(is_number(cells[place]) for place in form.numbers)

    counts = [numbers_in(line) if form.numbers else 0 for line in head]
    data = [i for i, line in enumerate(head) if line.has_data]
    if not form.numbers:  # a header, and perhaps rows without a number below it
        return next((i + 1 for i in data if _names_times(head[i].text, form)), len(head))
    begin = next((i for i in data if counts[i] == len(form.numbers)), len(head))
    while begin > 0 and counts[begin - 1] > 0 and head[begin - 1].has_data:
        begin -= 1
    has_names = any(line.has_data for line in head[:begin])
    if begin == 0 and begin in data and counts[0] < len(form.numbers):
        return 1  # a header with a number among its names
    if begin in data and not has_names and _counts_columns(head[begin:], form):
        return begin + 1
    return begin


def _names_times(text: str, form: Rows) -> bool:
    """Return whether a line names a column of times, and another one."""
    names = _without_ends(_split_cells(text, form.delimiter))
    return len(names) > 1 and any(plain(name) in USUAL_NAMES["t"] for name in names)


def _counts_columns(head: Sequence[TextLine], form: Rows) -> bool:
    """Return whether the first line of numbers is a header that counts the columns, from 0 or from 1.

    The numbers may be a sample, such as 0, 1, 2, if x and v lead to the next sample, and its time is
    later.
    """
    rows = [_split_cells(line.text, form.delimiter)[: form.width] for line in head if line.has_data]
    cells, *following = rows
    counting = cells[1:] if cells and not cells[0] else cells
    begins = (range(len(counting)), range(1, len(counting) + 1))
    if len(counting) < 2 or not any(counting == [*map(str, numbers)] for numbers in begins):
        return False
    # Two samples are needed below a header.
    if len(following) < 2 or not all(map(is_number, following[0])):
        return len(following) > 1 and not cells[0]
    if not cells[0]:
        return True
    t, x, *v = map(float, cells)
    next_t, next_x, *next_v = (float(plain_number(cell)) for cell in following[0])
    if next_t <= t:
        return True
    if not v:
        return False
    way = 0.5 * (v[0] + next_v[0]) * (next_t - t)
    moved = next_x - x
    return abs(moved - way) > 0.5 * max(abs(moved), abs(way))


def _rows(lines: Iterator[TextLine], form: Rows, where: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line with data."""
    width = form.width
    for number, text, has_data in lines:
        if has_data:
            cells = _split_cells(text, form.delimiter)
            if len(cells) != width:
                if len(cells) < width or any(cells[width:]):
                    count = "1 entry" if len(cells) == 1 else f"{len(cells)} entries"
                    what = f"row {number} has {count}, and the others have {width}"
                    raise ParameterError("file", where, what)
                del cells[width:]
            yield number, cells


# -- headers ---------------------------------------------------------------------------------------


def _headers(
    above: list[str], comments: list[str], form: Rows
) -> tuple[list[list[str]], dict[int, str]]:
    """Return the lists of names that the columns may have, the best first, and notes on them by
    their numbers.

    Those of lines `above` the data with a name for each column come first, then those of the other
    lines and of `comments`, then the numbers of the columns.
    """
    width = form.width
    numbers = [str(i) for i in range(1, width + 1)]
    if not form.numbers:  # a header alone
        return [_split_names(text, form.delimiter, None) for text in above or comments], {}
    split = [_split_names(text, form.delimiter, width) for text in above]
    fitting = [names for names in split if len(names) == width]
    notes = {
        number: f"the first line is taken for names, not for a sample: {', '.join(names)}"
        for number, names in enumerate(fitting)
        if all(map(is_number, names))
    }
    mended = list[list[str]]()
    for names in reversed(split):
        if len(names) in (1, width):
            continue
        usable = _mended(names, form)
        if len(names) > width:
            listed = ", ".join(names[width:])
            notes[len(fitting) + len(mended)] = f"names without a column are left out: {listed}"
        if usable:
            mended.append(usable)
    in_comments = [
        names
        for names in (_split_names(text, form.delimiter, width) for text in comments)
        if len(names) == width and not all(map(is_number, names))
    ]
    headers = [*fitting, *mended, *in_comments]
    # A table of rows alone, or a header that does not say which column it leaves out.
    return headers if fitting else [*headers, numbers], notes


def _split_names(text: str, delimiter: str | None, width: int | None) -> list[str]:
    """Return the names in a header of `width` columns.

    Commas and blanks in brackets separate nothing, nor do single blanks, if that fits better; nor
    need the delimiter be that of the rows.
    """
    names = _without_ends(_split_cells(text, delimiter))
    if len(names) == width or width is None:
        return names
    sign = r"\s" if delimiter is None else re.escape(delimiter)
    whole = re.findall(rf"(?:\([^()]*\)|\[[^\[\]]*\]|\"[^\"]*\"|[^{sign}])+", text)
    candidates = [
        whole,
        re.sub(r"\s+(?=[(\[])", "", text).split(),
        re.split(r"\s{2,}", text.strip()),
    ]
    for other in DELIMITERS:
        with suppress(csv.Error):
            candidates.append(_without_ends(_split_cells(text, other)))
    for candidate in candidates:
        if len(candidate) == width:
            return [name.strip().strip('"').strip() for name in candidate]
    return names


def _without_ends(names: list[str]) -> list[str]:
    """Return names without the empty ones at the end."""
    while names and not names[-1]:
        names = names[:-1]
    return names


def _mended(names: list[str], form: Rows) -> list[str]:
    """Return the names of a header that has more or fewer of them than there are columns.

    [] if it is not clear which columns have none.
    """
    extra = form.width - len(names)
    if extra < 0:
        return names[: form.width]
    # Words behind the numbers have no names, or numbers of rows before them.
    behind = range(form.width - extra, form.width)
    if not form.numbers & set(behind):
        return names + [""] * extra
    first = [row[0] for row in form.typical]
    if extra == 1 and (not any(map(is_number, first)) or _are_consecutive(first)):
        return ["", *names]
    if all(not row[0] for row in form.typical):
        return ["", *names][: form.width]
    return []


def _are_consecutive(cells: Sequence[str]) -> bool:
    """Return whether cells are whole numbers that count rows."""
    if not all(cell.isdecimal() for cell in cells):
        return False
    numbers = [int(cell) for cell in cells]
    return numbers == [*range(numbers[0], numbers[0] + len(numbers))]


# -- lines and cells -------------------------------------------------------------------------------


def encoding_of(beginning: bytes) -> str:
    """Return the encoding of a text file that begins like this."""
    for mark, encoding in MARKS.items():
        if beginning.startswith(mark):
            return encoding
    # Each second byte of Latin letters and digits is zero in UTF-16.
    even = beginning[0::2]
    odd = beginning[1::2]
    if len(odd) > 1 and not any(odd) and all(even[: len(odd)]):
        return "utf-16-le"
    if len(odd) > 1 and not any(even) and all(odd):
        return "utf-16-be"
    try:
        beginning[: max(len(beginning) - 4, 0)].decode("utf-8")
    except UnicodeDecodeError as error:
        if error.start < len(beginning) - 8:
            return "cp1252"
    return "utf-8"


def _lines(file: io.BufferedReader, where: str) -> Iterator[TextLine]:
    """Yield each line of a text file that is not empty."""
    encoding = encoding_of(file.peek(ENCODING_BYTES)[:ENCODING_BYTES])
    empty = 0
    with io.TextIOWrapper(file, encoding, errors="replace", newline=None) as text:
        for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1):
            if len(line) >= LONGEST_LINE or (number <= FIRST_LINES and "\0" in line):
                raise ParameterError("file", where, "cannot be read: it is not text in lines")
            content = line.strip(" \t\n\r\v\f,;|")
            # A line of signs, such as ----, rules the table.
            has_data = not content.startswith(COMMENT_SIGNS) and any(map(str.isalnum, content))
            empty += not has_data
            if empty > MOST_EMPTY_LINES and empty > 0.9 * number:
                raise ParameterError("file", where, f"has {empty:,} lines without data")
            if content:
                yield TextLine(number, _without_brackets(line.strip("\n"), content), has_data)


def _without_brackets(line: str, content: str) -> str:
    """Return a line without the brackets around all of it, as lists of numbers have them."""
    inner = content.strip("[]{}(), ")
    if inner and content[0] in "[{(" and inner[0] in "+-.0123456789" and not set(inner) & BRACKETS:
        return inner
    return line


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Split a line of a table at its delimiter into cells.

    Empty ones before bars and behind them are left out.
    """
    if delimiter is None:
        cells = line.replace('"', " ").split()
        return [cell.rstrip(",") for cell in cells] if "," in line else cells
    if delimiter == "|":
        line = line.strip().strip("|")
    if '"' not in line:
        if " " not in line:
            return line.split(delimiter)
        return [cell.strip() for cell in line.split(delimiter)]
    quoted = csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True)
    return [cell.strip() for cell in next(quoted, [])]


def is_number(cell: str) -> bool:
    """Return whether a cell is a number, NaN and infinities among them."""
    if len(cell) > MOST_CHARACTERS:  # the patterns would take long
        return cell.isdecimal()
    text = plain_number(cell).strip()
    return bool(NUMBER.fullmatch(text) or NOT_FINITE.fullmatch(text))


def plain_number(cell: str) -> str:
    """Return the text of a number as Python writes it.

    With a point for a decimal comma, and e for the d of a Fortran exponent or Mathematica's *^.
    """
    if "," in cell and "." not in cell:
        cell = cell.replace(",", ".")
    if "d" in cell or "D" in cell:
        cell = re.sub(r"([\d.])[dD]([+-]?\d)", r"\1e\2", cell)
    return cell.replace("*^", "e")
