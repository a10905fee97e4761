#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a range-only recording with ranging radios and GPS (J. Djugash, B. Hamner and S. Roth,
2009; known as Plaza1 and Plaza2) to the CSV log of montecarta.

    python3 plaza.py Plaza1_.mat -o plaza1_log

The file holds GT (time, x, y, heading: the path by GPS), DR (time, distance, turn: the motion since
the row before), TD (time, antenna, node, range) and TL (node, x, y: the surveyed nodes). See
experiments/RECORDED_DRIVES.md.
"""
import dataclasses
import math

import conversion
import robot_log
from conversion import ConversionError, MatFile, np

COLUMNS = {"GT": ("time", "x", "y", "heading"), "DR": ("time", "distance", "turn"),
           "TD": ("time", "antenna", "node", "range"), "TL": ("node", "x", "y")}

LARGEST_NUMBER = 1e9  # of a node or an antenna


def rows_of(file, name):
    """The rows of a matrix of the file."""
    values, columns = file.matrix(name), COLUMNS[name]
    if values.shape[1] != len(columns) or len(values) == 0:
        raise ConversionError(f"{file.path}: '{name}' is {values.shape[0]} x {values.shape[1]} "
                              f"(its columns are {', '.join(columns)}): take the file as "
                              "published")
    wrong = np.argwhere(~np.isfinite(values))
    if wrong.size:
        raise ConversionError(f"{file.path}: '{name}': record {wrong[0][0] + 1} is no finite "
                              f"number (the {columns[wrong[0][1]]}): take the file as published")
    return robot_log.Rows(f"{file.path}: '{name}'", values, np.arange(1, len(values) + 1),
                          separator=": record ")


def whole(rows, column):
    """A column of whole numbers."""
    values = rows.numbers[:, column]
    wrong = np.flatnonzero((values != np.floor(values)) | (np.abs(values) > LARGEST_NUMBER))
    if wrong.size:
        raise ConversionError(f"{rows.place(wrong[0])}: {conversion.number_text(values[wrong[0]])} "
                              "is no number of a node (a whole number): take the file as "
                              "published")
    return values.astype(int).tolist()


def nodes_of(rows):
    """{node: (x, y)} of the surveyed nodes."""
    nodes = {}
    for k, node in enumerate(whole(rows, 0)):
        if node in nodes:
            raise ConversionError(f"{rows.place(k)}: node {node} twice (each has one row): leave "
                                  "one out")
        nodes[node] = rows.numbers[k, 1:].tolist()
    return nodes


def motions_of(rows, within):
    """The motions in order. Different motions that end at the same time are added."""
    rows = robot_log.without_equal(robot_log.in_order(rows, within))
    times = rows.numbers[:, 0]
    first = np.flatnonzero(np.append(True, times[1:] != times[:-1]))
    sums = np.add.reduceat(rows.numbers[:, 1:], first)
    rows = rows.taken(first, "added to another of the same time")
    return dataclasses.replace(rows, numbers=np.column_stack([rows.numbers[:, 0], sums]))


def odometry_of(motions, start):
    """The odometry, rows (time, speed, yaw rate), from the time `start` on, and the motions that
    are used. A motion lasts from the end of the one before, the first from the start."""
    times = motions.numbers[:, 0]
    begins = np.append(start, times[:-1])
    used = times > start
    if not used.any():
        raise ConversionError(f"{motions.path}: no motion after the first pose at {start:g} s (a "
                              "drive begins there): take the file as published")
    rates = motions.numbers[used, 1:] / (times - begins)[used, None]
    rows = np.column_stack([begins[used], rates])
    return (np.vstack([rows, [times[-1], 0.0, 0.0]]),
            motions.taken(used, "that end before the first pose, left out"))


def with_headings_of_travel(path, distance):
    """The path with headings turned by pi if they point against its direction of travel. `distance`
    [m] is that of all motions; it is positive if the vehicle drives forward."""
    poses = path.numbers
    moved = np.diff(poses[:, 1:3], axis=0)
    forward = (moved[:, 0] * np.cos(poses[:-1, 3]) + moved[:, 1] * np.sin(poses[:-1, 3])).sum()
    if forward * distance >= 0:
        return path
    turned = poses.copy()
    turned[:, 3] = [math.remainder(heading + math.pi, 2 * math.pi) for heading in poses[:, 3]]
    return dataclasses.replace(path, numbers=turned, notes=path.notes + [
        "all headings point against the direction of travel and are turned by pi"])


def convert(arguments):
    file, within = MatFile(arguments.file), arguments.sort_within
    path = robot_log.one_row_a_time(rows_of(file, "GT"), within)
    motions = motions_of(rows_of(file, "DR"), within)
    ranges = rows_of(file, "TD")
    robot_log.check_ranges(ranges, 3)
    antennas = set(whole(ranges, 1))
    nodes = nodes_of(rows_of(file, "TL"))
    odometry, motions = odometry_of(motions, path.numbers[0, 0])
    path = with_headings_of_travel(path, motions.numbers[:, 1].sum())
    found = list(zip(ranges.lines, ranges.numbers[:, 0], whole(ranges, 2), ranges.numbers[:, 3:]))
    detections, landmarks = robot_log.detections_of(ranges.path, found, nodes, "'TL'", within,
                                                    ranges.separator)
    first, last = path.numbers[0, 0], odometry[-1, 0]
    path = robot_log.between(path, first, last, "the drive")
    detections = robot_log.between(detections, first, last, "the drive")
    if not len(detections.numbers):
        raise ConversionError(f"{ranges.path}: no range during the drive (a filter needs some): "
                              "take the file as published")
    conversion.write_log(arguments.output, path.numbers[0], odometry,
                         robot_log.scans_of(detections), {"gps": path.numbers}, landmarks,
                         "speed_mps,yaw_rate_radps", "range_m,identity")
    robot_log.report(path, motions, detections)
    print(f"{len(landmarks)} nodes, ranges of {len(antennas)} antenna(s), taken as at the pose: "
          f"{arguments.output}")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("file", metavar="FILE.mat", help="the recording")
    robot_log.add_options(parser)
    conversion.run(convert, parser.parse_args())
