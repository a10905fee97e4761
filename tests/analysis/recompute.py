#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Recomputes from a result file, by other people's software and formulas, what montecarta says of it.

usage: recompute.py OUT.h5 ANALYZE_CSV COMPARE_CSV BOUNDS.csv BASELINE

ANALYZE_CSV and COMPARE_CSV are what `montecarta analyze --csv` and `montecarta compare --csv` wrote,
BOUNDS.csv has columns runs, dimension, level, lower, upper. Prints every number that differs by more
than 1e-12 of itself and ends with 1 where there is one. The formulas are written out here from
- SciPy (scipy.stats.chi2, binomtest, wilcoxon),
- FilterPy's filterpy.stats.NESS: x' inv(P) x,
- navlie's GaussianResult (nees = e' solve(P, e), ees = e' e) and MonteCarloResult (average_nees,
  total_rmse = sqrt(average_ees), nees_lower_bound, nees_upper_bound),
- Holm (1979), Scand. J. Statist. 6, section 3."""
import csv
import sys

import h5py
import numpy as np
from scipy import stats

TOLERANCE = 1e-12
checked, wrong = 0, 0


def check(what, ours, theirs):
    global checked, wrong
    ours, theirs = np.atleast_1d(np.asarray(ours, float)), np.atleast_1d(np.asarray(theirs, float))
    same = np.abs(ours - theirs) <= TOLERANCE * np.abs(theirs)
    same |= np.isnan(ours) & np.isnan(theirs)
    checked += same.size
    wrong += np.count_nonzero(~same)
    for i in np.flatnonzero(~same)[:5]:
        print(f"{what}[{i}]: montecarta {ours[i]!r}, recomputed {theirs[i]!r}")


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def column(rows, name):
    return np.array([float(row[name]) for row in rows])


def ness_by_filterpy(errors, covariances):
    return np.array([np.dot(x.T, np.linalg.inv(p)).dot(x) for x, p in zip(errors, covariances)])


def nees_by_navlie(errors, covariances):
    return np.array([(e @ np.linalg.solve(P, e)) for e, P in zip(errors, covariances)])


class Cell:
    """Complete runs of one cell at its scans: errors {run, scan, 3} and covariances, leading ones."""

    def __init__(self, file, label):
        cell, rows = file["cells"][label], file["scan_row"][:]
        self.label, self.status = label, cell["status"][:]
        self.runs = np.flatnonzero(self.status == 1)
        self.particles = cell.attrs["particles"]
        self.moments = "mixture" if "pose_mean_mixture" in cell else "spread"
        suffix = "_mixture" if self.moments == "mixture" else ""
        error = file["truth/pose"][:] - cell["pose_mean" + suffix][:]
        error[..., 2] = np.arctan2(np.sin(error[..., 2]), np.cos(error[..., 2]))
        self.errors = error[self.runs][:, rows]
        self.covariances = cell["pose_covariance" + suffix][:][self.runs][:, rows]
        self.cpu = file["timing"][label]["cpu_seconds"][:][self.runs]

    def nees(self, part, by):
        return np.array([by(e[:, part], P[:, part, part]) for e, P in zip(self.errors, self.covariances)])

    def is_recomputed(self, metric):
        """Not the NEES of few particles, which montecarta corrects by a table good to 1e-4."""
        return metric != "nees_distance" or self.moments == "mixture" or self.particles == 0

    def scores(self):
        """{metric: value of each complete run}."""
        ees = self.errors**2
        nees = self.nees(slice(0, 3), nees_by_navlie).mean(axis=1)
        return {
            "position_rmse": np.sqrt(ees[..., :2].sum(-1).mean(axis=1)),
            "heading_rmse": np.sqrt(ees[..., 2].mean(axis=1)),
            "nees_distance": np.abs(np.log2(nees / 3)),
            "cpu_seconds": self.cpu,
        }


def check_bounds(path):
    for row in rows_of(path):
        runs, dof = int(row["runs"]), int(row["dimension"])
        tail = (1 - float(row["level"])) / 2
        name = f"bounds of {runs} x {dof} at {row['level']}"
        check(name, float(row["lower"]), stats.chi2.ppf(tail, runs * dof) / runs)
        check(name, float(row["upper"]), stats.chi2.isf(tail, runs * dof) / runs)


def check_cell(cell, folder):
    series = rows_of(f"{folder}/series_{cell.label}.csv")
    n = len(cell.runs)
    for block, part in (("pose", slice(0, 3)), ("position", slice(0, 2)), ("heading", slice(2, 3))):
        name, dof = f"{block}_{cell.moments}", part.stop - part.start
        for by in (ness_by_filterpy, nees_by_navlie):
            average = cell.nees(part, by).mean(axis=0)
            check(f"{cell.label} anees_{name} {by.__name__}", column(series, "anees_" + name), average)
        check(f"{cell.label} lower_{name}", column(series, "lower_" + name), stats.chi2.ppf(0.025, n * dof) / n)
        check(f"{cell.label} upper_{name}", column(series, "upper_" + name), stats.chi2.isf(0.025, n * dof) / n)
    ees = cell.errors**2
    check(f"{cell.label} rmse", column(series, "position_rmse [m]"), np.sqrt(ees[..., :2].sum(-1).mean(axis=0)))
    check(f"{cell.label} rmse", column(series, "heading_rmse [rad]"), np.sqrt(ees[..., 2].mean(axis=0)))
    numbers = {row["cell"]: row for row in rows_of(f"{folder}/cells.csv")}[cell.label]
    for name, unit in (("position_rmse", "m"), ("heading_rmse", "rad")):
        values = cell.scores()[name]
        check(f"{cell.label} {name}", float(numbers[f"{name}_mean [{unit}]"]), values.mean())
        check(f"{cell.label} {name}", float(numbers[f"{name}_sd [{unit}]"]), values.std(ddof=1))


def holm(p):
    order = np.argsort(p, kind="stable")
    steps = np.array(p)[order] * np.arange(len(p), 0, -1)
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum(1, np.maximum.accumulate(steps))
    return adjusted


def wins(cell, other, metric):
    """(differences of common complete runs, won, lost); a failed run is lost to a complete one."""
    mine, its = cell.scores()[metric], other.scores()[metric]
    both = np.intersect1d(cell.runs, other.runs)
    difference = mine[np.searchsorted(cell.runs, both)] - its[np.searchsorted(other.runs, both)]
    won = np.count_nonzero(difference < 0) + np.count_nonzero((cell.status == 1) & (other.status == 2))
    lost = np.count_nonzero(difference > 0) + np.count_nonzero((cell.status == 2) & (other.status == 1))
    return difference, won, lost


def recomputed(cells, metric, *labels):
    return all(cells[label].is_recomputed(metric) for label in labels)


def sign_p(won, lost):
    return stats.binomtest(int(won), int(won + lost), 0.5).pvalue if won + lost else 1.0


def check_comparison(cells, folder, baseline):
    rows = rows_of(f"{folder}/comparison.csv")
    p_values = []
    known = [row for row in rows if recomputed(cells, row["metric"], row["cell"], baseline)]
    for row in known:
        name = f"{row['cell']} against {baseline} by {row['metric']}"
        difference, won, lost = wins(cells[row["cell"]], cells[baseline], row["metric"])
        moved = difference[difference != 0]
        ties = len(np.unique(np.abs(moved))) < len(moved) or len(moved) < len(difference)
        exact = len(moved) <= 50 and not ties
        rank = stats.wilcoxon(difference, method="exact" if exact else "approx").pvalue if len(moved) else 1.0
        check(name + ": difference", float(row["difference"]), difference.mean())
        check(name + ": won, lost", [float(row["won"]), float(row["lost"])], [won, lost])
        check(name + ": sign test", float(row["p_sign"]), sign_p(won, lost))
        check(name + ": signed-rank test", float(row["p_rank"]), rank)
        p_values += [sign_p(won, lost), rank]
    if len(known) < len(rows):
        print(f"{len(rows) - len(known)} rows and Holm's correction not recomputed: NEES of few particles")
    else:
        ours = np.ravel([[float(row["p_sign_holm"]), float(row["p_rank_holm"])] for row in rows])
        check("Holm", ours, holm(p_values))
    for row in rows_of(f"{folder}/wins.csv"):
        if not recomputed(cells, row["metric"], row["cell"], row["beaten"]):
            continue
        _, won, lost = wins(cells[row["cell"]], cells[row["beaten"]], row["metric"])
        check(f"wins by {row['metric']}", [float(row["won"]), float(row["p_sign"])], [won, sign_p(won, lost)])


def main(result, analyzed, compared, bounds, baseline):
    with h5py.File(result, "r") as file:
        cells = {label: Cell(file, label) for label in file["cells"]}
    check_bounds(bounds)
    for cell in cells.values():
        check_cell(cell, analyzed)
    check_comparison(cells, compared, baseline)
    print(f"{checked} numbers compared, {wrong} differ by more than {TOLERANCE}")
    return 1 if wrong or not checked else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
