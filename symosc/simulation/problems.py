"""Many initial value problems in columns, read exactly and checked together.

Objects are made on demand.

A float is the decimal that it prints as (`symosc.base.exact`). In a column it is its double, and what
that lacks. What doubles do not decide about a start is left to `symosc.engine.start`, motion by
motion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Sized
from decimal import Context, Decimal
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np

from symosc.base.errors import ParameterError
from symosc.base.exact import LARGEST, scalar_of, show, unmasked
from symosc.base.quantities import forcing_periods, least, number_of_belt, read_number
from symosc.engine.arithmetic import Arithmetic, rows_in_doubles
from symosc.engine.batch import Batch, batch_of
from symosc.engine.flow import ConstantRows, TableLoops, constant_table, table_of
from symosc.engine.start import MOST_PERIODS, Start, first_row_in_doubles, start_rows
from symosc.engine.state import PAIR_ROW, STATE_ROW
from symosc.friction import BELT_NAMES, PAPER_BELTS, REQUIRED_OF_BELT, TWO_BELTS
from symosc.kernels.double_double import TWO_PI_PAIR, two_product
from symosc.kernels.pair_columns import PairColumn
from symosc.model import (
    OSCILLATOR_NAMES,
    PARAMETER_NAMES,
    Model,
    Parameters,
    belts_named,
    model_from,
)
from symosc.scenes import START_NAMES, check_periods

START_COLUMNS = START_NAMES[:3]
#: Names of columns that may be there, and of those that are left out where there is one belt.
OPTIONAL_NAMES = tuple(
    f"{name}{n}"
    for n in TWO_BELTS.boundaries
    for name in BELT_NAMES
    if name not in REQUIRED_OF_BELT
)
OF_BELT_2 = {f"{name}2" for name in BELT_NAMES}

# So few motions are begun one by one: operations on columns cost more.
BEGUN_ALONE = 8
TWO_PI_COLUMN = PairColumn(*TWO_PI_PAIR)
# Phases of pairs are right to the last bit of a double up to so large an angle, and unless they are
# so near 0.
LARGEST_ANGLE = 2.0**40
SMALLEST_PHASE = 2.0**-45
# Decimal powers that are exact as doubles, and the sizes of numbers whose digits they reach.
POWERS = np.array([10.0**n for n in range(23)])
LEAST_IN_REACH = 1e-5
MOST_IN_REACH = 1e15
# Enough digits for any double and the decimal that it prints as.
DECIMAL_CONTEXT = Context(prec=800)


class NumberColumn:
    """A column of numbers as given, one per row or one for all: exact, and as doubles `hi` with
    remainders `lo`.
    """

    def __init__(self, name: str, values: Any) -> None:
        values = _as_numpy(name, values)
        alone = not isinstance(values, Sized) or isinstance(values, (str, bytes, Mapping))
        if alone:
            # with a second entry numpy does not look into the first, whatever it is
            values = np.array([values, None], dtype=object)[:1]
        elif not isinstance(values, np.ndarray):
            values = np.asarray(list(values), dtype=object)
        if values.ndim != 1:
            raise ParameterError(
                name,
                values,
                f"must be a number or an array of shape (n,), not of shape {values.shape}",
            )
        self.single = len(values) == 1
        if (
            not self.single
            and values.dtype == object
            and all(type(value) is float for value in values)
        ):
            values = values.astype(float)
        self.name = name
        self._given = values
        self._exact = dict[int, Fraction]()
        plain = not self.single and values.dtype == np.float64
        if plain:
            self.hi, self.lo = self._split_doubles(values)
        else:
            self.hi, self.lo = self._split_numbers(values)
        self.is_plain = plain or self.single  # then equal doubles are equal numbers

    def _split_doubles(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the doubles `values`, and what they lack to the numbers meant: the decimals that
        they print as.
        """
        largest = f"must be at most {float(LARGEST):g} in size"
        for bad, reason in (
            (~np.isfinite(values), "must be finite"),
            (abs(values) > float(LARGEST), largest),
        ):
            if bad.any():
                row = int(bad.argmax())
                raise ParameterError(self.called(row), float(values[row]), reason)
        lo, sure = decimal_rest(values)
        for row in np.flatnonzero(~sure).tolist():
            value = float(values[row])
            lo[row] = float(DECIMAL_CONTEXT.subtract(Decimal(repr(value)), Decimal(value)))
        return np.array(values), lo

    def _split_numbers(self, values: Any) -> tuple[np.ndarray, np.ndarray]:
        """Read numbers of any kind exactly.

        Return them rounded to doubles hi, and the remainders lo.
        """
        known: dict[Any, tuple[float, float]] = {}
        parts = np.empty((2, len(values)))
        for row, entry in enumerate(values):
            value = scalar_of(self.name, entry)
            # Numbers of two types may be equal and mean two fractions: the float 0.1 is 1/10,
            # Fraction(0.1) is not. A fraction is known by its identity: to hash it takes longer
            # than to convert it.
            if isinstance(value, Fraction):
                key: Any = id(value)
            else:
                key = (type(value), value)
            try:
                pair = known.get(key)
            except TypeError:  # a list, or another thing that is no number
                pair = None
            if pair is None:
                exact = self._exact[row] = read_number(self.called(row), value)[0]
                pair = known[key] = float(exact), float(exact - Fraction(float(exact)))
            parts[:, row] = pair
        return parts[0], parts[1]

    def __len__(self) -> int:
        return len(self._given)

    def called(self, row: int) -> str:
        """Return the name of a row's number for messages, such as x0[3]."""
        if self.single:
            return self.name
        return f"{self.name}[{row}]"

    def exact(self, row: int) -> Fraction:
        """Return the exact number in a row."""
        if not (len(self) > 1):
            row = 0
        if row in self._exact:
            return self._exact[row]
        return read_number(self.called(row), self._given[row])[0]

    def pairs(self, rows: Any = slice(None)) -> PairColumn:
        """Return some rows, or the common number, as a column of pairs."""
        if len(self) > 1:
            return PairColumn(self.hi[rows], self.lo[rows])
        return PairColumn(self.hi, self.lo)


