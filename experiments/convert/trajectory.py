#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts trajectories of poses in space, as written by evo (TUM) and OpenVINS, to the CSV files
that `montecarta judge` reads. FILE.txt is converted to FILE.csv in the same folder.

    python3 trajectory.py estimate runs/*/estimate.txt
    python3 trajectory.py truth runs/*/truth.txt

Lines are `timestamp tx ty tz qx qy qz qw`; `#` begins a comment. In a file of estimates, the pose
is followed by the 12 numbers of OpenVINS, or the covariances are in FILE.cov. A line of that has a
timestamp and 36 numbers row by row, or the 21 of the upper triangle, in the order x, y, z, rx, ry,
rz. A truth needs poses only. See experiments/JUDGING_ESTIMATES.md.
"""
import os
import sys

import conversion
from conversion import ConversionError, np

POSE, OPEN_VINS, WHOLE, TRIANGLE = 8, 20, 37, 22  # numbers in a line, the timestamp included
SAME_TIME = 1e-6         # [s] tolerance between the times of pose and covariance
QUATERNION_SLACK = 2e-3  # tolerance of its length, if printed with three digits
HEADER = "time_s,x_m,y_m,z_m,qx,qy,qz,qw"
UPPER = np.triu_indices(6)


def lines_in(path):
    """Yields ("FILE:LINE", numbers) of each line, without comments and empty lines."""
    text = conversion.text_of(path)
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        place = f"{path}:{number}"
        if not line.endswith("\n"):
            raise ConversionError(f"{place}: the last row has no end (the file may have been cut "
                                  "short): end it with a line break if it is whole")
        numbers = [conversion.finite_number(word) for word in words]
        if None in numbers:
            raise ConversionError(f"{place}: '{words[numbers.index(None)][:40]}' is no number (a "
                                  "line has a timestamp and a pose): correct it")
        yield place, numbers


def symmetric(triangle, side):
    """The symmetric matrix of an upper triangle, which is given row by row."""
    P = np.zeros((side, side))
    P[np.triu_indices(side)] = triangle
    return P + np.triu(P, 1).T


def rotation(quaternion, place):
    """The rotation matrix of a quaternion qx, qy, qz, qw."""
    length = float(np.linalg.norm(quaternion))
    if not abs(length - 1.0) <= QUATERNION_SLACK:
        raise ConversionError(f"{place}: the quaternion has length {length:g} (of a rotation it is "
                              "1): write qx, qy, qz, qw of a unit quaternion")
    x, y, z, w = np.asarray(quaternion) / length
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def open_vins_covariance(numbers, place):
    """The covariance {6, 6} under the convention `world`, position first. OpenVINS writes Pr of the
    rotation error in the frame of the estimated body, Log(R_truth' R_mean), then Pt of the position
    in the map, and no correlation of the two. R Pr R' converts Pr to the map frame."""
    R = rotation(numbers[4:POSE], place)
    turned = R @ symmetric(numbers[POSE:POSE + 6], 3) @ R.T
    P = np.zeros((6, 6))
    P[:3, :3] = symmetric(numbers[POSE + 6:], 3)
    P[3:, 3:] = (turned + turned.T) / 2
    return P


def covariances_in(path, poses, of):
    """The covariances [{6, 6}] in the file `path`, which belong to the poses of the file `of`."""
    covariances = []
    for place, numbers in lines_in(path):
        k = len(covariances)
        if len(numbers) not in (WHOLE, TRIANGLE):
            raise ConversionError(f"{place}: {len(numbers)} numbers in the line (a timestamp and "
                                  "36 or 21 are a covariance): write all lines alike")
        if k == len(poses) or not abs(numbers[0] - poses[k][0]) <= SAME_TIME:
            raise ConversionError(f"{place}: time {numbers[0]} s is not that of row {k + 1} of "
                                  f"{of} (every pose has one covariance): write them at the same "
                                  "times")
        covariances.append(symmetric(numbers[1:], 6) if len(numbers) == TRIANGLE
                           else np.reshape(numbers[1:], (6, 6)))
    if len(covariances) != len(poses):
        raise ConversionError(f"{path}: {len(covariances)} covariances of {len(poses)} poses in "
                              f"{of} (every pose has one): write them at the same times")
    return covariances


def poses_in(path, widths, why):
    """The numbers of each line and their places. The count of numbers must be in `widths`."""
    poses, places = [], []
    for place, numbers in lines_in(path):
        if len(numbers) not in widths:
            raise ConversionError(f"{place}: {len(numbers)} numbers in the line ({why}): write all "
                                  "lines alike")
        if poses and not numbers[0] > poses[-1][0]:
            raise ConversionError(f"{place}: time {numbers[0]} s is not later than that of the row "
                                  "before (rows go forward in time): sort them")
        rotation(numbers[4:POSE], place)
        poses.append(numbers)
        places.append(place)
    if not poses and "# timestamp" not in conversion.text_of(path):
        raise ConversionError(f"{path}: no rows (a file that begins with '# timestamp' may have "
                              "none, of a run that failed): write one row for each time")
    return poses, places


def covariances_beside(path):
    """Path of the file of covariances that belongs to a file of estimates."""
    return os.path.splitext(path)[0] + ".cov"


def estimate_rows(path):
    """Header and rows of the CSV file of estimates."""
    beside = covariances_beside(path)
    if os.path.isfile(beside):
        poses, _ = poses_in(path, (POSE,), "a timestamp and 7 are a pose, whose covariance is in "
                            + os.path.basename(beside))
        covariances = covariances_in(beside, poses, path)
    else:
        poses, places = poses_in(
            path, (OPEN_VINS,), "a timestamp, 7 of the pose and 12 of OpenVINS' covariance are "
            f"needed, or covariances in {os.path.basename(beside)}")
        covariances = [open_vins_covariance(*one) for one in zip(poses, places)]
    header = HEADER + "".join(f",cov_{i}_{j}" for i in range(6) for j in range(6))
    return header, [[*pose[:POSE], *P.ravel()] for pose, P in zip(poses, covariances)]


def truth_rows(path):
    """Header and rows of the CSV file of a truth. Numbers behind the pose are ignored."""
    poses, _ = poses_in(path, range(POSE, 1000), "a timestamp and 7 are a pose")
    if not poses:
        raise ConversionError(f"{path}: no rows (a truth of no time): write one row for each time")
    return HEADER, [pose[:POSE] for pose in poses]


def convert(arguments):
    rows_of = {"estimate": estimate_rows, "truth": truth_rows}[arguments.kind]
    for path in arguments.files:
        output = os.path.splitext(path)[0] + ".csv"
        if os.path.exists(output):
            raise ConversionError(f"{output}: exists (nothing is overwritten): remove it first")
        conversion.write_rows(output, *rows_of(path))
    print(f"{len(arguments.files)} files converted", file=sys.stderr)
    if arguments.kind == "estimate" and not all(map(os.path.isfile,
                                                    map(covariances_beside, arguments.files))):
        print("OpenVINS gives no covariance between position and rotation: it is taken as 0, so "
              "that the NEES varies more\nthan that of whole covariances. Judge it by --error "
              "world.", file=sys.stderr)


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("kind", choices=("estimate", "truth"))
    parser.add_argument("files", nargs="+", metavar="FILE.txt")
    conversion.run(convert, parser.parse_args())
