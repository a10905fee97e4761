# SPDX-License-Identifier: BSD-3-Clause
"""Computes the verdict on a Gaussian filter by the equations of STATISTICS 5:

    python3 verdict.py FILE.h5 CELL [WITHIN [LEVEL]]

WITHIN is 1.1 if not given; LEVEL is 0.95, or verdict_level of cells.csv if cells stop by verdict.
The cell must have poses by one Gaussian of full rank at every scan, and 3 complete runs."""
import sys
from collections import Counter, namedtuple

import h5py
import numpy as np
from scipy import special, stats
from scipy.spatial.transform import Rotation

NAMES, RATIOS = ["forward", "left", "heading"], ["size", "component", "stretch", "scan"]
Member = namedtuple("Member", "family name estimate p interval")  # interval(level)


def errors_of(path, label):
    """Whitened and standardised errors {run, scan, component}, and the times of the scans [s]."""
    with h5py.File(path, "r") as file:
        if "sums" in file:
            sys.exit(f"{path}: has sums instead of runs: use montecarta analyze")
        cell, rows, times = file["cells"][label], file["scan_row"][:], file["scan"][:]
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
    return np.linalg.solve(np.linalg.cholesky(P), e[..., None])[..., 0], e / sigma, times


def products(x):
    """(5.1): G of x {run, term}, the mean of G_ij^2, and that mean without each run."""
    n, x = len(x), x / np.sqrt((x**2).mean(axis=0))
    G = x @ x.T
    squares = (G**2).sum(axis=1) - np.diag(G) ** 2
    total = squares.sum()
    return G, total / (n * (n - 1)), (total - 2 * squares) / ((n - 1) * (n - 2))


def traces(x, block):
    """(5.2), (5.3): t1, t2, t3 and the degrees of freedom of t2."""
    n, t1 = x.shape
    if n < 20:
        return t1, t1**2 / block, t1**3 / block**2, np.inf
    G, mean, without = products(x)
    error = np.sqrt((n - 1) / n * ((without - mean) ** 2).sum())
    t2 = np.clip((n + 2) / n * (mean + error), t1, t1**2 / block)
    G = G - np.diag(np.diag(G))
    t3 = (n + 2) * (n + 4) / n**2 * np.sum(G * (G @ G)) / (n * (n - 1) * (n - 2))
    return t1, t2, np.clip(t3, t2**2 / t1, t2**1.5), max(2, 2 * (mean / error) ** 2)


def ratio_member(family, name, ratio, runs, t1, t2, t3, freedom):
    """(5.4), (5.5): a mean of squares over runs by the shifted gamma law."""
    shape, scale = runs * t2**3 / (2 * t3**2), 2 * t3 / (runs * t2 * t1)
    shift = 1 - shape * scale
    x = max((ratio - shift) / scale, 0)
    score = stats.norm.isf(min(special.gammainc(shape, x), special.gammaincc(shape, x)))

    def interval(level):
        tail = stats.norm.sf(min(stats.t.isf((1 - level) / 2, freedom), 37))
        lower = shift + scale * special.gammaincinv(shape, tail)
        upper = shift + scale * special.gammainccinv(shape, tail)
        return ratio / upper, ratio / lower if lower > 0 else np.inf

    return Member(family, name, ratio, 2 * stats.t.sf(min(score, 37), freedom), interval)


def mean_member(family, name, values):
    """A mean over runs that should be zero, by Student's t."""
    n, mean, error = len(values), values.mean(), stats.sem(values)
    return Member(family, name, mean, 2 * stats.t.sf(abs(mean / error), n - 1),
                  lambda level: tuple(mean + error * stats.t.ppf([(1 - level) / 2, (1 + level) / 2],
                                                                 n - 1)))


def spread_member(x):
    """(5.6): the standard deviation of the scales that runs have of their own, one-sided."""
    n, t1 = x.shape
    G, mean, without = products(x)
    own = (n + 2) / (n - 1) * (np.diag(G) - t1) ** 2 / 2
    others = (n + 2) / n * (n * mean - (n - 1) * without)
    v = mean_member("between_runs", "runs", (own - others) / (mean + t1**2 / 2))
    return v._replace(estimate=np.sqrt(max(v.estimate, 0)), p=v.p / 2 if v.estimate > 0 else 1.0,
                      interval=lambda level: tuple(np.sqrt(np.maximum(v.interval(level), 0))))


