# SPDX-License-Identifier: BSD-3-Clause
"""Prints the ANEES of every cell as `montecarta analyze` has it: python3 anees.py out.h5 [--xarray]

At scans, over complete runs (status 1). Mean and covariance are the Gaussian mixture's where the
file has them, else the spread of the particles (or the one Gaussian's own): rows `mixture`, or else
`spread`, of consistency.csv. (What is called `corrected` there allows for few particles, and is not
made here.)
Of imported estimates it is that of their stored errors, of any dimension. A singular covariance is
judged in its range (STATISTICS 2); what is unusable is left out. Mean over the scans of a run, then
over runs."""
import sys

import numpy as np
from scipy.stats import chi2

import montecarta

LEAST_VARIANCE = np.array([1e-9, 1e-9, 1e-10]) ** 2  # [m, m, rad]^2
LARGEST = 1e60  # a larger NEES counts as this one


def quadratic_form(e, P, least_variance):
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
    return np.where(regular, np.minimum((y**2).sum(-1), LARGEST), np.nan)


def nees_in_range(e, P, least_variance):
    """Of one sample with a singular P, on the scale of all components; NaN if it is unusable."""
    d, variance = len(e), np.diag(P)
    if not (np.isfinite(e).all() and np.isfinite(P).all()) or (variance < -least_variance).any():
        return np.nan
    is_open = variance > least_variance
    most = np.outer(least_variance, np.maximum(variance, least_variance))
    lower = np.tril(P, -1) + np.tril(P, -1).T
    if (lower**2 > most)[~is_open].any():
        return np.nan
    if not is_open.any():
        return np.nan
    scale = 1 / np.sqrt(variance[is_open])
    eigenvalues, vectors = np.linalg.eigh(P[np.ix_(is_open, is_open)] * np.outer(scale, scale))
    along = vectors.T @ (scale * e[is_open])
    if (eigenvalues < -1e-9).any():
        return np.nan
    inside = eigenvalues > 1e-12
    is_outside = (along[~inside] ** 2).sum() > 10.0**2
    value = LARGEST if is_outside else (along[inside] ** 2 / eigenvalues[inside]).sum()
    tail = chi2.sf(value, inside.sum())
    if tail > 1e-6:
        return chi2.isf(tail, d)
    return min(value * chi2.isf(1e-6, d) / chi2.isf(1e-6, inside.sum()), LARGEST)


def nees_of(e, P, least_variance):
    """{...} of errors {..., d} with covariances {..., d, d}."""
    with np.errstate(all="ignore"):
        nees = quadratic_form(e, P, least_variance)
    for sample in zip(*np.nonzero(np.isnan(nees))):
        nees[sample] = nees_in_range(e[sample], P[sample], least_variance)
    return nees


def imported_nees(e, P):
    """Likewise; a covariance that is not symmetric is unusable as well."""
    deviation = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    allowed = 1e-6 * deviation[..., :, None] * deviation[..., None, :]
    symmetric = (abs(P - np.swapaxes(P, -1, -2)) <= allowed).all((-2, -1))
    return np.where(symmetric, nees_of(e, P, np.zeros(e.shape[-1])), np.nan)


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
    return np.nanmean(np.nanmean(nees_of(e, P, LEAST_VARIANCE), axis=1))


if __name__ == "__main__":
    results, arrays = montecarta.open(sys.argv[1]), montecarta.arrays(sys.argv[1])
    if "sums" in arrays:
        sys.exit(f"{sys.argv[1]}: has sums instead of runs: use montecarta analyze")
    for label in results.labels:
        cell = results[label] if sys.argv[2:] == ["--xarray"] else arrays["cells"][label]
        truth = None
        if "error" not in cell:
            truth = cell["truth"] if "truth" in cell else arrays["truth"]["pose"]
        print(label, repr(float(anees(cell, truth, arrays["scan_row"]))))
