"""Exported source: complete, minimal, right in every language that can be run here.

And what is refused.
"""

from __future__ import annotations

import ctypes
import random
import re
import shutil
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpmath import mp

from symosc import Parameters, load_scene
from symosc.base.errors import OutputError, ParameterError
from symosc.mappings import equations
from symosc.model import by_name
from symosc.symbolic.export import LANGUAGES, SETUP, export, write_export
from symosc.words import WordError, read_word

#: Every map, in order of time P2, P1, P3, P2, P8, P6, P4, P5, P6, P7.
ALL = "P7654682312"
COMPILER = ["cc", "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-fPIC", "-shared"]
Evaluate = Callable[[list[float], Parameters], tuple[Any, Any]]
REGIMES = {
    "underdamped": load_scene("fig9").parameters,
    "far too weak a spring": load_scene("fig9").parameters.replace(k="0.01", c="0.001"),
    "critical": load_scene("fig9").parameters.replace(k=10, c=2),
    "near critical": load_scene("fig9").parameters.replace(k=10, c="1.9999999999"),
    "overdamped": load_scene("fig9").parameters.replace(k=3, c=20),
    "undamped": load_scene("fig9").parameters.replace(c=0),
    "resonance": load_scene("fig9").parameters.replace(c=0, k="1.6"),
    "near resonance": load_scene("fig9").parameters.replace(c=0, k="1.60000001"),
    "no spring": load_scene("fig9").parameters.replace(k=0),
    "free": load_scene("fig9").parameters.replace(k=0, c=0),
}


def points(rng: random.Random, word: str, p: Parameters) -> list[float]:
    """Return random switching points with durations from 1e-3 to 3."""
    z = [rng.uniform(-5, 5), rng.uniform(0, 6)]
    theta = 0.0
    theta = z[1]
    for _ in read_word(word, closed=False).labels:
        theta += float(p.Omega) * 10 ** rng.uniform(-3, 0.5)
        z += [rng.uniform(-5, 5), theta]
    return z


def truth(word: str, z: list[float], p: Parameters) -> tuple[np.ndarray, np.ndarray]:
    """Return residual and Jacobian of the library with 40 digits, rounded."""
    read = read_word(word, closed=False)
    f = []
    J = []
    with mp.workdps(40):
        exact = [mp.mpf(value) for value in z]
        for n, (label, exit) in enumerate(zip(read.labels, read.exits(), strict=True)):
            start = exact[2 * n : 2 * n + 2]
            end = exact[2 * n + 2 : 2 * n + 4]
            exit = exit or ("below" if label in ("P1", "P4") else None)
            f += equations.residual(p, label, start, end, exit)
            J.append(equations.jacobian(p, label, start, end, exit))
    return np.array(f, dtype=float), np.array(J, dtype=float)


def check(evaluate: Evaluate, word: str, p: Parameters, count: int = 10, seed: str = "") -> None:
    rng = random.Random(f"{word} {seed}")
    for _ in range(count):
        z = points(rng, word, p)
        f, J = evaluate(z, p)
        exact_f, exact_J = truth(word, z, p)
        np.testing.assert_allclose(
            np.array(f), exact_f, rtol=0, atol=1e-11 * (1 + np.abs(exact_f).max())
        )
        np.testing.assert_allclose(
            np.array(J), exact_J, rtol=0, atol=1e-11 * (1 + np.abs(exact_J).max())
        )


def load(text: str) -> types.ModuleType:
    """Return exported Python source as a module."""
    module = types.ModuleType("exported")
    exec(text, module.__dict__)
    return module


def python(word: str, language: str = "python") -> Evaluate:
    module = load(export(word, language, "made")["made.py"])

    def evaluate(z: list[float], p: Parameters) -> tuple[Any, Any]:
        K = module.constants(**by_name(p, float))
        if language == "python":
            return module.residual(z, K), module.jacobian(z, K)
        columns = [np.array([value, value]) for value in z]
        blocks = module.jacobian(columns, K)
        J = [[[np.broadcast_to(entry, 2)[1] for entry in row] for row in block] for block in blocks]
        return [entry[0] for entry in module.residual(columns, K)], J

    return evaluate


