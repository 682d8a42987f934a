"""Tables as text: columns between commas, semicolons, tabs or blanks, with or without a header, with comments.

numpy reads the numbers, some lines at a time, so that a file takes hardly more memory than its columns.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from itertools import chain, islice
from typing import IO, NamedTuple

import numpy as np

from symosc.crosschecks.columns import ID_COLUMN, Asked, find_columns, listed
from symosc.crosschecks.samples import SAMPLE_COLUMNS, number_of, short
from symosc.errors import ParameterError

LINES_TOGETHER = 100_000
# The last is no comment: spreadsheets say so which delimiter they use.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
#: Exponents of Fortran, 1.5D-03.
FORTRAN = re.compile(r"([\d.])[dD]([+-]?\d)")
LONGEST_LINE = 1_000_000
#: A text with more lines than that, nine of ten without data, is none that somebody wants to have read.
MOST_EMPTY_LINES = 1_000_000
# What a line without data is made of.
EMPTY = " \t\n\r\v\f,;"
QUOTED = re.compile('"[^"]*"')
# Byte order marks of UTF-16.
MARKS_OF_16 = (b"\xff\xfe", b"\xfe\xff")
# Lines in which the header is looked for.
HEAD_LINES = 1000

#: Returns what the columns of a table are, of their names: {"t": "Time (s)", ...}.
Choose = Callable[[list[str]], dict[str, str]]


class TextColumns(dict[str, np.ndarray]):
    """Columns of a text by what they are: t, x, v, id."""


#: A line that is not empty: its number in the file, its text, and whether it holds data and is no comment.
Line = tuple[int, str, bool]


class Form(NamedTuple):
    """How lines are read: what is between entries (None: blanks), how many there are, the numbers of the columns."""

    delimiter: str | None
    width: int
    numbers: dict[str, int]


def read_text(file: IO[bytes], asked: Asked, where: str) -> TextColumns:
    """Return the columns t, x, and v and id if they are there."""

    def choose(names: list[str]) -> dict[str, str]:
        if names != [str(i + 1) for i in range(len(names))] or set(asked.values()) & set(names):
            return find_columns(names, asked, where)
        if len(names) not in (2, 3):
            what = f"has no header and {len(names)} columns; say which are meant, such as t=1,x=2,v=3"
            raise ParameterError("file", where, what)
        numbers = dict(zip(SAMPLE_COLUMNS, names, strict=False))
        return {name: numbers[column] for name, column in find_columns([*numbers], asked, where).items()}

    with _opened(file, choose, where) as (form, lines):
        rows = ((number, _plain_row(text, form, number, where)) for number, text, _ in lines)
        parts: dict[str, list[np.ndarray]] = {name: [] for name in form.numbers}
        count = 0
        while some := list(islice(rows, LINES_TOGETHER)):
            for name, values in _numbers(some, form, count).items():
                parts[name].append(values)
            count += len(some)
    return TextColumns((name, np.concatenate(parts.pop(name)) if count else np.empty(0)) for name in form.numbers)


def read_cells(file: IO[bytes], choose: Choose, where: str) -> list[tuple[str, dict[str, str]]]:
    """Return the rows of a table as text, each with the number of its line; without cells that are empty."""
    with _opened(file, choose, where) as (form, lines):
        found = []
        for number, text, _ in lines:
            cells = _cells(text, form.delimiter)
            if len(cells) != form.width:
                _refuse_width(len(cells), form, number, where)
            found.append((f"line {number}", {name: cells[i] for name, i in form.numbers.items() if cells[i]}))
    return found


def plain_number(cell: str) -> str:
    """Return a number with a decimal point, and with e before its exponent."""
    return FORTRAN.sub(r"\1e\2", cell.replace(",", ".")) if "," in cell or "d" in cell.lower() else cell


@contextmanager
def _opened(file: IO[bytes], choose: Choose, where: str) -> Iterator[tuple[Form, Iterator[Line]]]:
    """Yield the form of a table, and its lines with data."""
    mark = file.peek(2)[:2] if isinstance(file, io.BufferedReader) else b""
    with io.TextIOWrapper(file, "utf-16" if mark in MARKS_OF_16 else "utf-8-sig", newline=None) as text:
        lines = _lines(text, where)
        head = list(islice(lines, HEAD_LINES))
        form, skipped = _form(head, choose, where)
        yield form, (line for line in chain(head[skipped:], lines) if line[2])


def _lines(text: io.TextIOWrapper, where: str) -> Iterator[Line]:
    empty = 0
    for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1):
        if len(line) >= LONGEST_LINE or (number <= 10 and "\0" in line):
            raise ParameterError("file", where, "cannot be read: it is not text in lines")
        content = line.strip(EMPTY)
        is_data = bool(content) and not content.startswith(COMMENT_SIGNS)
        empty += not is_data
        if empty > MOST_EMPTY_LINES and empty > 0.9 * number:
            raise ParameterError("file", where, f"has {empty:,} lines without data")
        if content:
            yield number, line.strip("\n"), is_data


def _form(head: list[Line], choose: Choose, where: str) -> tuple[Form, int]:
    """Return the form of a table, and how many of its first lines are no data."""
    data = [i for i, (_, _, is_data) in enumerate(head) if is_data]
    # The header may be a comment: numpy.savetxt writes such.
    comments = head[: data[0]] if data else head
    if not data and not comments:
        raise ParameterError("file", where, "is empty; its first line must name the columns, such as t,x,v")
    samples = [head[i][1] for i in data[1::-1]] or [comments[-1][1]]  # the second line tells more than a header
    delimiter = next((sign for sign in map(_delimiter, samples) if sign), None)

    def form(names: list[str]) -> Form:
        found = choose(names)
        for name in found.values():
            if names.count(name) > 1:
                raise ParameterError("file", where, f"has {short(name)!r} twice; there are: {listed(names)}")
        return Form(delimiter, len(names), {name: names.index(column) for name, column in found.items()})

    first = _cells(head[data[0]][1], delimiter) if data else []
    wrong = None
    if data and not all(_is_number(cell, delimiter) for cell in first):
        try:
            return form(first), data[0] + 1
        except ParameterError as error:  # it may be a row with words, below a header that is a comment
            wrong = error
    for _, line, _ in comments[::-1]:
        names = _cells(line.lstrip("".join(COMMENT_SIGNS) + " "), delimiter)
        if all(_is_number(name, None) for name in names) or (data and len(names) != len(first)):
            continue
        with suppress(ParameterError):  # it is only a comment
            return form(names), len(comments)
    if wrong is not None:
        raise wrong
    return form([str(i) for i in range(1, len(first) + 1)]), len(comments)


def _delimiter(line: str) -> str | None:
    line = QUOTED.sub("", line)
    for sign in (";", "\t"):
        if sign in line:
            return sign
    blanks = line.split()
    if "," in line and not (len(blanks) > 1 and all(_is_number(cell, None) for cell in blanks)):
        return ","
    return None


def _cells(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.replace('"', " ").split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def _is_number(cell: str, delimiter: str | None) -> bool:
    try:
        number_of(FORTRAN.sub(r"\1e\2", cell) if delimiter == "," else plain_number(cell))
    except (TypeError, ValueError):
        return False
    return True


def _plain_row(line: str, form: Form, number: int, where: str) -> str:
    """Return a line without quotes, with decimal points."""
    delimiter = form.delimiter
    if '"' in line:
        sign = delimiter or " "
        line = sign.join(cell.replace(sign, " ") if delimiter else cell for cell in _cells(line, delimiter))
    if delimiter != "," and "," in line:
        line = line.replace(",", ".")
    if "D" in line or "d" in line:
        line = FORTRAN.sub(r"\1e\2", line)
    there = line.count(delimiter) + 1 if delimiter else len(line.split())
    if there != form.width:
        _refuse_width(there, form, number, where)
    return line


def _refuse_width(there: int, form: Form, number: int, where: str) -> None:
    raise ParameterError("file", where, f"row {number} has {there} entries, the header {form.width}")


def _numbers(rows: list[tuple[int, str]], form: Form, before: int) -> dict[str, np.ndarray]:
    """Return the columns of some rows; `before` is how many there were before."""
    lines = [line for _, line in rows]
    wanted = {name: number for name, number in form.numbers.items() if name != ID_COLUMN}
    try:
        table = np.loadtxt(lines, delimiter=form.delimiter, usecols=list(wanted.values()), ndmin=2, comments=None)
    except ValueError:
        for i, (number, line) in enumerate(rows):
            cells = _cells(line, form.delimiter)
            for name, column in wanted.items():
                if not _is_number(cells[column], ","):
                    what = f"is not a number (line {number})"
                    raise ParameterError(f"{name}[{before + i}]", short(cells[column]), what) from None
        raise
    columns = {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(wanted)}
    if ID_COLUMN in form.numbers:
        i = form.numbers[ID_COLUMN]
        columns[ID_COLUMN] = np.array([_cells(line, form.delimiter)[i] for line in lines])
    return columns
