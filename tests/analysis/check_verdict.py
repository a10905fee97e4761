#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the verdicts of analysis/readers/verdict.py with those of montecarta.

usage: check_verdict.py OUT.h5 ANALYZE_CSV [CELL...]

ANALYZE_CSV is what `montecarta analyze --csv` wrote; without cells all are compared. Prints every
number that differs, by more than 1e-9 of itself in estimates, 1e-6 in intervals and p-values, and
1e-3 in factors behind a gate, and ends with 1 if there is one. Numbers below 1e-300 have fewer
digits: there both count as 0."""
import csv
import sys

import numpy as np

import verdict

INTERVALS = ["lower", "upper", "simultaneous_lower", "simultaneous_upper"]


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def differs(ours, theirs, tolerance):
    return not np.isclose(float(ours), float(theirs), rtol=tolerance, atol=1e-300, equal_nan=True)


def main(result, folder, *labels):
    cells = {row["cell"]: row for row in rows_of(f"{folder}/cells.csv")}
    compared, wrong = 0, []
    for label in labels or cells:
        cell, tests = cells[label], rows_of(f"{folder}/families.csv")
        tests = [row for row in tests if row["cell"] == label]
        errors = verdict.errors_of(result, label)
        members = verdict.members_of(errors)
        answer, judged = verdict.judge(members, float(cell["verdict_level"]), float(cell["within"]))
        if not cell["verdict"].removeprefix("slightly ").startswith(answer):
            wrong.append(f"{label}: {cell['verdict']}, recomputed {answer}")
        if [row["family"] for row in tests] != [member.family for member in members]:
            wrong.append(f"{label}: other families")
            continue
        for row, member, (own, joint, family_p, shown) in zip(tests, members, judged):
            theirs = dict(zip(INTERVALS, own + joint)) | {"p": member.p, "family_p": family_p}
            is_factor = errors.gate and member.family in verdict.RATIOS
            found = [("estimate", member.estimate, 1e-3 if is_factor else 1e-9),
                     ("shown", shown, 1e-9)]
            found += [(name, value, 1e-3 if is_factor and name in INTERVALS else 1e-6)
                      for name, value in theirs.items()]
            wrong += [f"{label} {member.family} {member.name} {name}: montecarta {row[name]}, "
                      f"recomputed {value!r}" for name, value, tolerance in found
                      if differs(row[name], value, tolerance)]
            compared += len(found)
    print(*wrong[:20], f"{compared} numbers compared, {len(wrong)} differ", sep="\n")
    return 1 if wrong or not compared else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