def _as_numpy(name: str, value: Any) -> Any:
    """Convert an array-like (pandas or xarray column) to a numpy array, a 0-d array to a number.

    Refuse masked ones.
    """
    unmasked(name, value)
    if isinstance(value, np.ndarray) or (hasattr(value, "__array__") and hasattr(value, "shape")):
        array = np.asarray(value)
        if array.ndim == 0:
            return array[()]
        return array
    return value


def named(name: str, data: Any, wanted: tuple[str, ...]) -> Any:
    """Return columns given by name (mapping, table, record array) in the order of `wanted`.

    Other data unchanged.
    """
    names = getattr(getattr(data, "dtype", None), "names", None)
    if isinstance(data, Mapping):
        names = list(data)
    elif names is None and hasattr(data, "__getitem__"):
        labels = getattr(data, "columns", getattr(data, "index", None))
        # A list has a method `index`.
        if labels is None or callable(labels):
            names = None
        else:
            names = list(labels)
        if not (names and any(isinstance(label, str) for label in names)):
            names = None
    if names is None:
        return data
    if sorted(map(str, names)) != sorted(wanted):
        said = f"must have the names {', '.join(wanted[:-1])} and {wanted[-1]}, and no other"
        raise ParameterError(name, [str(label) for label in names], said)
    return {label: data[label] for label in wanted}


