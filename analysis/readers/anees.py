# SPDX-License-Identifier: BSD-3-Clause
"""Prints the ANEES of every cell as `montecarta analyze` has it: python3 anees.py out.h5 [--xarray]

At scans, over complete runs (status 1). Mean and covariance are the Gaussian mixture's where the
file has them, else the spread of the particles (or the one Gaussian's own): rows `mixture`, or else
`spread`, of consistency.csv. (What is called `corrected` there allows for few particles, and is not
made here.)
Of imported estimates it is that of their stored errors, of any dimension, without a floor.
A singular covariance (a variance below 1e-10 of the floor's, or a pivot of the correlation matrix
below 1e-12) gets the floor diag(1e-4 m, 1e-4 m, 1e-5 rad)^2 added. What is not a number is left
out. Mean over the scans of a run, then over runs."""
import sys

import numpy as np

import montecarta

FLOOR = np.diag([1e-4, 1e-4, 1e-5]) ** 2  # [m, m, rad]^2


def quadratic_form(e, P, least_variance=1e-10 * np.diag(FLOOR)):
    """e' P^-1 e by Cholesky of the correlation matrix; NaN where P is singular."""
    variance = np.diagonal(P, axis1=-2, axis2=-1)
    regular = (variance > least_variance).all(-1) & np.isfinite(P).all((-2, -1))
    scale = np.sqrt(variance)
    L, y = np.zeros_like(P), np.zeros_like(e)
    for i in range(e.shape[-1]):
        for j in range(i):
            correlation = P[..., i, j] / (scale[..., i] * scale[..., j])
            rest = correlation - (L[..., i, :j] * L[..., j, :j]).sum(-1)
            L[..., i, j] = rest / L[..., j, j]
        pivot = 1.0 - (L[..., i, :i] ** 2).sum(-1)
        regular &= pivot > 1e-12
        L[..., i, i] = np.sqrt(pivot)
        rest = e[..., i] / scale[..., i] - (L[..., i, :i] * y[..., :i]).sum(-1)
        y[..., i] = rest / L[..., i, i]
    return np.where(regular, (y**2).sum(-1), np.nan)


def imported_nees(e, P):
    """Likewise, NaN where P is not symmetric or not positive definite."""
    deviation = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    allowed = 1e-6 * deviation[..., :, None] * deviation[..., None, :]
    symmetric = (abs(P - np.swapaxes(P, -1, -2)) <= allowed).all((-2, -1))
    return np.where(symmetric, quadratic_form(e, P, 0.0), np.nan)


def anees(cell, truth, scan_row):
    which = "_mixture" if "pose_mean_mixture" in cell else ""
    complete = np.flatnonzero(np.asarray(cell["status"]) == 1)
    if "error" in cell:
        with np.errstate(all="ignore"):
            nees = imported_nees(np.asarray(cell["error"])[complete],
                                 np.asarray(cell["error_covariance"])[complete])
            return np.nanmean(np.nanmean(nees, axis=1))

    def at_scans(dataset):
        return np.asarray(dataset)[complete][:, np.asarray(scan_row)]

    e = at_scans(truth) - at_scans(cell["pose_mean" + which])
    e[..., 2] -= 2 * np.pi * np.round(e[..., 2] / (2 * np.pi))
    P = at_scans(cell["pose_covariance" + which])
    with np.errstate(all="ignore"):
        nees = quadratic_form(e, P)
        nees = np.where(np.isnan(nees), quadratic_form(e, P + FLOOR), nees)
    return np.nanmean(np.nanmean(nees, axis=1))


if __name__ == "__main__":
    results, arrays = montecarta.open(sys.argv[1]), montecarta.arrays(sys.argv[1])
    for label in results.labels:
        cell = results[label] if sys.argv[2:] == ["--xarray"] else arrays["cells"][label]
        truth = None
        if "error" not in cell:
            truth = cell["truth"] if "truth" in cell else arrays["truth"]["pose"]
        print(label, repr(float(anees(cell, truth, arrays["scan_row"]))))
