#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the arrays in a .npz file or a MATLAB file of any version to an HDF5 file that
`montecarta judge` reads. judge calls this script itself if it is given such a file.

    python3 arrays.py study.npz arrays.h5

The arrays are those of experiments/JUDGING_ESTIMATES.md: `error`, or `mean` and `truth`, with
`covariance`, and optionally `time`, `nis`, `nis_dof` and `names`.
"""
import sys

import conversion
import estimate_arrays
from conversion import ConversionError, np

try:
    import h5py
except ImportError:
    sys.exit("arrays.py: h5py is missing in this Python (it writes the file that judge reads): "
             "install python3-h5py, on Debian with 'apt-get install python3-h5py'; or convert by "
             "estimates.py, which needs NumPy alone")

AXES = {"error": (3,), "mean": (3,), "covariance": (4,), "truth": (2, 3), "nis": (2,),
        "nis_dof": (2,)}


def names_in(given):
    """The names of columns in an array of texts, with commas."""
    return ",".join(str(np.ravel(name)[0] if np.size(name) else "") for name in np.ravel(given))


def convert(paths):
    path, output = paths
    arrays = estimate_arrays.Arrays(path)
    for name in AXES:
        if name not in arrays.variables and f"{name}s" in arrays.variables:
            raise ConversionError(f"{path}: has {name}s (an array is called {name}): rename it")
    found = {name: arrays.get(name, axes) for name, axes in AXES.items()}
    states = found["error"] if found["mean"] is None else found["mean"]
    if states is None:
        there = ", ".join(sorted(name for name in arrays.variables if not name.startswith("__")))
        raise ConversionError(f"{path}: no 'error', and no 'mean' (arrays are error, or mean and "
                              f"truth, with covariance; the file has {there[:200] or 'none'}): "
                              "save them under these names")
    if "time" in arrays.variables:
        runs, scans = states.shape[:2]
        own = [arrays.times(run, runs, scans) for run in range(runs)]
        is_common = np.size(arrays.variables["time"]) == scans
        found["time"] = np.array(own[0] if is_common else own, dtype=float)
    with h5py.File(output, "w") as file:
        for name, values in found.items():
            if values is not None:
                file[name] = np.asarray(values, dtype=float)
        if "names" in arrays.variables:
            file.attrs["names"] = names_in(arrays.variables["names"])


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("path", metavar="FILE")
    parser.add_argument("output", metavar="OUT.h5")
    given = parser.parse_args()
    conversion.run(convert, (given.path, given.output))
