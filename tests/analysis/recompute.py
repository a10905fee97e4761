#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Recomputes from a result file, by other people's software and formulas, what montecarta says.

usage: recompute.py OUT.h5 ANALYZE_CSV COMPARE_CSV BOUNDS.csv BASELINE

ANALYZE_CSV and COMPARE_CSV are what `montecarta analyze --csv` and `montecarta compare --csv`
wrote, BOUNDS.csv has columns runs, dimension, level, lower, upper. Prints every number that differs
by more than 1e-12 of itself and ends with 1 where there is one. The formulas are written out here
from
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


def check(what, ours, theirs, tolerance=TOLERANCE):
    global checked, wrong
    ours, theirs = np.atleast_1d(np.asarray(ours, float)), np.atleast_1d(np.asarray(theirs, float))
    same = np.abs(ours - theirs) <= tolerance * np.abs(theirs)
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
    return np.einsum("...i,...ij,...j", errors, np.linalg.inv(covariances), errors)


def nees_by_navlie(errors, covariances):
    return np.einsum("...i,...i", errors, np.linalg.solve(covariances, errors[..., None])[..., 0])


def effective_draws(particles, ess):
    """(draws that the mean is worth, draws that the covariance is worth), STATISTICS 4."""
    e = np.clip(ess, 1, particles)
    cubes = np.minimum(particles / e**3, e**-1.5)
    with np.errstate(divide="ignore", invalid="ignore"):
        freedom = (1 - 1 / e) ** 2 / (1 / e - 2 * cubes + 1 / e**2)
    return e, np.where((e <= 1) | (e >= particles), e, np.minimum(freedom + 1, particles))


class Corrected:
    """The NEES by the spread on the chi-square's scale: montecarta has it in a table, linear
    between steps of 1 / freedom and eighths of an octave, which this builds once more and compares
    with the formula itself."""

    def __init__(self, dof):
        self.dof = dof
        last = np.log2(stats.chi2.isf(1e-6, dof))
        self.octaves = last - np.arange(int((last + 16) * 8), -1, -1) / 8
        c, freedom = 2**self.octaves, 1 / (0.5 * np.arange(1, 129) / 128)
        above, below = stats.chi2.sf(c, dof), stats.chi2.cdf(c, dof)
        f = np.where(above < 0.5, stats.f.isf(above, dof, freedom[:, None]),
                     stats.f.ppf(below, dof, freedom[:, None]))
        self.log_ratios = np.vstack([np.zeros_like(c), np.log2(dof * f / c)])
        for draws in (dof + 2.1, 10.0, 60.0):
            f = stats.f.isf(np.array([0.9, 0.5, 0.1, 1e-3]), dof, draws - dof)
            nees = f * dof * (draws + 1) / (draws - dof)
            table = self(nees, np.full(4, draws), np.full(4, draws))
            check(f"table for {dof} of {draws}", table,
                  stats.chi2.isf([0.9, 0.5, 0.1, 1e-3], dof), 1e-3)

    def __call__(self, nees, of_mean, of_variance):
        """NaN where there are too few draws."""
        result = np.full(nees.shape, np.nan)
        for at in np.argwhere((of_mean > self.dof + 2) & np.isfinite(nees)):
            at = tuple(at)
            freedom = of_variance[at] - self.dof
            f = nees[at] * (of_mean[at] - 1) / (of_mean[at] + 1) * freedom / (of_variance[at] - 1)
            place = min(1 / (freedom * 0.5), 1) * 128
            row = min(int(place), 127)
            lower, upper = self.log_ratios[row : row + 2]
            ratios = lower + (place - row) * (upper - lower)
            octaves, log_f = self.octaves + ratios, np.log2(f)
            if log_f <= octaves[0]:
                result[at] = f / 2 ** ratios[0]
            elif log_f >= octaves[-1]:
                result[at] = f / 2 ** ratios[-1]
            else:
                result[at] = 2 ** np.interp(log_f, octaves, self.octaves)
        return result


