# SPDX-License-Identifier: BSD-3-Clause
"""Computes the verdict on a Gaussian filter by the equations of STATISTICS 5, or on innovations
that `montecarta judge --innovations` stored, also of those that passed a gate (STATISTICS 9):

    python3 verdict.py FILE.h5 CELL [WITHIN [LEVEL]]

WITHIN is 1.1 if not given; LEVEL is 0.95, or verdict_level of cells.csv if cells stop by verdict,
and of innovations what leaves 0.95 for all sensors. The cell must have poses by one Gaussian of
full rank at every scan, and 3 complete runs; or the components of innovations, and 10 runs."""
import sys
from collections import Counter, namedtuple
from functools import partial
from itertools import combinations

import h5py
import numpy as np
from scipy import interpolate, stats
from scipy.spatial.transform import Rotation

RATIOS = ["size", "component", "stretch", "component_by_stretch", "scan"]
NOT_PROVED = ["component_by_stretch", "scan", "bias_by_stretch", "correlation_by_stretch",
              "between_runs"]  # "consistent" needs that no deviation beyond the margin is shown
Member = namedtuple("Member", "family name estimate p interval")  # interval(level)
# Errors {run, scan, component} in units of their covariance and of their deviations, NaN where
# there is none; times of the scans [s]; names of the components; [(count, components, limit)] of
# rows that passed a gate.
Errors = namedtuple("Errors", "whitened standardised times names gate")


def settings_of(cell):
    return cell["settings"].attrs if "settings" in cell else {}


def errors_of(path, label):
    """The errors of a cell."""
    with h5py.File(path, "r") as file:
        if "sums" in file:
            sys.exit(f"{path}: has sums instead of runs: use montecarta analyze")
        cell, rows, times = file["cells"][label], file["scan_row"][:], file["scan"][:]
        if settings_of(cell).get("state") == "innovations" and "error" in cell:
            return innovations_of(cell, label, times)
        is_several = cell.attrs["particles"] > 0 or "pose_mean_mixture" in cell
        if is_several or "error" in cell or "pose_covariance" not in cell:
            sys.exit(f"{label}: verdict.py takes only poses by one Gaussian with its covariance")
        noise = file["scenario"].attrs.get("noise", "unknown")
        poses, complete = file["truth/pose"][:], cell["status"][:] == 1
        columns = poses, cell["pose_mean"][:], cell["pose_covariance"][:]
        truth, mean, P = (column[complete][:, rows] for column in columns)
    is_same = noise == "measured-control" or (poses[..., 2] == poses[0, :, 2]).all()
    frame = truth if is_same and noise != "matched" else mean  # whose heading turns the errors
    e = mean - truth
    e[..., 2] -= 2 * np.pi * np.round(e[..., 2] / (2 * np.pi))
    turn = Rotation.from_euler("z", -frame[..., 2].ravel()).as_matrix().reshape(P.shape)
    e, P = (turn @ e[..., None])[..., 0], turn @ P @ np.swapaxes(turn, -1, -2)
    sigma = np.sqrt(np.diagonal(P, axis1=-2, axis2=-1))
    correlation = P / (sigma[..., :, None] * sigma[..., None, :])
    if not (np.isfinite(e).all() and np.linalg.eigvalsh(correlation).min() > 1e-12):
        sys.exit(f"{label}: verdict.py needs finite errors and covariances of full rank")
    u = np.linalg.solve(np.linalg.cholesky(P), e[..., None])[..., 0]
    return Errors(u, e / sigma, times, ["forward", "left", "heading"], [])


def innovations_of(cell, label, times):
    """The innovations of a cell, which are stored on the scale that they have without a gate."""
    e, P, settings = cell["error"][:], cell["error_covariance"][:], settings_of(cell)
    names = settings["components"].split(", ")
    if len(e) < 10:
        sys.exit(f"{label}: verdict.py needs 10 runs of innovations")
    e, P = e.reshape(*e.shape[:2], len(names)), P.reshape(*e.shape[:2], len(names), len(names))
    there = np.isfinite(e).all(axis=-1)
    u, z = np.full(e.shape, np.nan), np.full(e.shape, np.nan)
    u[there] = np.linalg.solve(np.linalg.cholesky(P[there]), e[there][..., None])[..., 0]
    z[there] = e[there] / np.sqrt(np.diagonal(P[there], axis1=-2, axis2=-1))
    rows = [text.split() for text in settings.get("gate_limits", "").split(", ") if text]
    return Errors(u, z, times, names, [(float(row[0]), int(row[3]), float(row[6])) for row in rows])