def members_of(u, z, times):
    """All tests of whitened errors u and standardised errors z {run, scan, component}."""
    runs, scans, d = u.shape
    kept = max(50, min(256, 8_000_000 // (scans * d)))  # runs whose products are made

    def aspect(family, name, x, block):
        law = traces(x[:kept].reshape(-1, x[0].size), block)
        return ratio_member(family, name, np.mean(x**2), runs, *law)

    yield aspect("size", "all", u, d)
    yield from (aspect("component", NAMES[k], z[..., k], 1) for k in range(d))
    for s in range(8 if scans >= 16 else 0):
        first, end = s * scans // 8, (s + 1) * scans // 8
        name = f"{times[first]:.3g} s to {times[end - 1]:.3g} s"
        yield aspect("stretch", name, u[:, first:end], d)
    for s in range(scans):  # exactly chi-square
        ratio = np.mean(u[:, s] ** 2)
        yield ratio_member("scan", f"at {times[s]:.1f} s", ratio, runs * d, 1, 1, 1, np.inf)
    yield from (mean_member("bias", NAMES[k], z[..., k].mean(axis=1)) for k in range(d))
    for a, b in ((0, 1), (0, 2), (1, 2)):
        name, values = NAMES[a] + " and " + NAMES[b], (u[..., a] * u[..., b]).mean(axis=1)
        yield mean_member("correlation", name, values)
    if runs >= 50:
        yield spread_member(u[:kept].reshape(-1, scans * d))


def judge(members, level, within):
    """The answer, and for each member its interval, its simultaneous interval, the p-value of its
    family, and whether it is shown to be off."""
    alpha, sizes = 1 - level, Counter(member.family for member in members)
    least = {f: min(1.0, n * min(m.p for m in members if m.family == f)) for f, n in sizes.items()}
    order = sorted(least, key=least.get)
    holm = np.maximum.accumulate([(len(order) - k) * least[f] for k, f in enumerate(order)])
    adjusted = dict(zip(order, np.minimum(1.0, holm)))
    rows, is_within, signs = [], True, set()
    for family, _, estimate, p, interval in members:
        n, limit = sizes[family], alpha * (least[family] / adjusted[family] or 1)
        shown = adjusted[family] <= alpha and p * n <= limit
        own, joint = interval(level), interval(1 - alpha / (len(sizes) * n))
        rows.append((own, joint, adjusted[family], shown))
        most = np.sqrt(within - 1) if family == "bias" else within - (family not in RATIOS)
        least_allowed = 1 / most if family in RATIOS else -most
        is_disproved = joint[0] > most or joint[1] < least_allowed
        is_proved = own[0] >= least_allowed and own[1] <= most
        is_within &= not is_disproved if family in ("scan", "between_runs") else is_proved
        if shown and family in RATIOS:
            signs.add("optimistic" if estimate > 1 else "conservative")
    rejected = min(adjusted.values()) <= alpha
    answer = (signs.pop() if len(signs) == 1 else "inconsistent") if rejected else "undecided"
    return "consistent" if is_within else answer, rows


if __name__ == "__main__":
    within, level = [float(text) for text in sys.argv[3:] + ["1.1", "0.95"][len(sys.argv) - 3:]]
    members = list(members_of(*errors_of(*sys.argv[1:3])))
    answer, rows = judge(members, level, within)
    print(f"{sys.argv[2]}: {answer}\nfamily, member: estimate [interval], p of the family")
    least = min(member.p for member in members if member.family == "scan")
    for (family, name, estimate, p, _), (own, _, family_p, shown) in zip(members, rows):
        if family != "scan" or p == least:
            print(f"{family + ', ' + name:32} {estimate:8.4f} [{own[0]:.4f}, {own[1]:.4f}] "
                  f"{family_p:.2g}{'  shown' if shown else ''}")
