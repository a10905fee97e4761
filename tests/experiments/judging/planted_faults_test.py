#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Faults that a verdict on the average NEES does not see, through judge, gate and compare.

usage: planted_faults_test.py MONTECARTA

Each cell has 200 runs of 64 scans of a vector of three components, whose estimator reports the unit
matrix. Errors follow an autoregression of 0.95 from scan to scan. `gate` must stop every fault and
name its family within 1.1, and let the right estimator pass within 1.5."""
import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile

RUNS, SCANS, MEMORY = 200, 64, 0.95


def series(draw):
    """Standard normal errors of one component in one run."""
    values = [draw.gauss(0, 1)]
    while len(values) < SCANS:
        values.append(MEMORY * values[-1] + math.sqrt(1 - MEMORY**2) * draw.gauss(0, 1))
    return values


def right(errors, run):
    return errors


def scaled(ratio_of):
    """Errors whose variance is ratio_of(run, component, scan) times the reported one."""
    return lambda errors, run: [[math.sqrt(ratio_of(run, k, s)) * e for s, e in enumerate(values)]
                                for k, values in enumerate(errors)]


def covered_bias(errors, run):
    return [[(e + 1) / math.sqrt(2) for e in values] for values in errors]


def correlated(errors, run):
    first, second, third = errors
    return [first, [0.9 * a + math.sqrt(1 - 0.81) * b for a, b in zip(first, second)], third]


CELLS = {
    "right": (right, None),
    "components": (scaled(lambda run, k, s: (0.5, 0.5, 2)[k]), "component"),
    "runs": (scaled(lambda run, k, s: (0.5, 1.5)[run % 2]), "between_runs"),
    "bias": (covered_bias, "bias"),
    "halves": (scaled(lambda run, k, s: 0.7 if s < SCANS // 2 else 1.3), "stretch"),
    "correlation": (correlated, "correlation"),
}


def write_estimates(folder):
    names = []
    for label, (plant, _) in CELLS.items():
        (folder / label).mkdir()
        draw = random.Random(label)
        for run in range(RUNS):
            errors = plant([series(draw) for _ in range(3)], run)
            rows = [f"{s + 1},{errors[0][s]!r},{errors[1][s]!r},{errors[2][s]!r},1,0,0,1,0,1"
                    for s in range(SCANS)]
            names.append(f"{label}/run_{run}.csv")
            header = "time_s,a_m,b_m,c_m,cov_0_0,cov_0_1,cov_0_2,cov_1_1,cov_1_2,cov_2_2"
            (folder / names[-1]).write_text("\n".join([header, *rows]) + "\n")
    truth = "\n".join(f"{s + 1},0,0,0" for s in range(SCANS))
    (folder / "truth.csv").write_text(f"time_s,a_m,b_m,c_m\n{truth}\n")
    return names


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def call(*words):
            return subprocess.run([program, *words], cwd=folder, capture_output=True, text=True)

        judged = call("judge", *write_estimates(folder), "--truth", "truth.csv", "--error", "world",
                      "-o", "out.h5")
        assert judged.returncode == 0, judged.stderr
        for label, (_, family) in CELLS.items():
            margin = "1.1" if family else "1.5"
            gate = call("gate", "out.h5", "--cell", label, "--within", margin, "--json")
            found = json.loads(gate.stdout)
            print(found["reason"])
            assert gate.returncode == (0 if family is None else 4), (label, gate)
            rejected = [test["family"] for test in found["families"] if test["rejected"]]
            assert (family in rejected) if family else not rejected, (label, rejected)
        compared = call("compare", "out.h5", "--baseline", "right")
        assert compared.returncode == 0, compared.stderr
        for label in CELLS:
            assert label in compared.stdout, label


if __name__ == "__main__":
    main()
