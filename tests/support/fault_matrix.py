"""Kinds of fault times scenes times samplings: which are found, which are called by their name.

Those in OTHERS have no name: of them it has to be said that the cause is unknown.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from itertools import islice, product

import numpy as np
from evidence import false_sentences
from excerpts import crosscheck
from fault_kinds import KINDS, OTHERS, Spoilt, spoil
from fault_scenes import SAMPLINGS, Case, cases

from symosc.crosschecks.compare import CrossCheck

SEED = 1


def is_named(check: CrossCheck, spoilt: Spoilt, first_only: bool = False) -> bool:
    """Return whether the first diagnosis is the right one, or one that the samples cannot tell from it."""
    if not check.diagnosis:
        return False
    first = check.diagnosis[0]
    names = {
        (one.cause, one.subject) for one in (first, *(() if first_only else first.alternatives))
    }
    return any((cause, subject) in names or (not subject and cause in {name for name, _ in names})
               for cause, subject in spoilt.causes)  # fmt: skip


def judge(
    kind: str, case: Case, sampling: str, seed: int
) -> tuple[bool, bool, CrossCheck, Spoilt] | None:
    """Return whether a fault is found and named; None if there is none."""
    spoilt = spoil(kind, case, sampling, seed)
    if spoilt is None:
        return None
    check = crosscheck(case.scene, spoilt.t, spoilt.x, spoilt.v, events=spoilt.events)
    # Rounded data are not wrong at their own precision; that they are rounded is to be said.
    found = not check.ok or (kind == "few digits" and bool(check.diagnosis))
    return found, found and is_named(check, spoilt), check, spoilt


def table(counts: Counter[tuple[str, str]]) -> str:
    """Return the counts of each kind as lines of text."""
    rows = [
        f"{'kind of fault':25} {'faults':>7} {'found':>7} {'named':>7} {'first':>7} {'false':>7} {'twins':>7}"
    ]
    for kind in (kind for kind in (*KINDS, "named kinds", "others") if counts[kind, "faults"]):
        total = counts[kind, "faults"]
        parts = (
            counts[kind, what] / max(total, 1) for what in ("found", "named", "first", "false")
        )
        shares = " ".join(f"{part:7.1%}" for part in parts)
        rows.append(f"{kind:25} {total:7d} {shares} {counts[kind, 'twins']:7d}")
    return "\n".join(rows)


def run(seed: int, chosen: Iterable[tuple[str, Case, str]]) -> Counter[tuple[str, str]]:
    """Judge faults and count them.

    "twins" are those whose samples another fault makes as well; both names are right for them.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for kind, case, sampling in chosen:
        judged = judge(kind, case, sampling, seed)
        if judged is None:
            continue
        found, named, check, spoilt = judged
        false = false_sentences(check)
        for name in (kind, "others" if kind in OTHERS else "named kinds"):
            counts[name, "faults"] += 1
            counts[name, "found"] += found
            counts[name, "named"] += named
            counts[name, "first"] += named and is_named(check, spoilt, first_only=True)
            counts[name, "false"] += bool(false)
            counts[name, "twins"] += spoilt.twin
    return counts


def drawn(count: int, seed: int) -> list[tuple[str, Case, str]]:
    """Return some rows of the matrix, as many of each kind as they can be."""
    rows = []
    for kind in KINDS:
        rng = np.random.default_rng([seed, *map(ord, kind)])
        pairs = list(product(cases(), SAMPLINGS))
        chosen = [pairs[i] for i in rng.permutation(len(pairs)).tolist()]
        possible = (pair for pair in chosen if spoil(kind, *pair, SEED) is not None)
        rows += [(kind, *pair) for pair in islice(possible, count)]
    return rows


def whole() -> list[tuple[str, Case, str]]:
    return [(kind, case, sampling) for case, kind, sampling in product(cases(), KINDS, SAMPLINGS)]
