"""Files of sweeps: what is written is read back to the last bit, also by other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_sweeps import made_up

from symosc import SweepError
from symosc.sweeps import output

xarray = pytest.importorskip("xarray")
SUFFIXES = (".nc", ".zarr", ".csv")


def example(seed: int) -> Any:
    """Return a result with every type of column, of numbers that are hard to print."""
    rng = np.random.default_rng(seed)

    def numbers(cells: dict[str, np.ndarray]) -> np.ndarray:
        values = rng.normal(size=len(cells["k"])) * 10.0 ** rng.integers(-300, 300, len(cells["k"]))
        return np.where(rng.random(len(values)) < 0.2, np.nan, values)

    return made_up(
        {"k": rng.uniform(1, 2, 4), "FN": [0.1, 1 / 3, 7]},
        word=lambda cells: rng.choice(["", "P32", "nan", "P3212"], len(cells["k"])),
        events=lambda cells: rng.integers(0, 2**40, len(cells["k"])),
        multiplicity=lambda cells: rng.integers(0, 100, len(cells["k"])).astype(np.int32),
        stuck=numbers,
        section=lambda cells: rng.normal(size=(len(cells["k"]), 3, 2)),
    )


@pytest.mark.quick(3)
@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("seed", range(2))
def test_what_is_written_is_read_back_to_the_last_bit(
    suffix: str, seed: int, tmp_path: Path
) -> None:
    dataset = example(seed)
    path = tmp_path / f"map{suffix}"
    output.write_output(dataset, path, tmp_path)
    assert output.plan_of(path) == dataset.attrs["plan"]
    columns = output.read_columns(path)
    cells = dataset.sizes["k"] * dataset.sizes["FN"]
    for name, values in dataset.items():
        assert columns[name].dtype == values.dtype, name
        assert (
            columns[name].tobytes() == values.values.reshape(cells, *values.shape[2:]).tobytes()
        ), name
    assert [path.name for path in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize(("suffix", "engine"), [(".nc", "h5netcdf"), (".zarr", "zarr")])
def test_xarray_reads_it_without_symosc(suffix: str, engine: str, tmp_path: Path) -> None:
    dataset = example(3)
    path = tmp_path / f"map{suffix}"
    output.write_output(dataset, path, tmp_path)
    with xarray.open_dataset(path, engine=engine) as result:
        assert {name: result.attrs[name] for name in dataset.attrs} == dataset.attrs
        assert result.FN.attrs == dataset.FN.attrs
        assert result.word.values.tolist() == dataset.word.values.tolist()
        np.testing.assert_array_equal(result.section.values, dataset.section.values)


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_no_flipped_bit_of_an_output_is_read(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"map{suffix}"
    dataset = made_up(
        {"k": [1, 2]}, word=lambda cells: np.array(["P32", ""]), x=lambda cells: cells["k"] / 3
    )
    output.write_output(dataset, path, tmp_path)
    for file in [path] if path.is_file() else filter(Path.is_file, path.rglob("*")):
        whole = file.read_bytes()
        for place in range(0, len(whole), 3):
            with file.open("r+b") as opened:
                opened.seek(place)
                opened.write(bytes([whole[place] ^ 1 << place % 8]))
            with pytest.raises(SweepError, match="is damaged"):
                output.read_columns(path)
        file.write_bytes(whole)
    assert output.read_columns(path)["x"].tolist() == [1 / 3, 2 / 3]


def test_only_an_output_is_replaced(tmp_path: Path) -> None:
    """Also if it came while the sweep ran.

    And nothing that somebody has put into a folder of ours is removed.
    """
    path = tmp_path / "map.zarr"
    (path / "thesis").mkdir(parents=True)
    (path / "thesis" / "chapter.tex").write_text("mine")
    with pytest.raises(SweepError, match="is not the output of a sweep"):
        output.write_output(example(5), path, tmp_path)
    (path / "thesis").rename(tmp_path / "thesis")
    path.rmdir()
    output.write_output(example(5), path, tmp_path)
    for put in (
        lambda: (path / "a").symlink_to(tmp_path / "thesis"),
        lambda: (path / "a").write_text("mine"),
    ):
        put()
        with pytest.raises(SweepError, match="is not the output of a sweep"):
            output.write_output(example(6), path, tmp_path)
        (path / "a").unlink()