def decimal_rest(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the shortest decimal of each double minus the double, and flags: False where this was
    not found.
    """
    # The shortest decimal has 15, 16 or 17 digits: the first of them that is within half a unit of
    # the double. Scaled by a power of ten that is exact as a double, its distance from the double
    # is exact.
    size = abs(values)
    inside = (size >= LEAST_IN_REACH) & (size < MOST_IN_REACH) & (np.frexp(size)[0] != 0.5)
    usual = np.where(inside, size, 3.0)  # any number will do in the other rows
    exponent = np.floor(np.log10(usual)).astype(np.int64)
    unit = 0.5 * np.spacing(usual)
    rest = np.zeros(len(values))
    sure = values == 0.0
    is_decided = inside | sure
    for digits in (15, 16, 17):
        power = POWERS[np.clip(digits - 1 - exponent, 0, 22)]
        high, low = two_product(usual, power)
        near = np.rint(high)
        over = (high - near) + low
        lacking = np.rint(over) - over
        fits = inside & ~sure & (abs(lacking) < unit * power)
        rest = np.where(fits, np.sign(values) * lacking / power, rest)
        sure = sure | fits
    # Other whole numbers print as they are: powers of two, as a rule 1, 2 or 4.
    is_whole = ~is_decided & (size < 2.0**53) & (np.rint(size) == size)
    return rest, sure | is_whole


class ParameterSets:
    """Parameter sets, read from Parameters or Oscillators, a sequence of them, or a mapping of all
    names to numbers or arrays.

    Attributes
    ----------
    names : tuple of str
        The names of all columns.
    """

    def __init__(self, parameters: Any) -> None:
        self._known = dict[int, Model]()
        self.columns = dict[str, NumberColumn]()
        self._is_object = False
        #: Whether all have one row of constants (`symosc.friction.FrictionLaw.is_plain`).
        self.are_plain = True
        if isinstance(parameters, Mapping):
            self._read_mapping(parameters)
            return
        try:
            if isinstance(parameters, Model):
                sets: list[Any] = [parameters]
            else:
                sets = list(parameters)
        except TypeError:
            sets = [None]
        if not sets or not all(isinstance(p, Model) for p in sets):
            hint = (
                "give Parameters, a sequence of them, or a mapping of all their names to numbers "
                "or columns"
            )
            raise ParameterError("parameters", parameters, hint)
        self._known = dict(enumerate(sets))
        self.count = len(sets)
        self._is_object = len(sets) == 1
        self.are_plain = all(p.law.is_plain for p in sets)
        self.names = _common_names(sets)

    def _read_mapping(self, parameters: Mapping[str, Any]) -> None:
        """Read a mapping of all parameters' names to numbers or columns."""
        if any(is_name_of_other_law(name) for name in parameters):
            self._read_other_laws(parameters)
            return
        known = (*PARAMETER_NAMES, *OPTIONAL_NAMES)
        for name in parameters:
            if name not in known:
                raise ParameterError(
                    str(name),
                    parameters[name],
                    f"unknown parameter; choose from {', '.join(known)}",
                )
        one_belt = not parameters.keys() & OF_BELT_2
        required = [name for name in PARAMETER_NAMES if not (one_belt and name in OF_BELT_2)]
        for name in required:
            if name not in parameters:
                raise ParameterError("parameters", dict(parameters), f"{name} is missing")
        self.names = (*required, *(name for name in OPTIONAL_NAMES if name in parameters))
        columns = self.columns = {name: NumberColumn(name, parameters[name]) for name in self.names}
        self.count = common_length({name: len(column) for name, column in columns.items()})
        # Rows that may be wrong are read as objects, which say why.
        # Optional names are those of belts: without its number `mu_s1` is the quantity mu_s.
        lowest = {name: least(name if name in required else name[:-1]) for name in self.names}
        doubtful = [
            columns[name].hi < float(low) for name, low in lowest.items() if low is not None
        ]
        if not one_belt:
            doubtful.append(columns["v2"].hi <= columns["v1"].hi)
        for n in self.boundaries:
            if f"mu_s{n}" in self.names:
                doubtful.append(columns[f"mu_s{n}"].hi <= columns[f"mu{n}"].hi)
        for rows in doubtful:
            for row in np.flatnonzero(rows).tolist():
                self._checked(row)

    def _read_other_laws(self, parameters: Mapping[str, Any]) -> None:
        """Read a mapping of the names of an `Oscillator` with curves, or with more than two belts."""
        self.names = tuple(map(str, parameters))
        self.columns = {name: NumberColumn(name, parameters[name]) for name in self.names}
        self.count = common_length({name: len(column) for name, column in self.columns.items()})
        self.are_plain = False
        for name in ("m", "c", "k"):
            if name not in self.names:
                raise ParameterError("parameters", dict(parameters), f"{name} is missing")
        for row in range(self.count):
            self._known[row] = self._checked(row)

    def _checked(self, row: int) -> Model:
        """Return the parameters of a row; the message of an error includes the row's number."""
        try:
            return model_from({name: column.exact(row) for name, column in self.columns.items()})
        except ParameterError as error:
            column = self.columns.get(error.name)
            if column is None:  # it is about more than one number
                raise
            raise ParameterError(column.called(row), error.value, error.allowed) from None

    @property
    def boundaries(self) -> range:
        """The numbers of the belts."""
        return range(1, belts_named(self.names) + 1)

    def given(self) -> list[Model]:
        """Return the sets that are known as objects: all, unless they were given as columns."""
        return list(self._known.values())

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, i: int) -> Model:
        if not (self.count > 1):
            i = 0
        if i not in self._known:
            self._known[i] = self._checked(i)
        return self._known[i]

    def column(self, name: str) -> NumberColumn:
        """Return the column of the parameter `name`; zeros for one of a missing belt."""
        if name not in self.columns and self._known:
            values = [number_of(p, name) for p in self._known.values()]
            self.columns[name] = NumberColumn(name, values)
        return self.columns.get(name) or NumberColumn(name, 0)

    def doubles(self, names: Sequence[str], rows: slice) -> np.ndarray:
        """Return the parameters with these names as doubles, (sets, names), for the sets in `rows`."""
        columns = [
            np.broadcast_to(self.column(name).pairs(rows).hi, rows.stop - rows.start)
            for name in names
        ]
        return np.stack(columns, axis=1)

    def table(self, rows: slice, loops: TableLoops) -> np.ndarray:
        """Return a table of the constants of the sets in `rows`, computed by `loops`."""
        if self.are_plain:
            return self._plain_table(rows, loops)
        return table_of(K for i in range(rows.start, rows.stop) for K in rows_in_doubles(self[i]))

    def _plain_table(self, rows: slice, loops: TableLoops) -> np.ndarray:
        """Return the table of sets that have one row each."""
        if self._is_object:
            return table_of([Arithmetic(self[0]).K])
        if rows.stop == rows.start:
            return table_of([])
        # However few they are: the bits must not depend on how a sweep is cut into calls.
        columns = {name: self.column(name).pairs(rows) for name in self.names}
        size = rows.stop - rows.start
        if size == 0:
            return table_of([])
        return constant_table(columns, size, lambda i: Arithmetic(self[rows.start + i]).K, loops)


