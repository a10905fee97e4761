#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a recording of the UTIAS Multi-Robot Cooperative Localization and Mapping data set
(K. Leung, Y. Halpern, T. Barfoot and H. Liu, 2011) to one CSV log of montecarta for each robot.

    python3 mrclam.py FOLDER -o mrclam_logs

FOLDER holds Barcodes.dat, Landmark_Groundtruth.dat and, of each robot, RobotN_Odometry.dat,
RobotN_Measurement.dat and RobotN_Groundtruth.dat. The logs are mrclam_logs/robotN. Their reference
is the motion capture, and their landmarks are the surveyed ones. With --accuracy 0.003,0.01 it
states that its positions have errors of 3 mm and its headings of 0.01 rad, so that a study judges
the consistency of filters by it. Detections of other robots are left out and counted; detections of
an unknown barcode become false alarms. See experiments/RECORDED_DRIVES.md.
"""
import math
import os
import re

import conversion
import robot_log
from conversion import ConversionError, np
from robot_log import FALSE_ALARM, rows_in

ODOMETRY = ("time", "forward speed", "yaw rate")
MEASUREMENT = ("time", "barcode", "range", "bearing")
TRUTH = ("time", "x", "y", "heading")
LANDMARK = ("subject", "x", "y", "standard deviation of x", "standard deviation of y")
ROBOT = -2  # identity of a detection of another robot


def keyed(rows, what):
    """{first number: other numbers} of rows; raises ConversionError if a number comes twice."""
    found = {}
    for k, (key, *others) in enumerate(rows.numbers.tolist()):
        if key in found:
            raise ConversionError(f"{rows.place(k)}: {what} {key:g} twice (each has one line): "
                                  "leave one out")
        found[key] = others
    return found


def landmarks_in(folder):
    """The surveyed positions in the order of the subjects, and {barcode: identity}. Subjects
    without a position are robots."""
    survey = keyed(rows_in(robot_log.file_in(folder, "Landmark_Groundtruth.dat"), LANDMARK),
                   "subject")
    path = robot_log.file_in(folder, "Barcodes.dat")
    codes = rows_in(path, ("subject", "barcode"))
    identity = {subject: k for k, subject in enumerate(sorted(survey))}
    barcodes = keyed(codes, "subject")
    missing = sorted(identity.keys() - barcodes.keys())
    if missing:
        raise ConversionError(f"{path}: no barcode of subject {missing[0]:g} (a landmark of "
                              "Landmark_Groundtruth.dat): take all files of one recording")
    swapped = robot_log.Rows(path, codes.numbers[:, ::-1], codes.lines)
    return ([survey[subject][:2] for subject in identity],
            {barcode: identity.get(subject, ROBOT) for barcode, (subject,) in
             keyed(swapped, "barcode").items()})


def detections_in(path, barcodes, within):
    """The detections of landmarks as rows (time, identity, range, bearing)."""
    rows = robot_log.without_equal(robot_log.in_order(rows_in(path, MEASUREMENT), within))
    robot_log.check_ranges(rows, 2)
    identities = np.array([barcodes.get(code, FALSE_ALARM) for code in rows.numbers[:, 1]])
    rows.numbers[:, 1] = identities
    unknown = np.count_nonzero(identities == FALSE_ALARM)
    rows = rows.taken(identities != ROBOT, "of other robots, left out")
    rows.notes += [f"{unknown} of unknown barcodes, kept as false alarms"] * (unknown > 0)
    return robot_log.first_of_each_landmark(rows)


def drive_of(folder, robot, barcodes, within):
    """The odometry, the detections and the true path of a robot, from its first true pose after
    the first odometry on."""
    def path(kind):
        return robot_log.file_in(folder, f"Robot{robot}_{kind}.dat")

    odometry = robot_log.one_row_a_time(rows_in(path("Odometry"), ODOMETRY), within)
    truth = robot_log.one_row_a_time(rows_in(path("Groundtruth"), TRUTH), within)
    detections = detections_in(path("Measurement"), barcodes, within)
    first, last = odometry.numbers[[0, -1], 0]
    truth = robot_log.between(truth, first, last, "the odometry")
    if not len(truth.numbers):
        raise ConversionError(f"{truth.path}: no pose during the odometry (a drive begins at a "
                              "known pose): take all files of one recording")
    detections = robot_log.between(detections, truth.numbers[0, 0], last,
                                   "the drive, which begins at the first pose")
    if not len(detections.numbers):
        raise ConversionError(f"{detections.path}: no detection of a landmark during the drive (a "
                              "filter needs some): take all files of one recording")
    return odometry, detections, truth


def robots_in(folder):
    """The numbers of the robots that have odometry."""
    names = os.listdir(folder) if os.path.isdir(folder) else []
    found = filter(None, (re.fullmatch(r"Robot(\d+)_Odometry\.dat", name) for name in names))
    robots = sorted(int(name[1]) for name in found)
    if not robots:
        raise ConversionError(f"{folder}: no file Robot1_Odometry.dat (each robot has one): name "
                              "the folder of one recording")
    return robots


def deviations(text):
    """(x, y, heading) standard deviations by the text METRES,RADIANS of an argument."""
    position, heading = (float(number) for number in text.split(","))
    if not (0 < position < math.inf and 0 < heading < math.inf):
        raise ValueError
    return position, position, heading


def convert(arguments):
    landmarks, barcodes = landmarks_in(arguments.folder)
    drives = {os.path.join(arguments.output, f"robot{robot}"):
              drive_of(arguments.folder, robot, barcodes, arguments.sort_within)
              for robot in robots_in(arguments.folder)}
    for folder in drives:
        conversion.check_new(folder)
    for folder, (odometry, detections, truth) in drives.items():
        stated = np.tile(arguments.accuracy or (), (len(truth.numbers), 1))
        conversion.write_log(folder, truth.numbers[0], odometry.numbers,
                             robot_log.scans_of(detections),
                             {"motion_capture": np.hstack((truth.numbers, stated))},
                             landmarks, "speed_mps,yaw_rate_radps",
                             "range_m,bearing_rad,identity")
        robot_log.report(odometry, detections, truth)
    print(f"{len(drives)} drives with {len(landmarks)} landmarks, such as {next(iter(drives))}")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("folder", help="folder of one recording")
    parser.add_argument("--accuracy", metavar="METRES,RADIANS", type=deviations,
                        help="standard deviations of the positions and headings of the motion "
                        "capture, such as 0.003,0.01")
    robot_log.add_options(parser)
    conversion.run(convert, parser.parse_args())
