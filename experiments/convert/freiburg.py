#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the log of the course on robot mapping (C. Stachniss, University of Freiburg) to the CSV
log of montecarta.

    python3 freiburg.py sensor_data.dat --world world.dat -o course_log

The log has a line `ODOMETRY rot1 trans rot2` for each motion and then a line `SENSOR id range
bearing` for each landmark that is seen after it. world.dat, which may be left out, has a line `id x
y` for each landmark. There are no times, so that every motion takes 1 s, and no true path, so that
there is no reference. See experiments/RECORDED_DRIVES.md.
"""
import math

import conversion
import robot_log
from conversion import ConversionError

MOTION = ("first rotation", "translation", "second rotation")
DETECTION = ("range", "bearing")
NOISE = {"vehicle": "omnidirectional",  # the variances of the exercises are 0.1, 0.01
         "sigma_forward": math.sqrt(0.1), "sigma_left": math.sqrt(0.1),
         "sigma_yaw_rate_deg": math.degrees(math.sqrt(0.01)),
         "sigma_range": math.sqrt(0.01), "sigma_bearing_deg": math.degrees(math.sqrt(0.01))}


def motions_and_detections(path):
    """The motions [(rot1, trans, rot2), ...] and the detections [(line, time, id, (range,
    bearing)), ...]."""
    motions, detections = [], []
    for line, (tag, *words) in robot_log.lines_of(path):
        place = f"{path}:{line}"
        if tag == "ODOMETRY":
            motions.append(robot_log.numbers_of(words, MOTION, place))
        elif tag == "SENSOR":
            landmark = robot_log.whole_number(words[0] if words else "", "landmark", place)
            detections.append((line, len(motions), landmark,
                               robot_log.numbers_of(words[1:], DETECTION, place)))
        else:
            raise ConversionError(f"{place}: '{tag[:40]}' is no tag of this log (ODOMETRY and "
                                  "SENSOR are): leave out the line")
    for found, tag in ((motions, "ODOMETRY"), (detections, "SENSOR")):
        if not found:
            raise ConversionError(f"{path}: no line {tag} (a drive has motions and detections): "
                                  "take the whole log")
    return motions, detections


def world_in(path):
    """{id: (x, y)} of the landmarks."""
    world = {}
    for line, (word, *words) in robot_log.lines_of(path):
        landmark = robot_log.whole_number(word, "landmark", f"{path}:{line}")
        if landmark in world:
            raise ConversionError(f"{path}:{line}: landmark {landmark} twice (each has one line): "
                                  "leave one out")
        world[landmark] = robot_log.numbers_of(words, ("x", "y"), f"{path}:{line}")
    return world


def convert(arguments):
    motions, found = motions_and_detections(arguments.log)
    world = world_in(arguments.world) if arguments.world else {}
    detections, landmarks = robot_log.detections_of(arguments.log, found, world, arguments.world)
    robot_log.check_ranges(detections, 2)
    steps = [(trans * math.cos(rot1), trans * math.sin(rot1), rot1 + rot2)
             for rot1, trans, rot2 in motions]
    conversion.write_log(arguments.output, (0, 0, 0, 0), robot_log.odometry_of(steps),
                         robot_log.scans_of(detections), {}, landmarks,
                         robot_log.OMNIDIRECTIONAL, "range_m,bearing_rad,identity")
    robot_log.report(detections)
    print(f"{len(motions)} motions of 1 s each, since the log has no times, from the origin: "
          f"{arguments.output}")
    robot_log.suggest(NOISE, "the noise of the exercises on the EKF")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("log", help="file with the lines ODOMETRY and SENSOR")
    parser.add_argument("--world", metavar="FILE", help="file with the positions of the landmarks")
    robot_log.add_options(parser, is_sorted=False)
    conversion.run(convert, parser.parse_args())
