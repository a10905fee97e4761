#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts estimates and truths that other programs wrote to the CSV files that `montecarta judge`
reads. FILE.txt is converted to FILE.csv in the same folder, or below FOLDER with -o FOLDER.

    python3 estimates.py estimate runs/*/estimate.txt
    python3 estimates.py truth runs/*/truth.txt

It reads TUM (covariances in columns behind the pose or in FILE.cov), OpenVINS, EuRoC, cnspy, SQUARE
(smfeval), CSV files of ROS odometry, states with columns sigma_NAME, and arrays of all runs in .npz
or .mat. It says which layout it took and why, and refuses what is ambiguous. All files are checked
before one is written. See experiments/JUDGING_ESTIMATES.md.
"""
import dataclasses
import os
import re
import sys

import conversion
import estimate_arrays
import estimate_layouts
from conversion import ConversionError, np
from estimate_layouts import POSE_COLUMNS, rotations
from estimate_table import SAME_TIME, SECONDS_IN

PLANAR_COLUMNS = ("x_m", "y_m", "heading_rad")
PLANAR_COMPONENTS = [0, 1, 5]  # x, y, rz
OUT_OF_PLANE = 0.01            # [m] of z and [rad] of tilt that --planar takes for 0
KNOWN_START = 1e-6             # [m, rad] deviations of a first estimate that --align takes for 0


def headings(poses):
    """Rotations about the vertical of poses in space."""
    R = rotations(poses[:, 3:])
    return np.arctan2(R[:, 1, 0], R[:, 0, 0])


def check_in_space(run, option):
    if run.columns != POSE_COLUMNS:
        raise ConversionError(f"{run.path}: {option} (it needs a pose in space, but the columns "
                              f"are {','.join(run.columns)}): leave it out")


def planar(run):
    """A run of poses in space as one of poses in the plane."""
    check_in_space(run, "--planar")
    if not run.times:
        return dataclasses.replace(run, columns=PLANAR_COLUMNS, states=np.zeros((0, 3)),
                                   covariances=np.zeros((0, 3, 3)))
    height = np.abs(run.states[:, 2] - run.states[0, 2])
    tilt = np.arccos(np.clip(rotations(run.states[:, 3:])[:, 2, 2], -1.0, 1.0))
    wrong = np.flatnonzero((height > OUT_OF_PLANE) | (tilt > OUT_OF_PLANE))
    if wrong.size:
        k = wrong[0]
        raise ConversionError(f"{run.places[k]}: the pose leaves the plane ({height[k]:.3g} m in "
                              f"height, {np.degrees(tilt[k]):.3g} degrees of tilt): leave out "
                              "--planar")
    states = np.column_stack([run.states[:, :2], headings(run.states)])
    P = run.covariances
    if P is not None:
        P = P[:, PLANAR_COMPONENTS][:, :, PLANAR_COMPONENTS]
    return dataclasses.replace(run, columns=PLANAR_COLUMNS, states=states, covariances=P)


def interpolated(run, time):
    """The pose of a truth at a time, linear between two rows; quaternions are normalised."""
    after = next((k for k, own in enumerate(run.times)
                  if own >= time - SAME_TIME), None)
    if after is not None and abs(run.times[after] - time) <= SAME_TIME:
        return run.states[after]
    if not after:
        raise ConversionError(f"{run.path}: has no time around {time} s, that of the first "
                              "estimate (--align moves the truth there): give the truth of the "
                              "same run")
    a, b = run.states[after - 1], run.states[after].copy()
    if a[3:] @ b[3:] < 0:
        b[3:] = -b[3:]
    share = float((time - run.times[after - 1]) / (run.times[after] - run.times[after - 1]))
    pose = (1 - share) * a + share * b
    pose[3:] /= np.linalg.norm(pose[3:])
    return pose


def aligned(truth, estimate):
    """The truth, moved onto the first estimate by position and heading about the vertical."""
    for run in (truth, estimate):
        check_in_space(run, "--align yaw")
    if not estimate.times:
        return truth
    first, own = estimate.states[0], interpolated(truth, estimate.times[0])
    R, R_own = rotations(np.array([first[3:], own[3:]]))
    between = R @ R_own.T
    turn = np.arctan2(between[1, 0] - between[0, 1], between[0, 0] + between[1, 1])
    cos, sin = np.cos(turn), np.sin(turn)
    states = truth.states.copy()
    states[:, :3] = first[:3] + (truth.states[:, :3] - own[:3]) @ np.array(
        [[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]])
    c, s = np.cos(turn / 2), np.sin(turn / 2)
    x, y, z, w = truth.states[:, 3:].T
    states[:, 3:] = np.column_stack([c * x - s * y, c * y + s * x, c * z + s * w, c * w - s * z])
    return dataclasses.replace(truth, states=states)


def without_first(run):
    """The estimates without the first, onto which --align moves the truth."""
    check_in_space(run, "--align yaw")
    if not run.times:
        return run
    deviations = np.sqrt(np.maximum(np.diag(run.covariances[0]), 0))[[0, 1, 2, 5]]
    if (deviations > KNOWN_START).any():
        raise ConversionError(f"{run.places[0]}: --align yaw (the first estimate has a deviation "
                              f"of {deviations.max():.3g} m or rad in what the truth is moved by, "
                              "so that its covariance is not that of a moved error): convert "
                              "without --align; judge --anchor yaw bounds such errors; if truth "
                              "and estimates are in one frame, neither is needed")
    notes = [*run.notes, "the first estimate is left out, onto which the truth is moved"]
    return dataclasses.replace(run, places=run.places[1:], times=run.times[1:],
                               states=run.states[1:], covariances=run.covariances[1:], notes=notes)


def is_arrays(path):
    return path.lower().endswith((".npz", ".mat"))


def outputs(arguments):
    """[(path of the CSV file, run)] of all files, before options change them."""
    folders = [os.path.dirname(os.path.abspath(path)) for path in arguments.files]
    common = os.path.commonpath(folders)
    found = []
    for path, folder in zip(arguments.files, folders):
        stem = os.path.splitext(path)[0]
        if arguments.output:
            stem = os.path.normpath(os.path.join(arguments.output, os.path.relpath(
                folder, common), os.path.basename(stem)))
        if is_arrays(path):
            if arguments.output and len(arguments.files) == 1:
                stem = arguments.output
            for number, run in estimate_arrays.runs_in(path, arguments):
                name = "" if number is None else f"run_{number}"
                found.append((os.path.join(stem, name, f"{arguments.kind}.csv"), run))
            continue
        run = estimate_layouts.read(path, arguments)
        if path.lower().endswith(".csv") and not arguments.output:
            raise ConversionError(f"{path}: ends with .csv itself (the result beside it would have "
                                  "the same name): name a folder for the results by -o FOLDER")
        found.append((stem + ".csv", run))
    return found


def run_number(path):
    """The number at the end of a file's name or, without one, of its innermost folder that ends
    with one; None without any. `montecarta judge` pairs runs by it."""
    names = os.path.splitext(os.path.abspath(path))[0].split(os.sep)
    numbers = [re.search(r"(\d+)$", name) for name in reversed(names)]
    return next((int(found[1]) for found in numbers if found), None)


def with_alignment(found, arguments):
    """The outputs under --align yaw. One truth may be that of all estimates: then it becomes a
    truth for each."""
    if arguments.kind == "estimate":
        return [(path, without_first(run)) for path, run in found]
    onto = [estimate_layouts.read(path, dataclasses.replace(arguments, kind="states"))
            for path in arguments.onto]
    if len(found) == 1 and len(onto) > 1:
        folder = os.path.dirname(found[0][0])
        common = os.path.commonpath([os.path.dirname(os.path.abspath(p)) for p in arguments.onto])
        paths = [os.path.join(folder, os.path.relpath(os.path.dirname(os.path.abspath(p)), common),
                              "truth_" + os.path.splitext(os.path.basename(p))[0] + ".csv")
                 for p in arguments.onto]
        found = [(os.path.normpath(path), found[0][1]) for path in paths]
    if len(found) != len(onto):
        raise ConversionError(f"--onto: {len(onto)} estimates of {len(found)} truths (each truth "
                              "is moved onto its own, in the same order): name as many")
    for (_, run), estimate in zip(found, onto):
        if len(arguments.files) > 1 and run_number(run.path) != run_number(estimate.path):
            raise ConversionError(f"--onto: {estimate.path} is no estimate of {run.path} (the "
                                  "numbers of the runs differ): name both in the same order")
    return [(path, aligned(run, estimate)) for (path, run), estimate in zip(found, onto)]


def csv_lines(run):
    """Header and rows of the CSV file of a run."""
    header = ",".join(("time_s", *run.columns))
    numbers = run.states
    if run.covariances is not None:
        d = run.covariances.shape[1]
        header += "".join(f",cov_{i}_{j}" for i in range(d) for j in range(d))
        numbers = np.column_stack([numbers, run.covariances.reshape(len(numbers), d * d)])
    rows = (",".join([format(time.normalize(), "f"), *map(conversion.number_text, row)])
            for time, row in zip(run.times, numbers))
    return header, rows


def write_all(found):
    """Writes all files under temporary names, then renames them, so that none is ever half."""
    for k, (path, run) in enumerate(found):
        if os.path.exists(path) or path in (other for other, _ in found[:k]):
            raise ConversionError(f"{path}: exists (nothing is overwritten, {run.path} would be "
                                  "converted to it): name another folder by -o FOLDER")
    written = []
    try:
        for path, run in found:
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
            written.append(f"{path}.{os.getpid()}.part")
            conversion.write_rows(written[-1], *csv_lines(run))
        for part, (path, _) in zip(list(written), found):
            os.rename(part, path)
            written.remove(part)
    finally:
        for part in written:
            if os.path.exists(part):
                os.remove(part)


def first_of(paths):
    more = len(set(paths)) - 1
    return paths[0] + (f" and {more} more" if more else "")


def report(found):
    """Says on stderr, in one line for all files alike, which layout was taken and why, and in a
    line of its own what was guessed."""
    said, assumed = {}, {}
    for path, run in found:
        for one in run.assumed:
            assumed.setdefault(one, []).append(run.path)
        said.setdefault((run.layout, tuple(dict.fromkeys(run.notes))), []).append(run.path)
    for (layout, notes), paths in said.items():
        print(f"{first_of(paths)}: {'; '.join([layout, *notes])}", file=sys.stderr)
    for guess, paths in assumed.items():
        print(f"ASSUMED of {first_of(paths)}: {guess}", file=sys.stderr)
    print(f"{len(found)} {'files' if len(found) > 1 else 'file'} written, such as {found[0][0]}",
          file=sys.stderr)


def convert(arguments):
    if bool(arguments.align and arguments.kind == "truth") != bool(arguments.onto):
        raise ConversionError("--align yaw and --onto belong together for truths (a truth is moved "
                              "onto the first estimate of its run): name the estimates by --onto")
    if arguments.output and os.path.exists(arguments.output) and not os.path.isdir(
            arguments.output):
        raise ConversionError(f"{arguments.output}: is no folder (the results are files in it): "
                              "name a folder by -o FOLDER")
    found = outputs(arguments)
    if arguments.align:
        found = with_alignment(found, arguments)
    if arguments.planar:
        found = [(path, planar(run)) for path, run in found]
    write_all(found)
    report(found)


@dataclasses.dataclass
class Options:
    """The options of a call."""
    kind: str
    files: list
    output: str = None
    quaternion: str = None
    order: str = None
    triangle: str = None
    time: str = None
    planar: bool = False
    align: str = None
    onto: list = None


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("kind", choices=("estimate", "truth"))
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="folder to write to")
    parser.add_argument("--quaternion", choices=("xyzw", "wxyz"),
                        help="order of the quaternion's columns, whatever the header says")
    parser.add_argument("--order", choices=("position-first", "rotation-first"),
                        help="order of a covariance whose columns have no names")
    parser.add_argument("--triangle", choices=("upper", "lower"),
                        help="triangle of a covariance in 21 numbers, row by row")
    parser.add_argument("--time", choices=tuple(SECONDS_IN),
                        help="unit of the times")
    parser.add_argument("--planar", action="store_true",
                        help="x, y and heading of poses that stay in the plane")
    parser.add_argument("--align", choices=("yaw",), help="move each truth onto the first estimate "
                        "by position and heading, and leave that estimate out")
    parser.add_argument("--onto", nargs="+", metavar="ESTIMATE",
                        help="the estimates onto which --align moves the truths")
    conversion.run(convert, Options(**vars(parser.parse_args())))
