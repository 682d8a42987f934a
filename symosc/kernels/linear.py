"""Linear algebra of small matrices in plain arithmetic: the same bits on every processor.

BLAS and LAPACK choose their loops by the processor, so their results differ in the last bits, and
Newton's method from a far guess carries such bits to another root. Here everything is sums,
products, quotients and square roots in a fixed order, which every processor rounds alike. Matrices
may have about a hundred rows.
"""

from __future__ import annotations

from math import copysign, fsum, hypot, sqrt
from operator import mul
from typing import NamedTuple

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> float:
    """Return the scalar product of two vectors."""
    return float((a * b).sum())


def norm(a: np.ndarray) -> float:
    """Return the Euclidean length of a vector."""
    return float(np.sqrt(dot(a, a)))


def product(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Return `matrix` times `vector`."""
    return np.asarray((matrix * vector).sum(axis=1))


def largest_stretch(matrix: np.ndarray) -> float:
    """Return the most by which a matrix of two rows and columns lengthens a vector."""
    (a, b), (c, d) = matrix.tolist()
    return (hypot(a + d, b - c) + hypot(a - d, b + c)) / 2.0


class Factors(NamedTuple):
    """A square matrix with its rows in the order `order` as L U; L has ones on its diagonal."""

    rows: list[list[float]]
    order: list[int]

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the vector x with matrix x = `right`."""
        known = right.tolist()
        x = [known[i] for i in self.order]
        count = len(x)
        # First by the lower triangle of factors, then by the upper one, from below.
        for i, row in enumerate(self.rows):
            for j in range(i):
                x[i] -= row[j] * x[j]
        for i in reversed(range(count)):
            row = self.rows[i]
            for j in range(i + 1, count):
                x[i] -= row[j] * x[j]
            x[i] = x[i] / row[i]
        return np.array(x)


def factors(matrix: np.ndarray) -> Factors:
    """Return the factors of a square matrix by Gauss's elimination.

    Raise ZeroDivisionError if it is singular.
    """
    rows = matrix.tolist()
    order = list(range(len(rows)))
    for k in order.copy():
        column = [abs(row[k]) for row in rows[k:]]
        pivot = k + column.index(max(column))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        order[k], order[pivot] = order[pivot], order[k]
        top = rows[k]
        for row in rows[k + 1 :]:
            if row[k] == 0.0:  # as most are in the closing equations of an orbit
                continue
            factor = row[k] / top[k]
            row[k] = factor  # in the place of the 0: `solve` takes the same steps on a right side
            row[k + 1 :] = [
                value - factor * above
                for value, above in zip(row[k + 1 :], top[k + 1 :], strict=True)
            ]
        if top[k] == 0.0:
            raise ZeroDivisionError("the matrix is singular")
    return Factors(rows, order)


def solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return the vector x with matrix x = `right`; raise ZeroDivisionError if it is singular."""
    return factors(matrix).solve(right)


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a square matrix; raise ZeroDivisionError if it is singular."""
    divided = factors(matrix)
    return np.stack([divided.solve(column) for column in np.eye(len(matrix))], axis=1)


class Triangle(NamedTuple):
    """A matrix with its columns in the order `order` as Q R.

    Q is a product of reflections, and R has the columns `columns`.
    """

    reflections: list[tuple[list[float], float]]
    columns: list[list[float]]
    order: list[int]

    def turned(self, vector: list[float]) -> list[float]:
        """Return the transpose of Q times a vector."""
        image = vector.copy()
        for k, reflection in enumerate(self.reflections):
            image[k:] = _mirrored(image[k:], *reflection)
        return image

    def turned_back(self, vector: list[float]) -> list[float]:
        """Return Q times a vector."""
        image = vector.copy()
        for k, reflection in reversed(list(enumerate(self.reflections))):
            image[k:] = _mirrored(image[k:], *reflection)
        return image


def _product(a: list[float], b: list[float]) -> float:
    """Return the scalar product of two lists."""
    return fsum(map(mul, a, b))


def _mirrored(vector: list[float], normal: list[float], weight: float) -> list[float]:
    """Return the mirror image of a vector in the plane with that normal.

    `weight` is 2 over the normal's length squared.
    """
    part = weight * _product(normal, vector)
    if part:
        return [value - part * step for value, step in zip(vector, normal, strict=True)]
    return vector


def triangle(columns: list[list[float]]) -> Triangle:
    """Return Q R of a matrix by Householder's reflections, the largest column left always first."""
    columns = columns.copy()
    order = list(range(len(columns)))
    reflections = []
    for k in range(min(len(columns), len(columns[0]))):
        sizes = [_product(column[k:], column[k:]) for column in columns[k:]]
        size = max(sizes)
        largest = k + sizes.index(size)
        columns[k], columns[largest] = columns[largest], columns[k]
        order[k], order[largest] = order[largest], order[k]
        # The reflection turns what is left of the column into its first axis. Of the two that do,
        # this one adds numbers of the same sign, so that no digits cancel.
        normal = columns[k][k:]
        normal[0] += copysign(sqrt(size), normal[0])
        if size > 0.0:
            weight = 2.0 / _product(normal, normal)
        else:
            weight = 0.0
        reflections.append((normal, weight))
        for column in columns[k:]:
            column[k:] = _mirrored(column[k:], normal, weight)
    return Triangle(reflections, columns, order)


def pseudo_inverse(matrix: np.ndarray, least: float) -> np.ndarray:
    """Return the matrix that maps each vector to the solution of `Shortest`."""
    shortest = Shortest(matrix, least)
    return np.stack([shortest.solve(column) for column in np.eye(len(matrix))], axis=1)


class Shortest:
    """For a matrix, the shortest x that makes matrix x - right shortest.

    Directions that the matrix stretches by less than `least` times its largest stretch are left
    alone. ValueError or OverflowError is raised if the matrix is not finite.
    """

    def __init__(self, matrix: np.ndarray, least: float) -> None:
        if not np.isfinite(matrix).all():
            raise ValueError("the matrix is not finite")
        self.first = triangle(matrix.T.tolist())
        sizes = [abs(column[k]) for k, column in enumerate(self.first.columns[: len(matrix)])]
        self.rank = sum(size > least * max(sizes) for size in sizes)
        # Of fewer rows than columns the shortest solution is a sum of the rows.
        rows = [
            [column[k] if j >= k else 0.0 for j, column in enumerate(self.first.columns)]
            for k in range(self.rank)
        ]
        self.second = triangle(rows) if rows else None

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return the shortest solution."""
        count = len(self.first.order)
        if self.second is None:
            return np.zeros(count)
        turned = self.first.turned(right.tolist())
        middle = [0.0] * count
        for k, row in enumerate(self.second.order):
            column = self.second.columns[k]
            middle[k] = (turned[row] - _product(column[:k], middle[:k])) / column[k]
        solution = np.zeros(count)
        solution[self.first.order] = self.second.turned_back(middle)
        return solution


def null_vector(matrix: np.ndarray) -> np.ndarray:
    """Return a unit vector that a matrix of one row less than columns maps to 0."""
    # Q turns the first axes into combinations of the rows, and so the last axis into a vector that
    # is perpendicular to all rows.
    last_axis = [0.0] * matrix.shape[1]
    last_axis[-1] = 1.0
    return np.array(triangle(matrix.tolist()).turned_back(last_axis))