def is_name_of_other_law(name: Any) -> bool:
    """Return whether a parameter's name is that of a curve, or of a third belt."""
    of_belt = number_of_belt(str(name))
    if of_belt is None:
        return False
    return of_belt.point > 0 or of_belt.quantity == "slope" or of_belt.belt > PAPER_BELTS


def _common_names(sets: Sequence[Model]) -> tuple[str, ...]:
    """Return the names of the columns of parameter sets, which must have equally many belts."""
    belts = {len(p.law.belts) for p in sets}
    if len(belts) > 1:
        counts = " and ".join(map(str, sorted(belts)))
        raise ParameterError(
            "parameters",
            f"{len(sets)} sets",
            f"must all have the same number of belts, not {counts}",
        )
    if all(isinstance(p, Parameters) for p in sets):
        return PARAMETER_NAMES
    numbers = sets[0].law.boundaries
    return (*OSCILLATOR_NAMES, *(f"{name}{n}" for n in numbers for name in BELT_NAMES))


def number_of(p: Model, name: str) -> Fraction:
    """Return a parameter by its name: for a static coefficient that is not there the kinetic one,
    for one of a missing belt 0.
    """
    if name in OSCILLATOR_NAMES:
        return getattr(p, name)
    numbers = p.numbers()
    if name in numbers:
        return numbers[name]
    return numbers.get(name.replace("mu_s", "mu"), Fraction(0))