class Cell:
    """Complete runs of one cell at its scans, by every definition of the moments."""

    def __init__(self, file, label):
        cell, rows = file["cells"][label], file["scan_row"][:]
        self.label, self.status = label, cell["status"][:]
        self.runs = np.flatnonzero(self.status == 1)
        self.particles = int(cell.attrs["particles"])
        at_scans = lambda column: column[:][self.runs][:, rows]
        truth = at_scans(file["truth/pose"])
        self.of_moments = {}  # {name: (errors {run, scan, 3}, covariances {run, scan, 3, 3})}
        for name, suffix in (("corrected", ""), ("mixture", "_mixture"), ("spread", "")):
            if f"pose_mean{suffix}" not in cell or (name == "corrected" and self.particles == 0):
                continue
            errors = truth - at_scans(cell["pose_mean" + suffix])
            errors[..., 2] = np.arctan2(np.sin(errors[..., 2]), np.cos(errors[..., 2]))
            self.of_moments[name] = errors, at_scans(cell["pose_covariance" + suffix])
        self.moments = list(self.of_moments)  # the first one leads
        self.estimate = "mixture" if "mixture" in self.moments else "spread"
        self.errors = self.of_moments[self.estimate][0]
        if "corrected" in self.moments:
            self.tables = {d: Corrected(d) for d in (1, 2, 3)}
            self.draws = effective_draws(self.particles, cell["ess"][:][self.runs])
        self.joint = self.make_joint(file, cell)
        self.cpu = file["timing"][label]["cpu_seconds"][:][self.runs]
        self.scores = self.make_scores()

    def make_joint(self, file, cell):
        """(joint NEES, components) {run, joint} of the landmarks in the map; None if not stored."""
        if "joint_mean" not in cell:
            return None
        mean, covariance = cell["joint_mean"][:][self.runs], cell["joint_covariance"][:][self.runs]
        pose = file["truth/pose"][:][self.runs][:, file["scan_row"][:][file["joint_scan"][:]]]
        world = file["scenario/landmarks"][:].ravel()
        world = np.broadcast_to(world, pose.shape[:2] + world.shape)
        errors = mean - np.concatenate([pose, world], axis=-1)
        errors[..., 2] = np.arctan2(np.sin(errors[..., 2]), np.cos(errors[..., 2]))
        nees, components = np.empty(mean.shape[:2]), np.empty(mean.shape[:2])
        for at in np.ndindex(nees.shape):
            seen = ~np.isnan(mean[at])
            error = errors[at][seen]
            nees[at] = error @ np.linalg.solve(covariance[at][np.ix_(seen, seen)], error)
            components[at] = seen.sum()
        return nees, components

    def nees(self, part, moments, by):
        errors, covariances = self.of_moments[moments]
        values = by(errors[..., part], covariances[..., part, part])
        if moments != "corrected":
            return values
        values = self.tables[part.stop - part.start](values, *self.draws)
        if "mixture" not in self.moments:
            return values
        drawn = (covariances != self.of_moments["mixture"][1]).any(axis=(-2, -1))
        return np.where(drawn, values, self.nees(part, "mixture", by))

    def log_score(self):
        errors, covariances = self.of_moments[self.estimate]
        densities = [[stats.multivariate_normal.logpdf(e, cov=P) for e, P in zip(*run)]
                     for run in zip(errors, covariances)]
        return -np.mean(densities, axis=1)

    def make_scores(self):
        """{metric: value of each complete run}."""
        ees = self.errors**2
        nees = np.nanmean(self.nees(slice(0, 3), self.moments[0], nees_by_navlie), axis=1)
        return {
            "position_rmse": np.sqrt(ees[..., :2].sum(-1).mean(axis=1)),
            "heading_rmse": np.sqrt(ees[..., 2].mean(axis=1)),
            "nees": nees,
            "log_score": self.log_score(),
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
    for block, part in (("pose", slice(0, 3)), ("position", slice(0, 2)), ("heading", slice(2, 3))):
        dof = part.stop - part.start
        for moments in cell.moments:
            name = f"{block}_{moments}"
            for by in (ness_by_filterpy, nees_by_navlie):
                values = cell.nees(part, moments, by)
                n = np.count_nonzero(np.isfinite(values), axis=0)  # the others have too few draws
                average = np.where(n > 0, np.nansum(values, axis=0) / np.maximum(n, 1), np.nan)
                tolerance = 1e-9 if moments == "corrected" else TOLERANCE  # quantiles of F
                check(f"{cell.label} anees_{name} {by.__name__}",
                      column(series, "anees_" + name), average, tolerance)
            judged = n > 0
            n = n[judged]
            for end, quantile in (("lower", stats.chi2.ppf), ("upper", stats.chi2.isf)):
                ours = column(series, f"{end}_{name}")[judged]
                check(f"{cell.label} {end}_{name}", ours, quantile(0.025, n * dof) / n)
    ees = cell.errors**2
    check(f"{cell.label} rmse", column(series, "position_rmse [m]"),
          np.sqrt(ees[..., :2].sum(-1).mean(axis=0)))
    check(f"{cell.label} rmse", column(series, "heading_rmse [rad]"),
          np.sqrt(ees[..., 2].mean(axis=0)))
    numbers = {row["cell"]: row for row in rows_of(f"{folder}/cells.csv")}[cell.label]
    for name, unit in (("position_rmse", " [m]"), ("heading_rmse", " [rad]"), ("log_score", "")):
        values = cell.scores[name]
        check(f"{cell.label} {name}", float(numbers[f"{name}_mean{unit}"]), values.mean())
        check(f"{cell.label} {name}", float(numbers[f"{name}_sd{unit}"]), values.std(ddof=1))
    if cell.joint:
        nees, components = cell.joint
        ours = [row for row in rows_of(f"{folder}/joint_nees.csv") if row["cell"] == cell.label]
        n, rows = components.sum(axis=0), nees.shape[1]
        check(f"{cell.label} joint", column(ours, "nees_per_component"), nees.sum(axis=0) / n,
              1e-10)
        tail = 0.025 / (2 * rows)  # two families, of which one has a member for each stored scan
        for end, quantile in ("lower", stats.chi2.ppf), ("upper", stats.chi2.isf):
            check(f"{cell.label} joint {end}", column(ours, end), quantile(tail, n) / n, 1e-10)


def holm(p):
    order = np.argsort(p, kind="stable")
    steps = np.array(p)[order] * np.arange(len(p), 0, -1)
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum(1, np.maximum.accumulate(steps))
    return adjusted


def wins(cell, other, metric):
    """(differences of common complete runs, won, lost). A failed run is lost to a complete one,
    unless neither a high nor a low value is good."""
    mine, its = cell.scores[metric], other.scores[metric]
    both = np.intersect1d(cell.runs, other.runs)
    difference = mine[np.searchsorted(cell.runs, both)] - its[np.searchsorted(other.runs, both)]
    won = np.count_nonzero(difference < 0)
    lost = np.count_nonzero(difference > 0)
    if not metric.startswith("nees"):
        won += np.count_nonzero((cell.status == 1) & (other.status == 2))
        lost += np.count_nonzero((cell.status == 2) & (other.status == 1))
    return difference, won, lost


def sign_p(won, lost):
    return stats.binomtest(int(won), int(won + lost), 0.5).pvalue if won + lost else 1.0


def check_comparison(cells, folder, baseline):
    rows = rows_of(f"{folder}/comparison.csv")
    p_values = []
    for row in rows:
        name = f"{row['cell']} against {baseline} by {row['metric']}"
        difference, won, lost = wins(cells[row["cell"]], cells[baseline], row["metric"])
        moved = difference[difference != 0]
        ties = len(np.unique(np.abs(moved))) < len(moved) or len(moved) < len(difference)
        exact = len(moved) <= 50 and not ties
        rank = 1.0
        if len(moved):
            rank = stats.wilcoxon(difference, method="exact" if exact else "approx").pvalue
        tolerance = 1e-9 if row["metric"] == "nees" else TOLERANCE  # quantiles of F
        check(name + ": difference", float(row["difference"]), difference.mean(), tolerance)
        check(name + ": won, lost", [float(row["won"]), float(row["lost"])], [won, lost])
        check(name + ": sign test", float(row["p_sign"]), sign_p(won, lost))
        check(name + ": signed-rank test", float(row["p_rank"]), rank)
        p_values += [sign_p(won, lost), rank]
    ours = np.ravel([[float(row["p_sign_holm"]), float(row["p_rank_holm"])] for row in rows])
    check("Holm", ours, holm(p_values))
    for row in rows_of(f"{folder}/wins.csv"):
        _, won, lost = wins(cells[row["cell"]], cells[row["beaten"]], row["metric"])
        check(f"wins by {row['metric']}", [float(row["won"]), float(row["p_sign"])],
              [won, sign_p(won, lost)])


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