def shown_by(gate, factor):
    """(9.4): the ratio that is expected if the covariance is too small by a factor."""
    v, weights = np.polynomial.legendre.leggauss(96)
    v, weights = (v + 1) / 2, weights / 2
    probability, weights = 1 - v**2, weights * 2 * v  # the integrand is infinite at 1
    total = 0.0
    for count, n, limit in gate:
        nis = factor * stats.chi2.ppf(probability * stats.chi2.cdf(limit / factor, n), n)
        share = stats.chi2.cdf(nis, n) / stats.chi2.cdf(limit, n)
        total += count * weights @ stats.chi2.ppf(share, n)
    return total / sum(count * n for count, n, _ in gate)


def behind_gate(gate, members):
    """The members with factors on the covariance in place of ratios on the scale of (9.3). Those of
    single components have no test."""
    if not gate:
        return members
    octaves = np.linspace(-7, 7, 113)
    shown = np.log([shown_by(gate, 2.0**octave) for octave in octaves])
    octave_of = interpolate.PchipInterpolator(shown, octaves)

    def factor_of(ratio):
        if ratio >= np.exp(shown[-1]):
            return 128.0
        least = np.exp(shown[0])
        return ratio / least / 128 if ratio <= least else 2.0 ** octave_of(np.log(ratio))

    def interval_of(member, level):
        lower, upper = (factor_of(end) for end in member.interval(level))
        return lower, upper if upper < 128.0 else np.inf

    members = [member for member in members if not member.family.startswith("component")]
    return [member._replace(estimate=factor_of(member.estimate), interval=partial(interval_of,
                                                                                  member))
            if member.family in RATIOS else member for member in members]


def law(values, above, below, is_ratio=False):
    """(5.1): p-value of an expectation and interval of a level, by one value of each run;
    `above` and `below` are the skewnesses for a mean above and below the expectation."""
    n, mean, sd = len(values), values.mean(), values.std(ddof=1)

    def p_value(expected):
        x = (mean - expected) / sd
        g = above if x > 0 else below
        h = (max(0, 1 + g * x / 3) ** 3 - 1) / g + g / (6 * n) if abs(g) > 1e-6 else x
        p = 2 * stats.t.sf(abs(h) * np.sqrt(n), n - 1)
        if not is_ratio:
            return p
        squares = n * mean / expected
        return min(p, 2 * stats.chi2.cdf(4 * squares, n), 2 * stats.chi2.sf(squares / 4, n))

    def end(score):
        g, z = above if score > 0 else below, score / np.sqrt(n)
        cube = 1 + g * (z - g / (6 * n))
        if abs(g) > 1e-6 and cube <= 0:
            return -np.inf * np.sign(score)
        return mean - sd * (3 / g * (np.cbrt(cube) - 1) if abs(g) > 1e-6 else z)

    def interval(level):
        score = stats.t.isf((1 - level) / 2, n - 1)
        lower, upper = end(score), end(-score)
        if not is_ratio:
            return lower, upper
        tail, squares = (1 - level) / 2, n * mean
        return (max(lower, squares / 4 / stats.chi2.isf(tail, n)),
                min(upper, 4 * squares / stats.chi2.ppf(tail, n)))

    return p_value, interval


def skewness(values):
    return stats.skew(values, bias=True) * np.sqrt(len(values) * (len(values) - 1)) / \
        (len(values) - 2) if values.std() > 0 else 0.0


def ratio_member(family, name, values, common=0.0):
    """A ratio of squared errors to the expected ones, by one ratio of each run."""
    n, g = len(values), skewness(values)
    least = 2 * values.std(ddof=1) / values.mean()
    below = max(g, common) * (1 + 1 / np.sqrt(n)) + np.sqrt(6 / n)
    above = g - np.sqrt(6 / n)
    p_value, interval = law(values, max(above, least), max(below, least), True)
    return Member(family, name, values.mean(), p_value(1), interval)


def zero_member(family, name, values, skewed=1.0):
    """A mean over runs that should be zero; `skewed` is 1 if it may be skewed to either side."""
    n = len(values)
    g, error = skewed * skewness(values) * (1 + 1 / np.sqrt(n)), skewed * np.sqrt(6 / n)
    p_value, interval = law(values, min(0, g - error), max(0, g + error))
    return Member(family, name, values.mean(), p_value(0), interval)


