"""Tables as text: columns between commas, semicolons, tabs or blanks, with or without a header, with comments.

numpy reads the numbers, some lines at a time, so that a file takes hardly more memory than its columns.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import chain, islice
from typing import IO, TextIO

import numpy as np

from symosc.crosschecks.columns import ID_COLUMN, find_columns, listed
from symosc.crosschecks.samples import SAMPLE_COLUMNS, number_of, short
from symosc.errors import ParameterError

LINES_TOGETHER = 100_000
# The last is no comment: spreadsheets say so which delimiter they use.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
#: Exponents of Fortran, 1.5D-03.
FORTRAN = re.compile(r"([\d.])[dD]([+-]?\d)")
LONGEST_LINE = 10_000_000
QUOTED = re.compile('"[^"]*"')
# Byte order marks of UTF-16.
MARKS_OF_16 = (b"\xff\xfe", b"\xfe\xff")
# Lines in which the header is looked for.
HEAD_LINES = 1000


class TextColumns(dict[str, np.ndarray]):
    """Columns of a text by what they are: t, x, v, id."""


#: A line and its number in the file.
Line = tuple[int, str]


@dataclass(frozen=True)
class Form:
    """How the lines of a table are to be read.

    Attributes
    ----------
    delimiter : str or None
        None: blanks.
    width : int
        Entries of a line.
    numbers : dict
        Numbers of the columns by name: t, x, v, id.
    """

    delimiter: str | None
    width: int
    numbers: dict[str, int]


def read_text(file: IO[bytes], asked: Mapping[str, str | None], where: str) -> TextColumns:
    """Return the columns t, x, and v and id if they are there.

    Raises
    ------
    ParameterError
        If there is no such table in the file.
    """
    mark = file.peek(2)[:2] if isinstance(file, io.BufferedReader) else b""
    with io.TextIOWrapper(file, "utf-16" if mark in MARKS_OF_16 else "utf-8-sig", newline=None) as text:
        return _read(text, asked, where)


def _read(text: TextIO, asked: Mapping[str, str | None], where: str) -> TextColumns:
    lines: Iterator[Line] = (
        (number, line.strip("\n"))
        for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1)
        if not line.isspace()
    )
    head = list(islice(lines, HEAD_LINES))
    if any("\0" in line or len(line) >= LONGEST_LINE for _, line in head[:10]):
        raise ParameterError("file", where, "cannot be read: it is not text in lines")
    form, skipped = _form(head, asked, where)
    parts: dict[str, list[np.ndarray]] = {name: [] for name in form.numbers}
    rows = _rows(chain(head[skipped:], lines), form, where)
    count = 0
    while some := list(islice(rows, LINES_TOGETHER)):
        for name, values in _numbers(some, form, count).items():
            parts[name].append(values)
        count += len(some)
    return TextColumns((name, np.concatenate(parts.pop(name)) if count else np.empty(0)) for name in form.numbers)


def _form(head: list[Line], asked: Mapping[str, str | None], where: str) -> tuple[Form, int]:
    """Return the form of a table, and how many of its first lines are no data."""
    data = [i for i, (_, line) in enumerate(head) if not line.lstrip().startswith(COMMENT_SIGNS) and _is_filled(line)]
    # The header may be a comment: numpy.savetxt writes such.
    comments = head[: data[0]] if data else head
    if not data and not comments:
        raise ParameterError("file", where, "is empty; its first line must name the columns, such as t,x,v")
    shown = [head[i][1] for i in data[1::-1]] or [comments[-1][1]]  # the second line tells more than a header does
    delimiter = next((sign for sign in map(_delimiter, shown) if sign), None)
    first = _cells(head[data[0]][1], delimiter) if data else []
    if data and not all(_is_number(cell, delimiter) for cell in first):
        return Form(delimiter, len(first), _found(first, asked, where)), data[0] + 1
    for _, line in comments[::-1]:
        names = _cells(line.lstrip("".join(COMMENT_SIGNS) + " "), delimiter)
        if len(names) == len(first) or not data:
            try:
                return Form(delimiter, len(names), _found(names, asked, where)), len(comments)
            except ParameterError:  # it is only a comment
                continue
    names = [str(i) for i in range(1, len(first) + 1)]
    if len(names) in (2, 3) and not any(column in names for column in asked.values()):
        names = list(SAMPLE_COLUMNS[: len(names)])
    elif not set(asked.values()) & set(names):
        what = f"has no header and {len(names)} columns; say which are meant, such as t=1,x=2,v=3"
        raise ParameterError("file", where, what)
    return Form(delimiter, len(first), _found(names, asked, where)), len(comments)


def _found(names: list[str], asked: Mapping[str, str | None], where: str) -> dict[str, int]:
    found = find_columns(names, asked, where)
    for name in found.values():
        if names.count(name) > 1:
            raise ParameterError("file", where, f"has {short(name)!r} twice; there are: {listed(names)}")
    return {name: names.index(column) for name, column in found.items()}


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
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]


def _is_filled(line: str) -> bool:
    return bool(line.strip(" \t,;"))


def _is_number(cell: str, delimiter: str | None) -> bool:
    try:
        number_of(FORTRAN.sub(r"\1e\2", cell if delimiter == "," else cell.replace(",", ".")))
    except (TypeError, ValueError):
        return False
    return True


def _rows(lines: Iterable[Line], form: Form, where: str) -> Iterator[Line]:
    """Yield the lines with data, without quotes, with decimal points."""
    delimiter, width = form.delimiter, form.width
    for number, line in lines:
        if line.lstrip().startswith(COMMENT_SIGNS) or not _is_filled(line):
            continue
        if '"' in line:
            sign = delimiter or " "
            line = sign.join(cell.replace(sign, " ") if delimiter else cell for cell in _cells(line, delimiter))
        if delimiter != "," and "," in line:
            line = line.replace(",", ".")
        if "D" in line or "d" in line:
            line = FORTRAN.sub(r"\1e\2", line)
        there = line.count(delimiter) + 1 if delimiter else len(line.split())
        if there != width:
            what = f"row {number} has {there} entries, the header {width}"
            raise ParameterError("file", where, what)
        yield number, line


def _numbers(rows: list[Line], form: Form, before: int) -> dict[str, np.ndarray]:
    """Return the columns of some rows; `before` is how many there were before."""
    lines = [line for _, line in rows]
    wanted = {name: number for name, number in form.numbers.items() if name != ID_COLUMN}
    try:
        table = np.loadtxt(lines, delimiter=form.delimiter, usecols=list(wanted.values()), ndmin=2, comments=None)
    except ValueError:
        _refuse_first(rows, form, wanted, before)
        raise
    columns = {name: np.ascontiguousarray(table[:, i]) for i, name in enumerate(wanted)}
    if ID_COLUMN in form.numbers:
        i = form.numbers[ID_COLUMN]
        columns[ID_COLUMN] = np.array([_cells(line, form.delimiter)[i] for line in lines])
    return columns


def _refuse_first(rows: list[Line], form: Form, wanted: Mapping[str, int], before: int) -> None:
    """Raise ParameterError for the first entry that is no number."""
    for i, (number, line) in enumerate(rows):
        cells = _cells(line, form.delimiter)
        for name, column in wanted.items():
            if not _is_number(cells[column], ","):
                raise ParameterError(f"{name}[{before + i}]", short(cells[column]), f"is not a number (line {number})")
