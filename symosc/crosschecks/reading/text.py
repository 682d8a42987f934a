"""Tables as text: any delimiter, decimal commas, comments, a header or none."""

from __future__ import annotations

import csv
import io
import re
import sys
from array import array
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain, islice
from typing import IO, NamedTuple

import numpy as np

from symosc.base.errors import ParameterError, brief
from symosc.base.exact import NOT_FINITE, NUMBER
from symosc.crosschecks.reading.names import (
    ID_COLUMN,
    Asked,
    NamedColumns,
    find_text_columns,
    names_text,
)
from symosc.crosschecks.samples import read_cell

#: Choose the columns of a table by their names: {"t": "Time (s)", ...}.
Choose = Callable[[list[str]], dict[str, str]]
# "sep=" begins no comment, but a line by which a spreadsheet says which delimiter it uses.
COMMENT_SIGNS = ("#", "%", "//", "!", "sep=")
LONGEST_LINE = MOST_EMPTY_LINES = 1_000_000
# Lines that may hold the header.
HEAD_LINES = 1000
# Text has no zero byte in its first lines.
FIRST_LINES = 10


class Line(NamedTuple):
    """A line of a text file that is not empty: its number, its text, and whether it holds data."""

    number: int
    text: str
    has_data: bool


class TextTable(NamedTuple):
    """The chosen columns of a text table.

    `columns` are their positions by name, `rows` the line number and all cells of each row, which
    are read once.
    """

    delimiter: str | None
    columns: dict[str, int]
    rows: Iterator[tuple[int, list[str]]]


def read_text(file: IO[bytes], asked: Asked | None, where: str) -> NamedColumns:
    """Return the columns t and x of a text table, and v and id if present.

    `asked` may say how they are called.
    """
    choose = partial(find_text_columns, asked=asked or {}, where=where)
    table = read_table(file, choose, where)
    positions = dict(table.columns)
    id_position = positions.pop(ID_COLUMN, None)
    ids = list[str]()
    values = {name: array("d") for name in positions}
    for row, (number, cells) in enumerate(table.rows):
        for name, i in positions.items():
            try:
                values[name].append(read_cell(name, _written_plainly(cells[i], table.delimiter)))
            except ParameterError as error:
                what = f"{error.allowed} (line {number})"
                raise ParameterError(f"{name}[{row}]", cells[i], what) from None
        if id_position is not None:
            ids.append(sys.intern(cells[id_position]))  # one string for all rows of an id
    columns = {name: np.array(column) for name, column in values.items()}
    if id_position is not None:
        columns[ID_COLUMN] = np.array(ids)
    return NamedColumns(columns, are_matched=True)


def read_cells(file: IO[bytes], choose: Choose, where: str) -> list[tuple[str, dict[str, str]]]:
    """Return the place of each row of a text table, and its cells by the names that `choose` gives.

    Empty cells are left out.
    """
    table = read_table(file, choose, where)
    return [
        (f"line {number}", {name: cells[i] for name, i in table.columns.items() if cells[i]})
        for number, cells in table.rows
    ]


def read_table(file: IO[bytes], choose: Choose, where: str) -> TextTable:
    """Return a text table with the columns that `choose` names.

    The header is the first line with words, or a comment before the data, as numpy.savetxt writes
    it. A table without header has the numbers of its columns for names.
    """
    lines = _lines(file, where)
    head = list(islice(lines, HEAD_LINES))  # enough lines to find the header in
    if not head:
        what = "is empty; its first line must name the columns, such as t,x,v"
        raise ParameterError("file", where, what)
    data = [i for i, line in enumerate(head) if line.has_data]
    comments = head[: data[0]] if data else head
    # The second line with data, tried first, shows the delimiter better than a header.
    telling = [head[i].text for i in data[:2]][::-1] or [comments[-1].text]
    delimiter = next((sign for sign in map(_delimiter, telling) if sign), None)
    first_row = _split_cells(head[data[0]].text, delimiter) if data else []
    in_comments = _headers_in(comments, delimiter, len(first_row))
    # A row with words may also be data, below a header that is a comment.
    if _are_numbers(first_row, delimiter):
        own = [str(i) for i in range(1, len(first_row) + 1)]
        headers = [*in_comments, own]
    else:
        own = first_row
        headers = [own, *in_comments]
    names, columns = _choose_header(headers, own, choose, where)
    has_header_row = names is first_row
    begin = len(comments) + has_header_row
    rows = _rows(chain(head[begin:], lines), delimiter, len(names), where)
    return TextTable(delimiter, columns, rows)


