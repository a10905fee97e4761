#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the drive through Victoria Park (Sydney; E. Nebot and J. Guivant, ACFR) from its
published files to the CSV log of montecarta. Trees are detected in the sweeps of the laser.

    python3 victoria_park.py FOLDER -o victoria_park_log
    python3 victoria_park.py FOLDER -o victoria_park_raw_log --steering raw

FOLDER holds DRS.txt (calibrated steering) or aa3_dr.mat (raw steering), LASER.txt or aa3_lsr2.mat,
and one or both of GPS.txt (reference gps) and aa3_gpsx.mat (reference gps_all). If it also holds
Sensors_manager.txt, the text files must agree with that. See experiments/RECORDED_DRIVES.md.
"""
import math
import os

import conversion
from conversion import MatFile, np

START_HEADING = 35.5 * math.pi / 180.0
MAT_CLOCK_AHEAD = 20967.0  # [ms] of the .mat release's times relative to those of the text release
RANGE_BITS = 0x1fff        # range of a stored echo [cm]; the bits above are its intensity

# Parameters of the tree detector, with lengths [m] and angles [rad]. Echoes lie at whole beams, so
# many differences of angles equal a limit up to rounding. Both sides are therefore computed as in
# the published code; otherwise 53,537 trees are detected instead of 52,792.
FARTHEST_ECHO = 75.0
RANGE_STEP = 1.5                     # a larger one separates segments
ANGLE_STEP = 10 * math.pi / 360      # a larger one separates segments
CLEARANCE = 3.0                      # segments closer than this are part of a bush or wall
NEIGHBOURS = 3                       # number of segments on each side that need the clearance
OCCLUSION_GAP = 2 * math.pi / 360    # of closer segments, one hides a part of the other
HALF_DEGREE = math.pi / 360          # edges of a trunk lie between beams
LONGEST_CHORD = 1.0                  # largest chord of a trunk
NEAREST_START = 1.0                  # closer echoes are from the vehicle itself
FIRST_ANGLE = 5 * math.pi / 306      # a trunk lies completely after this angle
LAST_ANGLE = math.pi - FIRST_ANGLE   # and before this one

# Counted counter-clockwise from the right. NumPy's sine may differ from the C library's in the last
# bit.
ANGLES = [beam * math.pi / 360.0 for beam in range(conversion.LASER_BEAMS)]
ANGLE = np.array(ANGLES)
COSINE = np.array([math.cos(angle) for angle in ANGLES])
SINE = np.array([math.sin(angle) for angle in ANGLES])


def detect_trees(ranges):
    """(range, bearing) of the trunks in one sweep of ranges {beam}, in order of increasing bearing.
    This is J. Guivant's detector, which all codes use on these data; experiments/RECORDED_DRIVES.md
    lists its steps under [trees]."""
    beams = np.flatnonzero(ranges < FARTHEST_ECHO)                                     # step 1
    if beams.size == 0:
        return []
    angle, distance = ANGLE[beams], ranges[beams]
    cut = (np.abs(np.diff(distance)) > RANGE_STEP) | (np.diff(angle) > ANGLE_STEP)     # step 2
    after = np.flatnonzero(cut) + 1
    first, last = np.r_[0, after], np.r_[after, beams.size] - 1
    steps = last - first
    middle = (distance[first + steps // 2] + distance[first + (steps + 1) // 2]) / 2
    x, y = distance * COSINE[beams], distance * SINE[beams]

    def gap(a, b):
        dx, dy = x[b] - x[a], y[b] - y[a]
        return np.sqrt(dx * dx + dy * dy)

    kept = np.full(first.size, True)
    for apart in range(1, NEIGHBOURS + 1):                                             # step 3
        near = np.flatnonzero(gap(last[:-apart], first[apart:]) < CLEARANCE)
        kept[near] = kept[near + apart] = False
    side_by_side = np.flatnonzero(angle[first[1:]] - angle[last[:-1]] < OCCLUSION_GAP)  # step 4
    left_is_farther = distance[first[side_by_side + 1]] > distance[last[side_by_side]]
    kept[side_by_side + left_is_farther] = False
    start, end = angle[first], angle[last]
    start_range, end_range = distance[first], distance[last]
    diameter = (end + HALF_DEGREE - start) * (start_range + end_range) / 2             # step 6
    kept &= (gap(first, last) < LONGEST_CHORD) & (start_range > NEAREST_START)         # step 5
    kept &= (start > FIRST_ANGLE) & (end < LAST_ANGLE)
    kept &= np.abs(start_range - end_range) < diameter / 3                             # step 7
    to_centre = middle + diameter / 2                                                  # step 8
    bearing = (start + end) / 2 - math.pi / 2
    return list(zip(to_centre[kept].tolist(), bearing[kept].tolist()))


def text_times(milliseconds):
    """Converts times of the .mat release to those of the text release [s]."""
    return (milliseconds - MAT_CLOCK_AHEAD) / 1000.0


def odometry_in(folder, steering):
    """The odometry as rows (time, speed, steer)."""
    if steering == "calibrated":
        path = os.path.join(folder, "DRS.txt")
        rows = conversion.numbers_in(path, 3)
    else:
        path = os.path.join(folder, "aa3_dr.mat")
        file = MatFile(path)
        times = text_times(file.series("time"))
        rows = np.column_stack([times, file.series("speed", times.size),
                                file.series("steering", times.size)])
    conversion.check_times(rows[:, 0], path)
    return rows


def sweeps_in(folder):
    """Times, ranges {scan, beam}, and whether they are from the text release."""
    text, mat = os.path.join(folder, "LASER.txt"), os.path.join(folder, "aa3_lsr2.mat")
    is_text = os.path.exists(text) or not os.path.exists(mat)
    if is_text:
        path = text
        rows = conversion.numbers_in(path, 1 + conversion.LASER_BEAMS, record_is_line=False)
        times, ranges = rows[:, 0], rows[:, 1:]
    else:
        path = mat
        file = MatFile(path)
        times = text_times(file.series("TLsr"))
        echoes = file.sweeps("LASER", times.size)
        if not np.all((echoes >= 0) & (echoes <= 0xffff) & (echoes == np.floor(echoes))):
            raise conversion.ConversionError(
                f"{path}: an echo is no whole number of 16 bits (range and intensity in one): take "
                "the file as published")
        ranges = (echoes.astype(int) & RANGE_BITS) / 100.0
    conversion.check_times(times, path)
    conversion.check_sweeps(ranges, path)
    return times, ranges, is_text


def references_in(folder):
    """The references as {name: rows (time, East, North)}, GPS.txt first."""
    text, mat = os.path.join(folder, "GPS.txt"), os.path.join(folder, "aa3_gpsx.mat")
    references = {}
    if os.path.exists(text) or not os.path.exists(mat):
        references["gps"] = conversion.numbers_in(text, 3)[:, [0, 2, 1]]
        conversion.check_times(references["gps"][:, 0], text)
    if os.path.exists(mat):
        file = MatFile(mat)
        times = text_times(file.series("timeGps"))
        east, north = file.series("Lo_m", times.size), file.series("La_m", times.size)
        conversion.check_times(times, mat)
        # The fixes of the .mat release have another origin.
        references["gps_all"] = np.column_stack([times, east - east[0], north - north[0]])
    return references


def convert(arguments):
    folder = arguments.folder
    odometry = odometry_in(folder, arguments.steering)
    scan_times, ranges, is_text = sweeps_in(folder)
    references = references_in(folder)
    manager = os.path.join(folder, "Sensors_manager.txt")
    if os.path.exists(manager):  # it lists records of text files only
        times = [references["gps"][:, 0] if "gps" in references else None,
                 odometry[:, 0] if arguments.steering == "calibrated" else None,
                 scan_times if is_text else None]
        conversion.check_events(conversion.numbers_in(manager, 3).tolist(), times, manager)
    scans = [(time, detect_trees(sweep)) for time, sweep in zip(scan_times, ranges)]
    start = (*next(iter(references.values()))[0], START_HEADING)
    conversion.write_log(arguments.output, start, odometry, scans, references)
    print(f"{len(odometry)} odometry records, {len(scans)} scans, "
          f"{sum(len(seen) for _, seen in scans)} trees: {arguments.output}")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("folder", help="folder of the published files")
    parser.add_argument("-o", "--output", required=True, help="the log's folder, new or empty")
    parser.add_argument("--steering", choices=("calibrated", "raw"), default="calibrated",
                        help="calibrated, from DRS.txt (default), or raw, from aa3_dr.mat")
    conversion.run(convert, parser.parse_args())