def compiled(folder: Path, word: str) -> Evaluate:
    source = next(path for path in write_export(folder, word, "c", "made") if path.suffix == ".c")
    library = source.with_suffix(".so")
    subprocess.run(
        [*COMPILER, str(source), "-o", str(library), "-lm"],
        check=True,
        capture_output=True,
        text=True,
    )
    made = ctypes.CDLL(str(library))
    n = len(read_word(word, closed=False).labels)

    def evaluate(z: list[float], p: Parameters) -> tuple[Any, Any]:
        points_ = (ctypes.c_double * len(z))(*z)
        f = (ctypes.c_double * (2 * n))()
        J = (ctypes.c_double * (8 * n))()
        K = ctypes.create_string_buffer(400)
        made.made_setup(K, *map(ctypes.c_double, by_name(p, float).values()))
        made.made_residual(points_, K, f)
        made.made_jacobian(points_, K, J)
        return list(f), np.array(J).reshape(n, 2, 4)

    return evaluate


@pytest.mark.slow
def test_c_agrees_with_mpmath_in_every_regime(tmp_path: Path) -> None:
    evaluate = compiled(tmp_path, ALL)
    for name, p in REGIMES.items():
        check(evaluate, ALL, p, seed=name)


@pytest.mark.slow
@pytest.mark.parametrize("language", ["python", "numpy"])
def test_python_agrees_with_mpmath_in_every_regime(language: str) -> None:
    evaluate = python(ALL, language)
    for name, p in REGIMES.items():
        check(evaluate, ALL, p, 4, name)


def test_python_agrees_with_mpmath_near_critical_damping() -> None:
    check(python("P4645"), "P4645", REGIMES["near critical"], 4)


def test_exported_source_runs_without_symosc(tmp_path: Path) -> None:
    settings = by_name(load_scene("fig9").parameters, float)
    write_export(tmp_path, "P32", "python")
    program = (
        "import sys; sys.modules['symosc'] = sys.modules['numpy'] = None; import p32; "
        f"K = p32.constants(**{settings}); "
        "z = [4.154920661325319, 0.7266815916972818, -4.224944664197688, 3.96948575613584, "
        "4.154920661325319, 7.009866898876868]; print(max(map(abs, p32.residual(z, K))))"
    )
    run = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert float(run.stdout) < 1e-13


@pytest.mark.slow
def test_numpy_takes_numbers_and_arrays_that_broadcast() -> None:
    rng = np.random.default_rng(5)
    for word in ("P1", "P4", "P2", "P32", "P4645", ALL):
        n = len(read_word(word, closed=False).labels)
        module, scalar = (
            load(export(word, language, "made")["made.py"]) for language in ("numpy", "python")
        )
        p = REGIMES["near critical"]
        K, scalar_K = (source.constants(**by_name(p, float)) for source in (module, scalar))
        for shape in ((), (1,), (0,), (3, 2)):
            # Positions are arrays, most phases numbers: what a map does not depend on must not
            # change a shape.
            theta = np.cumsum(rng.uniform(0.01, 3, n + 1))
            z = [part for at in theta for part in (rng.uniform(-5, 5, shape), at)]
            z[-1] = z[-1] + rng.uniform(0, 1, shape[1:])
            f = module.residual(z, K)
            J = np.array(module.jacobian(z, K))
            assert f.shape == (2 * n, *shape)
            assert J.shape == (n, 2, 4, *shape)
            for place in np.ndindex(shape):
                point = [float(np.broadcast_to(part, shape)[place]) for part in z]
                expected = (
                    np.array(scalar.residual(point, scalar_K)),
                    np.array(scalar.jacobian(point, scalar_K)),
                )
                np.testing.assert_allclose(f[:, *place], expected[0], rtol=1e-11, atol=1e-11)
                np.testing.assert_allclose(J[..., *place], expected[1], rtol=1e-11, atol=1e-11)
        for name, function in vars(module).items():
            if name.startswith("P") and not name.endswith("_jacobian"):
                f1, f2 = function(rng.uniform(-1, 1, (2, 1)), 0.1, 0.5, 1.2, K)
                assert f1.shape == f2.shape == (2, 1)