def _headers_in(comments: list[Line], delimiter: str | None, width: int) -> list[list[str]]:
    """Return the comments that may be the header of a table with `width` columns, the last
    first.
    """
    signs = "".join(COMMENT_SIGNS) + " "
    rows = [_split_cells(line.text.lstrip(signs), delimiter) for line in reversed(comments)]
    return [row for row in rows if not _are_numbers(row, None) and width in (0, len(row))]


def _choose_header(
    headers: list[list[str]], own: list[str], choose: Choose, where: str
) -> tuple[list[str], dict[str, int]]:
    """Return the first header in which `choose` finds its columns, and their positions.

    Of a comment a refusal only says that it is no header; so the message is that about the table's
    `own` header.
    """
    refusal: ParameterError | None = None
    for names in headers:
        try:
            columns = choose(names)
            for name in columns.values():
                if names.count(name) > 1:
                    what = f"has {brief(name)!r} twice; there are: {names_text(names)}"
                    raise ParameterError("file", where, what)
        except ParameterError as error:
            if names is own:
                refusal = error
        else:
            return names, {name: names.index(column) for name, column in columns.items()}
    assert refusal is not None
    raise refusal


def _rows(
    lines: Iterator[Line], delimiter: str | None, width: int, where: str
) -> Iterator[tuple[int, list[str]]]:
    """Yield the number and the cells of each line with data."""
    for number, text, has_data in lines:
        if has_data:
            cells = _split_cells(text, delimiter)
            if len(cells) != width:
                what = f"row {number} has {len(cells)} entries, the header {width}"
                raise ParameterError("file", where, what)
            yield number, cells


def _lines(file: IO[bytes], where: str) -> Iterator[Line]:
    """Yield each line of a text file that is not empty."""
    empty = 0
    with io.TextIOWrapper(file, "utf-8-sig", newline=None) as text:
        for number, line in enumerate(iter(partial(text.readline, LONGEST_LINE), ""), 1):
            if len(line) >= LONGEST_LINE or (number <= FIRST_LINES and "\0" in line):
                raise ParameterError("file", where, "cannot be read: it is not text in lines")
            content = line.strip(" \t\n\r\v\f,;")
            has_data = bool(content) and not content.startswith(COMMENT_SIGNS)
            empty += not has_data
            if empty > MOST_EMPTY_LINES and empty > 0.9 * number:
                raise ParameterError("file", where, f"has {empty:,} lines without data")
            if content:
                yield Line(number, line.strip("\n"), has_data)


# -- cells -----------------------------------------------------------------------------------------


def _delimiter(line: str) -> str | None:
    """Return the character that separates the cells of a line; None if blanks do."""
    line = re.sub('"[^"]*"', "", line)
    for sign in (";", "\t"):
        if sign in line:
            return sign
    cells = line.split()
    if "," in line and not (len(cells) > 1 and _are_numbers(cells, None)):
        return ","
    return None


def _split_cells(line: str, delimiter: str | None) -> list[str]:
    """Split a line of a table at its delimiter into cells."""
    if delimiter is None:
        return line.replace('"', " ").split()
    if '"' not in line:
        if " " not in line:
            return line.split(delimiter)
        return [cell.strip() for cell in line.split(delimiter)]
    quoted = csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True)
    return [cell.strip() for cell in next(quoted, [])]


def _are_numbers(cells: list[str], delimiter: str | None) -> bool:
    """Return whether all cells are numbers, NaN and infinities among them."""
    texts = (_written_plainly(cell, delimiter).strip() for cell in cells)
    return all(NUMBER.fullmatch(text) or NOT_FINITE.fullmatch(text) for text in texts)


def _written_plainly(cell: str, delimiter: str | None) -> str:
    """Return the text of a number as Python writes it, unless a comma separates the cells."""
    if "," in cell and delimiter == ",":
        return cell
    if "," in cell or "d" in cell or "D" in cell:
        return plain_number(cell)
    return cell


def plain_number(cell: str) -> str:
    """Return the text of a number with a point for a decimal comma, and with e for the d of a
    Fortran exponent.
    """
    return re.sub(r"([\d.])[dD]([+-]?\d)", r"\1e\2", cell.replace(",", "."))
