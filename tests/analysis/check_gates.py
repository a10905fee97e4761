#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares what montecarta makes of innovations behind a gate with NumPy and SciPy.

usage: check_gates.py MONTECARTA FOLDER RUNS

Draws innovations of two sensors in FOLDER: those of the lidar are 1.5 times as large as claimed and
passed a gate of 9, those of the gps passed none. Compares the NIS on the scale of (9.3), and the
verdicts by check_verdict.py. Ends with 1 if a number differs."""
import os
import subprocess
import sys

import h5py
import numpy as np
from scipy import stats

import check_verdict

LIMIT, SCANS = 9.0, 40
LIDAR_COVARIANCE = np.array([[0.04, 0.01], [0.01, 0.09]])


def run_of(rng, path):
    """Writes one run; returns the NIS {scan} of the lidar, NaN where the gate left it out."""
    L = np.linalg.cholesky(LIDAR_COVARIANCE)
    (xx, xy), (_, yy) = LIDAR_COVARIANCE
    squares = np.full(SCANS, np.nan)
    with open(path, "w") as file:
        print("time_s,sensor,x_m,y_m,cov_x_x,cov_x_y,cov_y_y", file=file)
        for scan in range(SCANS):
            e = np.sqrt(1.5) * (L @ rng.standard_normal(2))
            nis = e @ np.linalg.solve(LIDAR_COVARIANCE, e)
            if nis <= LIMIT:
                squares[scan] = nis
                print(f"{scan},lidar,{float(e[0])!r},{float(e[1])!r},{xx},{xy},{yy}",
                      file=file)
            e = rng.standard_normal(2)
            print(f"{scan},gps,{float(e[0])!r},{float(e[1])!r},1,0,1", file=file)
    return squares


def main(program, folder, runs):
    rng, squares = np.random.default_rng(1), []
    for run in range(int(runs)):
        squares.append(run_of(rng, os.path.join(folder, f"innovation_{run}.csv")))
    files = [os.path.join(folder, f"innovation_{run}.csv") for run in range(int(runs))]
    result, analyzed = os.path.join(folder, "gated.h5"), os.path.join(folder, "gated")
    for words in (["judge", *files, "--innovations", "--gate", f"lidar={LIMIT:g}", "-o", result,
                   "--force"], ["analyze", result, "--force", "--csv", analyzed]):
        subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    with h5py.File(result, "r") as file:
        label = next(name for name in file["cells"] if name.endswith("lidar"))
        found = file["cells"][label]["nis"][:]
    wanted = stats.chi2.ppf(stats.chi2.cdf(squares, 2) / stats.chi2.cdf(LIMIT, 2), 2)
    found = np.where(np.isnan(wanted), np.nan, found)
    if not np.allclose(found, wanted, rtol=1e-9, atol=0.0, equal_nan=True):
        print("the NIS on the scale of (9.3) differ")
        return 1
    return check_verdict.main(result, analyzed)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
