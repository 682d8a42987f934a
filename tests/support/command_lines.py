"""Command lines for a fuzz: valid ones, hostile words, and random changes of the one by the other."""

from __future__ import annotations

import random
import shlex
from pathlib import Path

import click
from cli_runs import COMMANDS

from symosc.cli.app import main

#: Commands that serve, compile or compute for minutes whatever their words are.
LEFT_OUT = ("bench", "explore", "reproduce", "warm")
#: What would write into the package, or wait for another machine.
FORBIDDEN = ("--regenerate", "dask")

SAMPLES = "t,x,v\n0,0,0\n0.1,0.001,0.02\n0.2,0.004,0.04\n"
EVENTS = "t,kind\n0.1223,stick\n1.221,slip\n"
#: Files that the valid command lines read.
FILES = {
    "run.csv": SAMPLES,
    "events.csv": EVENTS,
    "broken.toml": "t_end = ",
    "empty.csv": "",
    "half.json": "{",
}

VALID = """
simulate fig5 --t-end 2
simulate fig6 --t-end 3 --json
simulate fig9 --set k=3 --x0 1/2 --t-end 10T --max-events 3
simulate fig5 --t-end 2 --csv -
simulate fig5 --t-end 1 --digits 20
simulate fig5 --t-end 1 --start-error 1e-6,0,0
figure fig6 -o z.svg --panels a --t-end 2
scenes
scenes fig5 --json
new mine.toml --like fig9
orbit fig9 --structure P32 --json
orbit fig9 --structure P32 --continue Omega=3.9:4.0
fit fig5 events.csv --free mu1 --sigma 1e-3
grazing fig9 --map P2 --json
grazing fig9 --map P2 --latex
grazing fig9 --map P2 --check 5
grazing --map P2 --solve Omega --phase 7*pi/6
check run.csv --scene fig5 --partial
check fig5 run.csv --own-start --partial --columns t=t,x=x,v=v --tolerance 1e-6
check run.csv --case paper-fig5 --partial
cases --group easy --json
score nowhere run.csv
atlas fig9 --over Omega=3.9:4.1 --over FN=9.5:10.5 --seconds 1 --workers 1
attractors fig9 --over x0=-1:1:2 --over v0=-1:1:2 --t-end 80T
certify fig6 --t-end 2 -o proof.json
certify fig9 --window P2
certify fig6 --t-end 2 --wrt mu1,x0
verify proof.json
derive P3 --form paper --set k=4 --set m=1 --set c=2/5
derive theorem7 --alone -o theorem7.tex
codegen P32 --language c --fix fig9 -o -
sweep fig9 --over Omega=3:5:3 --t-end 12T --skip 10T --json
sweep fig9 --over Omega=3:5:2 --record word,events --t-end 5T -o map.csv
""".strip().splitlines()

WORDS = [
    "", " ", "-", "--", "---", "=", "k=", "=3", "k==3", "Omega=nan", "Omega=1:2:0", "Omega=2:1:5", "Omega=1:2:1e400",
    "nan", "inf", "-inf", "1e400", "1e-400", "1e22", "1e200", "1e51", "10T", "-1T", "T", "1e22T", "2π", "50%", "3 kg",
    "3 lightyears", "1/0", "0x10", "1_000", "+-3", "²", "٣", "0", "-1", "1,2", "1,2,3", ",", ":", "1:2", "9" * 5000,
    "1." + "0" * 330 + "1", "a" * 10_000, "P" * 1000, "P32" * 500, "\n", "\t", "\udcff", "é\u202e", "%s%n", "{}",
    "$(true)", "; true", "../..", ".", "no/such/x.svg", "z.pdf", "z.xyz", ".svg", "run.csv", "events.csv", "empty.csv",
    "half.json", "broken.toml", "/dev/null", "fig5", "fig9", "P2", "P32", "sin(1)", "sqrt(-1)", "10**100000",
    "2^(2^(2^9))", "(" * 300, "exp(1000)", "--set", "--json", "--help", "--version", "--quiet", "-o", "-q",
    "--nonsense",    "None", "true", "[]", "module:function", "os:getcwd", "math:sin",
]  # fmt: skip


def _options() -> list[str]:
    """Return all options of the commands."""
    commands = [main.get_command(click.Context(main), name) for name in COMMANDS]
    return sorted(
        {
            opt
            for each in commands
            if each
            for given in each.params
            for opt in given.opts
            if opt[0] == "-"
        }
    )


def changed(rng: random.Random, words: list[str], options: list[str]) -> list[str]:
    """Return the words of a command line with one random change."""
    at = rng.randrange(len(words))
    match rng.randrange(8):
        case 0:
            return [*words[:at], *words[at + 1 :]]
        case 1:
            return [*words[:at], words[at], *words[at:]]
        case 2 | 3:
            return [*words[:at], rng.choice(WORDS), *words[at + 1 :]]
        case 4:
            return [*words[: at + 1], rng.choice(WORDS), *words[at + 1 :]]
        case 5:
            return [*words, rng.choice(options), *rng.choices(WORDS, k=rng.randrange(2))]
        case 6:
            return [*words, f"{rng.choice(options)}={rng.choice(WORDS)}"]
        case _:
            place, letter = rng.randrange(len(words[at]) + 1), rng.choice("0-=.,:;eπ\"'\\/ %_")
            return [
                *words[:at],
                words[at][:place] + letter + words[at][place + rng.randrange(2) :],
                *words[at + 1 :],
            ]


def command_lines(seed: int, count: int) -> list[list[str]]:
    """Return the words of `count` random command lines, each of which begins as a valid one and is changed."""
    rng, options, found = random.Random(seed), _options(), list[list[str]]()
    while len(found) < count:
        words = shlex.split(rng.choice(VALID))
        for _ in range(rng.choice((0, 1, 1, 1, 2, 2, 3))):
            words = changed(rng, words, options) if words else words
        if (words[:1] and words[0] in LEFT_OUT) or any(
            bad in word for word in words for bad in FORBIDDEN
        ):
            continue
        found.append(words)
    return found


def write_files(folder: Path) -> None:
    """Write the files that the valid command lines read into a folder."""
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
