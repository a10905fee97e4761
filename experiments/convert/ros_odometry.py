#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts nav_msgs/Odometry (or geometry_msgs/TwistStamped) of ROS in a CSV file, from `rostopic
echo -p` or from a converter of bags, to the odometry.csv of a drive.

    rostopic echo -b drive.bag -p /odom > odom.csv
    python3 ros_odometry.py odom.csv -o drive

The columns are known by the header: the time (header.stamp, or else time), twist.linear.x and
twist.angular.z. The other files of the drive are yours to write. See
experiments/RECORDED_DRIVES.md.
"""
import os
import re

import conversion
import robot_log
from conversion import ConversionError, np
from estimate_layouts import time_words
from estimate_table import SECONDS_IN, Table, times_in

SIDEWAYS = 0.01  # [m/s] largest speed to the left that a differential drive may have


def column(table, name):
    """Index of the column of a component of the twist, such as "linear.x"."""
    found = [k for k, own in enumerate(table.names)
             if re.fullmatch(r"(?:twist\.)*" + re.escape(name), own)]
    if len(found) != 1:
        raise ConversionError(f"{table.header_place}: {len(found)} columns twist.{name} (odometry "
                              "has one, named as in nav_msgs/Odometry): write the header of "
                              "rostopic echo -p")
    return found[0]


def rows_of(path, unit):
    """The rows (time, forward, left, yaw rate) of a file."""
    table = Table(path)
    if not table.rows:
        raise ConversionError(f"{path}: no rows (a drive has odometry): take the whole file")
    times, notes = times_in(*time_words(table), unit)
    twist = table.numbers([column(table, name) for name in ("linear.x", "linear.y", "angular.z")])
    lines = [int(place.rpartition(":")[2]) for place in table.places]
    return robot_log.Rows(path, np.column_stack([np.array(times, dtype=float), twist]),
                          np.array(lines), notes)


def without_left(rows):
    """The rows (time, speed, yaw rate) of a vehicle that does not move sideways."""
    left = np.abs(rows.numbers[:, 2])
    k = np.argmax(left)
    if left[k] > SIDEWAYS:
        raise ConversionError(f"{rows.place(k)}: {left[k]:.3g} m/s to the side (a differential "
                              f"drive has none; up to {SIDEWAYS:g} m/s are ignored): say --vehicle "
                              "omnidirectional")
    if left[k] > 0:
        rows.notes.append(f"speeds of up to {left[k]:.3g} m/s to the side, ignored")
    return rows.numbers[:, [0, 1, 3]]


def convert(arguments):
    path = os.path.join(arguments.output, "odometry.csv")
    rows = robot_log.one_row_a_time(rows_of(arguments.file, arguments.time), arguments.sort_within)
    header, numbers = f"time_s,{robot_log.OMNIDIRECTIONAL}", rows.numbers
    if arguments.vehicle == "differential_drive":
        header, numbers = "time_s,speed_mps,yaw_rate_radps", without_left(rows)
    os.makedirs(arguments.output, exist_ok=True)
    try:
        conversion.write_rows(path, header, numbers)
    except FileExistsError:
        raise ConversionError(f"{path}: exists (nothing is overwritten): remove it, or name "
                              "another folder") from None
    robot_log.report(rows)
    print(f"{path}: times from {numbers[0, 0]:.3f} to {numbers[-1, 0]:.3f} s")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("file", metavar="FILE.csv", help="the odometry")
    parser.add_argument("--vehicle", choices=("differential_drive", "omnidirectional"),
                        default="differential_drive", help="default: %(default)s")
    parser.add_argument("--time", choices=tuple(SECONDS_IN), help="unit of the times")
    robot_log.add_options(parser)
    conversion.run(convert, parser.parse_args())