def test_errors(tmp_path: Path) -> None:
    with pytest.raises(ParameterError, match="one of python, numpy, c"):
        export("P32", "fortran")
    with pytest.raises(ParameterError, match="a letter first"):
        export("P32", "c", name="3 d")
    with pytest.raises(WordError, match="P5 cannot follow P2"):
        export("P52")
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError):
        write_export(tmp_path / "file" / "folder", "P32")
    with pytest.raises(WordError, match="P3 cannot follow P3"):
        export("P33")
    for name in ("", "3d", "a b", "a-b", "ä", "１", 5, "a\n", "../a"):
        with pytest.raises(ParameterError, match="name = "):
            export("P32", name=name)  # type: ignore[arg-type]
    with pytest.raises(OutputError):
        write_export(tmp_path / ("n" * 300), "P32")
    for folder in (None, "", 5):
        with pytest.raises(ParameterError, match="path = "):
            write_export(folder, "P32")  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_a_name_that_the_program_would_lack_is_an_error(
    language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if a module of kernels had renamed a threshold, or gained a constant of a motion."""
    with monkeypatch.context() as changed:
        changed.setattr("symosc.symbolic.export.SETTINGS", ("EPS",))
        with pytest.raises(ValueError, match=r"would not define .*SERIES_BELOW"):
            export("P32", language)
    setup = "\n".join(line for line in SETUP.splitlines() if not line.startswith("rate = "))
    monkeypatch.setattr("symosc.symbolic.export.SETUP", setup)
    with pytest.raises(ValueError, match=r"would not define K\.rate,"):
        export("P32", language)


def test_a_file_with_another_content_stays(tmp_path: Path) -> None:
    (path,) = write_export(tmp_path, "P32", "python")
    text = path.read_text()
    write_export(tmp_path, "P32", "python")  # the same once more
    with pytest.raises(OutputError, match=r"p32\.py: already exists with different content"):
        write_export(tmp_path, "P32", language="numpy")
    assert path.read_text() == text
    path.write_bytes(b"\xff mine")
    with pytest.raises(OutputError, match="different content"):
        write_export(tmp_path, "P32")
    write_export(tmp_path, "P32", "numpy", force=True)
    assert "import numpy" in path.read_text()
    (tmp_path / "p32.c").write_text("mine")
    with pytest.raises(OutputError, match=r"p32\.c"):
        write_export(tmp_path, "P32", "c")
    assert not (tmp_path / "p32.h").exists()


def printed(text: str) -> np.ndarray:
    return np.array(
        [float(number) for number in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]?\d+)?", text)]
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("language", ["c", "python", "numpy"])
def test_the_caller_of_a_source_runs(language: str, tmp_path: Path) -> None:
    """Each file can be tried as its comment says; the numbers are the library's."""
    files = write_export(tmp_path, "P3121", language, "made")
    command = [sys.executable, "made.py"]
    if language == "c":
        if shutil.which("cc") is None:
            pytest.skip("no C compiler here")
        (advice,) = re.findall(r"Try it: (cc .*) && ./a.out", files[0].read_text())
        subprocess.run(advice.split(), cwd=tmp_path, check=True)
        command = ["./a.out"]
    text = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    z = [value for n in range(5) for value in (round(0.5 - 0.3 * n, 1), round(0.4 + 0.7 * n, 1))]
    f, J = truth("P3121", z, load_scene("fig9").parameters)
    expected = np.concatenate([f, J.ravel()])
    numbers = printed(re.sub(r"\[\d+\]", "", text))
    digits = 1e-12
    if language == "numpy":  # two columns, printed with eight digits
        numbers = numbers.reshape(-1, 2)[:, 0]
        digits = 1e-6
    np.testing.assert_allclose(numbers, expected, rtol=digits, atol=digits)