def scan_members(u, times):
    """Exactly chi-square if errors are Gaussian; by the runs as well, of which the wider counts."""
    d = u.shape[2]
    values = [of_scan[~np.isnan(of_scan)] for of_scan in (u**2).mean(axis=2).T]
    known = [v / v.mean() for v in values if len(v) >= 3 and v.any() and v.std() > 0]
    cubes = [skewness(v) * v.std(ddof=1) ** 3 for v in known]
    common = np.mean(cubes) / np.mean([v.var(ddof=1) for v in known]) ** 1.5 if known else 0.0
    for s, of_scan in enumerate(values):
        if len(of_scan) == 0 or len(of_scan) < 10 and not of_scan.any():
            continue  # missing, or rounded away
        ratio, freedom = of_scan.mean(), len(of_scan) * d
        exact = min(1, 2 * min(stats.chi2.cdf(freedom * ratio, freedom),
                               stats.chi2.sf(freedom * ratio, freedom)))
        by_runs = ratio_member("scan", "", of_scan, common) if len(of_scan) >= 3 else None

        def interval(level, ratio=ratio, freedom=freedom, by_runs=by_runs):
            tails = np.array([(1 + level) / 2, (1 - level) / 2])
            bounds = ratio * freedom / stats.chi2.ppf(tails, freedom)
            own = by_runs.interval(level) if by_runs else bounds
            return min(bounds[0], own[0]), max(bounds[1], own[1])

        yield Member("scan", f"at {times[s]:.1f} s", ratio, max(exact, by_runs.p) if by_runs
                     else exact, interval)


def excess_member(family, excess, unit, written):
    """A number that should be zero, of each group of eight runs; only too large a one counts."""
    member = zero_member(family, family, np.array(excess), skewed=0.0)
    unit = np.mean(unit)
    return member._replace(estimate=written(member.estimate / unit),
                           p=member.p / 2 if member.estimate > 0 else 1.0,
                           interval=lambda level: tuple(written(np.array(member.interval(level))
                                                                / unit)))


def group_members(u):
    """(5.2), (5.3): groups of eight successive runs of a block of 64."""
    ends = np.arange(9) * u.shape[1] // 8
    groups = [block[k:k + 8] for block in np.split(u, range(64, len(u), 64))
              for k in range(0, len(block) - 7, 8)]
    groups = [np.where(np.isnan(g).any(axis=0), 0.0, g) for g in groups]  # what all runs have
    if len(groups) < 6:
        return

    def parts(x):  # {stretch, component}
        return np.array([x[a:b].sum(axis=0) for a, b in zip(ends, ends[1:])])

    apart = np.abs(np.subtract.outer(range(8), range(8))) >= 3

    def of_different(x, y):  # sum of products of parts far apart, of other components
        own, all_of_them = x @ y.T, np.outer(x.sum(axis=1), y.sum(axis=1))
        return (own if x.shape[1] == 1 else all_of_them - own)[apart].sum()

    spread, unit, tails, square = [], [], [], []
    for g in groups:
        z, pairs = [parts(run**2) for run in g], list(combinations(range(8), 2))
        common = [parts(g[i] * g[j]) for i, j in pairs]
        spread.append(np.mean([of_different(z[i] - z[j], z[i] - z[j]) / 2 - 2 * of_different(c, c)
                               for (i, j), c in zip(pairs, common)]))
        unit.append(np.mean([of_different(z[i], z[j]) for i, j in pairs]))
        g = g[:, g.any(axis=0)]  # {run, place}
        fourth = (g**4).mean(axis=0)
        square.append((((g**2).sum(axis=0) ** 2 - 8 * fourth) / 56).mean())
        tails.append(fourth.mean() - 3 * square[-1])
    if u.shape[1] >= 16:
        yield excess_member("between_runs", spread, unit, lambda v: np.sqrt(np.maximum(v, 0)))
    yield excess_member("tails", tails, square, lambda excess: excess)


def members_of(errors):
    """All tests of errors."""
    u, z, times, names, gate = errors
    return behind_gate(gate, list(tests_of(u, z, times, names)))


