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

AXES = {"covariance": (4,), "truth": (2, 3), "nis": (2,), "nis_dof": (2,)}


def convert(paths):
    path, output = paths
    arrays = estimate_arrays.Arrays(path)
    for name in ("error", "mean", *AXES):
        if name not in arrays.variables and f"{name}s" in arrays.members:
            raise ConversionError(f"{path}: has {name}s (an array is called {name}): rename it")
    found = {name: arrays.get(name, axes) for name, axes in AXES.items()}
    kind, found[kind] = arrays.states()
    if "time" in arrays.variables:
        runs, scans = found[kind].shape[:2]
        own = [arrays.times(run, runs, scans) for run in range(runs)]
        is_common = np.size(arrays.variables["time"]) == scans
        found["time"] = np.array(own[0] if is_common else own, dtype=float)
    with h5py.File(output, "w") as file:
        for name, values in found.items():
            if values is not None:
                file[name] = np.asarray(values, dtype=float)
        names = arrays.name_texts()
        if names is not None:
            file.attrs["names"] = ",".join(names)


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("path", metavar="FILE")
    parser.add_argument("output", metavar="OUT.h5")
    given = parser.parse_args()
    conversion.run(convert, (given.path, given.output))