class Problems:
    """Initial value problems in columns; indexing makes the `Start` of one of them."""

    def __init__(self, parameters: Any, starts: Any, t_end: Any, start_error: Any = None) -> None:
        self.sets = ParameterSets(parameters)
        if start_error and max(start_error) > 0:
            self.start_error = start_error
        else:
            self.start_error = None
        self.t0, self.x0, self.v0 = _start_columns(starts)
        lengths = {"parameters": len(self.sets)}
        lengths["starts"] = common_length(
            {column.name: len(column) for column in (self.t0, self.x0, self.v0)}
        )
        common_length(lengths)
        if (periods := forcing_periods("t_end", t_end)) is not None:
            for p in self.sets.given():
                check_periods("t_end", t_end, p)
            t_end = self.t0.hi + float(periods) * (2 * pi / self.sets.column("Omega").hi)
        self.t_end = NumberColumn("t_end", t_end)
        self.count = common_length(lengths | {"t_end": len(self.t_end)})
        for row in np.flatnonzero(
            np.broadcast_to(self.t_end.hi <= self.t0.hi, self.count)
        ).tolist():
            t0 = self.t0.exact(row)
            end = self.t_end.exact(row)
            if end <= t0:
                raise ParameterError(
                    self.t_end.called(row), show(end), f"must be later than t0 = {show(t0)}"
                )

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, i: int) -> Start:
        t0, x0, v0, end = (column.exact(i) for column in (self.t0, self.x0, self.v0, self.t_end))
        return Start(self.sets[i], t0, x0, v0, end, self.start_error)

    def begin(self, rows: slice, loops: TableLoops) -> tuple[Batch, np.ndarray]:
        """Return the motions in `rows` as a batch at the start, and their constants (see
        `ParameterSets.table`).
        """
        size = rows.stop - rows.start
        table = self.sets.table(rows if len(self.sets) != 1 else slice(0, 1), loops)
        first = np.flatnonzero(table["row"] == 0)  # where the constants of a set begin
        sets = np.broadcast_to(first, size).copy()
        if len(self) <= BEGUN_ALONE:
            states = np.empty(size, STATE_ROW)
            unclear = np.ones(size, dtype=bool)
        else:
            if not self.sets.are_plain:
                sets = self._bands(rows, table, sets)
            states, unclear = self._start_rows(rows, table, sets)
            sets[unclear] = np.broadcast_to(first, size)[unclear]
        for i in np.flatnonzero(unclear).tolist():
            row, states[i] = first_row_in_doubles(self[rows.start + i])
            sets[i] += row
        return batch_of(states, sets), table

    def _bands(self, rows: slice, table: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Return the rows of `table` in which motions start, given those where their laws begin."""
        v = np.broadcast_to(self.v0.pairs(rows).hi, len(first))
        bands = first.copy()
        while True:
            beyond = v > table["belt2"]["v"][bands]
            if not beyond.any():
                return bands
            bands[beyond] += 1

    def _start_rows(
        self, rows: slice, table: np.ndarray, sets: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the first states of the motions in `rows` in doubles, and flags of those to be
        begun one by one.

        `sets` are the rows of `table` that have their constants.
        """
        size = rows.stop - rows.start
        unclear = np.zeros(size, dtype=bool)
        at = np.zeros(size, np.int64)
        t0, t_end, x0, v0 = (
            column.pairs(rows) for column in (self.t0, self.t_end, self.x0, self.v0)
        )
        if self.sets.are_plain:
            for boundary in self.sets.boundaries:
                same, alike = self._at_belt(boundary, rows)
                at[same] = boundary
                unclear[alike] = True
        else:
            for edge in ("belt1", "belt2"):
                unclear |= v0.hi == table[edge]["v"][sets]
        Omega = self.sets.column("Omega").pairs(rows)
        angle = Omega * t0
        theta = angle - TWO_PI_COLUMN * PairColumn(np.floor((angle / TWO_PI_COLUMN).hi))
        unclear |= (angle.hi != 0.0) & ~(
            (abs(angle.hi) < LARGEST_ANGLE)
            & (theta.hi > SMALLEST_PHASE * abs(angle.hi))
            & (theta.hi < TWO_PI_COLUMN.hi)
        )
        times = np.broadcast_arrays(t0.hi, t0.lo, t_end.hi, t_end.lo, t0.hi)
        if len(table) == 1:
            K = ConstantRows(table)[0]
        elif self.sets.are_plain:
            K = table.view(np.recarray)
        else:
            K = table[sets].view(np.recarray)
        driven = np.asarray(K.driven) != 0
        # 6/Omega is a little less than a period, 0.9 chunk than what one search covers.
        longest = np.where(driven, 6.0 / Omega.hi, 0.9 * np.asarray(K.chunk)) * MOST_PERIODS
        unclear |= t_end.hi - t0.hi > longest  # near the end of what is followed at all
        states, small_force = start_rows(at, (theta.hi, theta.lo), x0.hi, v0.hi, times, K)
        return states, unclear | small_force | bool(self.start_error)

    def _at_belt(self, boundary: int, rows: slice) -> tuple[np.ndarray, np.ndarray]:
        """Return the motions in `rows` whose v0 is the speed of belt `boundary`, and those that
        only round to it.
        """
        speed = self.sets.column(f"v{boundary}")
        v = self.v0.pairs(rows)
        belt = speed.pairs(rows)
        near = np.flatnonzero(np.broadcast_to(v.hi == belt.hi, rows.stop - rows.start))
        # Equal doubles of plain columns are equal numbers, so one row tells of all.
        if self.v0.is_plain and speed.is_plain:
            asked = near[:1]
        else:
            asked = near
        equal = [self.v0.exact(i) == speed.exact(i) for i in (rows.start + asked).tolist()]
        on_belt = np.broadcast_to(np.array(equal, dtype=bool), len(near))
        return near[on_belt], near[~on_belt]

    def surely_fit_pairs(self, rows: np.ndarray, at: np.ndarray, gap: float) -> np.ndarray:
        """Return which motions pairs surely suit: B0 not 0, start exact, v0 more than `gap` off all
        belts but `at`.
        """
        v = self.v0.pairs(rows).hi
        B0 = self.sets.column("B0").pairs(rows).hi
        is_exact = self.start_error is None
        apart = np.full(len(rows), is_exact and self.sets.are_plain) & (B0 != 0.0)
        for boundary in self.sets.boundaries:
            apart &= (at == boundary) | (
                abs(v - self.sets.column(f"v{boundary}").pairs(rows).hi) > gap
            )
        return apart

    def pair_rows(
        self, rows: np.ndarray, states: np.ndarray, phase: Callable[[Fraction], complex]
    ) -> np.ndarray:
        """Return the starts of motions with equal parameters in pairs, stored as complex numbers hi
        + i lo.

        `states` are the same starts in doubles, and `phase` returns the phase at a time as such a
        complex number.
        """
        # Forces and what follows from them are left to `symosc.engine.batch.first_pairs`.
        in_pairs = np.zeros(len(rows), PAIR_ROW)
        in_pairs["mode"] = states["mode"]
        in_pairs["at"] = states["at"]
        for name, column in (("x", self.x0), ("v", self.v0), ("t", self.t0)):
            pairs = column.pairs(rows)
            in_pairs[name].real = pairs.hi
            in_pairs[name].imag = pairs.lo
        in_pairs["t_end"].real = states["t_end"]
        in_pairs["t_end"].imag = states["t_end_low"]
        in_pairs["t0"] = in_pairs["t"]
        known = {0j: 0j}  # phases by times, which many motions share; both are 0 at t0 = 0
        for i, t0 in enumerate(in_pairs["t0"].tolist()):
            if t0 not in known:
                known[t0] = phase(self.t0.exact(int(rows[i])))
            in_pairs["theta"][i] = known[t0]
        return in_pairs


def _start_columns(starts: Any) -> tuple[NumberColumn, NumberColumn, NumberColumn]:
    """Return the columns t0, x0 and v0 of starts, given as rows of these or as a mapping of these
    names.
    """
    starts = named("starts", starts, START_COLUMNS)
    if isinstance(starts, Mapping):
        columns = [starts[name] for name in START_COLUMNS]
    else:
        rows = _as_numpy("starts", starts)
        if not isinstance(rows, np.ndarray):
            rows = np.asarray(starts, dtype=object)
        if rows.ndim == 1:
            rows = rows.reshape(1, -1)
        if rows.ndim != 2 or rows.shape[1] != 3:
            hint = (
                "must have shape (n, 3), rows of t0, x0, v0, or be a mapping of these names; it "
                f"has {rows.shape}"
            )
            raise ParameterError("starts", starts, hint)
        columns = list(rows.T)
    t0, x0, v0 = (
        NumberColumn(name, column) for name, column in zip(START_COLUMNS, columns, strict=True)
    )
    return t0, x0, v0


def common_length(lengths: dict[str, int]) -> int:
    """Return the common number of rows of columns, given their lengths by name.

    A single number fits any length.
    """
    longest = max(lengths, key=lambda name: (lengths[name] != 1, lengths[name]))
    count = lengths[longest]
    for name, length in lengths.items():
        if length not in (1, count):
            allowed = f"must have 1 or {count} values, since {longest} has {count}"
            raise ParameterError(name, f"{length} values", allowed)
    return count
