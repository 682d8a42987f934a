"""Without optional packages all public names are there.

What needs one says so when it is called.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

#: What extras bring, as it is imported.
BROUGHT = "numba gmpy2 heyoka xarray pandas h5netcdf h5py zarr dask distributed flint pint pyarrow bokeh jax"
CODE = f"""
import sys
for name in {BROUGHT.split()!r}:
    sys.modules[name] = None
from symosc import *
import symosc
from symosc import plot
assert set(symosc.__all__) <= set(globals()), "a public name is not there"
for name in plot.__all__:
    getattr(plot, name)
print(simulate("fig5", t_end=7).word)
orbit = find_orbit(load_scene("fig9").parameters, "P32")
calls = [lambda: certify("fig5"), lambda: certify(orbit), lambda: sweep("fig9", {{"Omega": [4]}})]
for call in (*calls, lambda: simulate("fig5").to_pandas()):
    try:
        call()
    except MissingExtraError as error:
        print(str(error).rpartition("pip install ")[2])
"""


@pytest.mark.slow
def test_public_names_need_no_extra() -> None:
    run = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True)
    assert run.stderr == ""
    word, *needed = run.stdout.splitlines()
    assert word == "['P1', 'P2', 'P1', 'P3']"
    assert needed == [
        "'symosc[certify]'",
        "'symosc[certify]'",
        "'symosc[sweep]'",
        "'symosc[sweep]'",
    ]