def tests_of(u, z, times, names):
    """All tests of whitened errors u and standardised errors z, without regard to a gate."""
    scans, d, ratio = u.shape[1], u.shape[2], np.nanmean(np.nanmean(u**2, axis=(1, 2)))
    ends = np.arange(9) * scans // 8 if scans >= 16 else [0]
    stretches = [(f" {times[a]:.3g} s to {times[b - 1]:.3g} s", slice(a, b))
                 for a, b in zip(ends, ends[1:])]
    parts = [part for _, part in stretches] or [slice(0, scans)]

    def means(x, axis=1):  # of the runs that have such a number
        found = np.nanmean(x, axis=axis)
        return found[~np.isnan(found)]

    bias = np.array([np.nanmean(np.nanmean(u[:, part], axis=1), axis=0) for part in parts])
    pairs = {names[a] + " and " + names[b]: (u[..., a] * u[..., b], bias[:, a] * bias[:, b])
             for a, b in combinations(range(d), 2)}
    components = [(names[k], z[..., k]) for k in range(d)]

    def over_drive(family, test, named):
        yield from (test(family, name, means(x)) for name, x in named)
        yield from (test(family + "_by_stretch", name + when, means(x[:, part]))
                    for name, x in named for when, part in stretches)

    def correlations():
        def product(family, name, x, of_biases):
            return zero_member(family, name, (means(x) - of_biases) / ratio)

        for name, (x, of_biases) in pairs.items():
            yield product("correlation", name, x, np.nanmean(of_biases))
        for name, (x, of_biases) in pairs.items():
            for (when, part), of_bias in zip(stretches, of_biases):
                yield product("correlation_by_stretch", name + when, x[:, part], of_bias)

    squares = [(name, x**2) for name, x in components]
    yield ratio_member("size", "all", means(u**2, (1, 2)))
    by_component = list(over_drive("component", ratio_member, squares)) if d > 1 else []
    yield from by_component[:d]
    for when, part in stretches:
        yield ratio_member("stretch", when, means(u[:, part] ** 2, (1, 2)))
    yield from by_component[d:]
    yield from scan_members(u, times)
    yield from over_drive("bias", zero_member, components)
    yield from correlations()
    yield from group_members(u)
    largest = np.nanmax(np.abs(z))
    _, scan, k = np.unravel_index(np.nanargmax(np.abs(z)), z.shape)
    near = next(part for part in parts if part.stop > scan)
    of_place = max(1, np.mean(means(z[:, near, k] ** 2)))
    p = min(1, 2 * np.isfinite(z).sum() * stats.norm.sf(largest / np.sqrt(of_place)))
    yield Member("tails", "largest error", largest, p, lambda level: (np.nan, np.nan))


def judge(members, level, within):
    """The answer, and for each member its interval, its simultaneous interval, the p-value of its
    family, and whether it is shown to be off."""
    alpha, sizes = 1 - level, Counter(member.family for member in members)
    least = {f: min(1.0, n * min(m.p for m in members if m.family == f)) for f, n in sizes.items()}
    order = sorted(least, key=least.get)
    holm = np.maximum.accumulate([(len(order) - k) * least[f] for k, f in enumerate(order)])
    adjusted = dict(zip(order, np.minimum(1.0, holm)))
    rows, is_within, signs, is_rejected = [], True, set(), False
    for family, _, estimate, p, interval in members:
        n = sizes[family]
        limit = alpha * (least[family] / adjusted[family] if adjusted[family] else 1)
        shown = adjusted[family] <= alpha and p * n <= limit
        own, joint = interval(level), interval(1 - alpha / (len(sizes) * n))
        rows.append((own, joint, adjusted[family], shown))
        if family == "tails":  # a finding that is no part of the answer
            continue
        is_rejected |= adjusted[family] <= alpha
        is_bias = family in ("bias", "bias_by_stretch")
        most = np.sqrt(within - 1) if is_bias else within - (family not in RATIOS)
        least_allowed = 1 / most if family in RATIOS else -most
        is_disproved = joint[0] > most or joint[1] < least_allowed
        is_proved = own[0] >= least_allowed and own[1] <= most
        is_within &= not is_disproved and (family in NOT_PROVED or is_proved)
        if shown and family in RATIOS:
            signs.add("optimistic" if estimate > 1 else "conservative")
    answer = (signs.pop() if len(signs) == 1 else "inconsistent") if is_rejected else "undecided"
    return "consistent" if is_within else answer, rows


def usual_level(path, label):
    """0.95, or what leaves that for whiteness and size of the innovations of all sensors."""
    with h5py.File(path, "r") as file:
        if settings_of(file["cells"][label]).get("state") != "innovations":
            return 0.95
        sensors = {settings_of(cell).get("sensor", "") for cell in file["cells"].values()} - {""}
        return 1 - 0.05 / (2 * max(len(sensors), 1))


if __name__ == "__main__":
    within = float(sys.argv[3]) if len(sys.argv) > 3 else 1.1
    members = members_of(errors_of(*sys.argv[1:3]))
    level = float(sys.argv[4]) if len(sys.argv) > 4 else usual_level(*sys.argv[1:3])
    answer, rows = judge(members, level, within)
    print(f"{sys.argv[2]}: {answer}\nfamily, member: estimate [interval], p of the family")
    least = min(member.p for member in members if member.family == "scan")
    for (family, name, estimate, p, _), (own, _, family_p, shown) in zip(members, rows):
        if family != "scan" or p == least:
            print(f"{family + ', ' + name:32} {estimate:8.4f} [{own[0]:.4f}, {own[1]:.4f}] "
                  f"{family_p:.2g}{'  shown' if shown else ''}")
