#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts the drive around a car park with reflecting poles (E. Nebot and J. Guivant, ACFR) from
its published files to the CSV log of montecarta. Poles are detected in the sweeps of the laser.

    python3 car_park.py FOLDER -o car_park_log

FOLDER holds data_set.mat and optionally beac_juan3.mat, the surveyed poles. See
experiments/RECORDED_DRIVES.md.
"""
import math
import os

import conversion
from conversion import MatFile, np

START_HEADING = -125.5 * math.pi / 180.0
NO_RETURN = 80.0                   # [m] range of a beam without echo, or more
ANGLE_GAP = 3.5 * math.pi / 360    # [rad] between echoes of one pole: 3 beams
RANGE_STEP = 1.0                   # [m] between echoes of one pole
POLE_RADIUS = 0.03                 # [m] from its surface to its centre


def detect_reflectors(ranges, intensities):
    """(range, bearing) of the poles in one sweep {beam}, in order of increasing bearing, by the
    steps of [reflectors] in experiments/RECORDED_DRIVES.md."""
    beams = np.flatnonzero((intensities > 0) & (ranges < NO_RETURN))
    angle, distance = beams * math.pi / 360.0, ranges[beams]
    cut = (np.diff(angle) >= ANGLE_GAP) | (np.abs(np.diff(distance)) > RANGE_STEP)
    poles = []
    for group in np.split(np.arange(beams.size), np.flatnonzero(cut) + 1):
        if group.size == 0:
            continue
        angle_sum = range_sum = 0.0
        for k in group:  # np.sum would add in another order
            angle_sum += float(angle[k])
            range_sum += float(distance[k])
        poles.append((range_sum / group.size + POLE_RADIUS,
                      angle_sum / group.size - math.pi / 2))
    return poles


def poles_in(path):
    """The surveyed poles as {pole, (East, North)}."""
    poles = MatFile(path).matrix("estbeac")
    if poles.shape[1] != 2 or not np.all(np.isfinite(poles)):
        raise conversion.ConversionError(
            f"{path}: 'estbeac' is {poles.shape[0]} x {poles.shape[1]}, or a number of it is not "
            "finite (a pole has East and North): take the file as published")
    return poles


def convert(arguments):
    path = os.path.join(arguments.folder, "data_set.mat")
    file = MatFile(path)
    wheel, laser, gps = (file.series(name) for name in ("Time_VS", "TimeLaser", "TimeGPS"))
    for times in (wheel, laser, gps):
        conversion.check_times(times, path)
    odometry = np.column_stack([wheel, file.series("Velocity", wheel.size),
                                file.series("Steering", wheel.size)])
    ranges = file.sweeps("Laser", laser.size)
    intensities = file.sweeps("Intensity", laser.size)
    conversion.check_sweeps(ranges, f"{path}: 'Laser'")
    conversion.check_sweeps(intensities, f"{path}: 'Intensity'")
    fixes = np.column_stack([gps, file.series("GPSLon", gps.size), file.series("GPSLat", gps.size)])
    events = file.series("Time")
    events = np.column_stack([events, file.series("Sensor", events.size),
                              file.series("Index", events.size)])
    conversion.check_events(events.tolist(), [gps, wheel, laser], path)
    survey = os.path.join(arguments.folder, "beac_juan3.mat")
    landmarks = poles_in(survey) if os.path.exists(survey) else ()
    scans = [(time, detect_reflectors(sweep, intensity))
             for time, sweep, intensity in zip(laser, ranges, intensities)]
    conversion.write_log(arguments.output, (*fixes[0], START_HEADING), odometry, scans,
                         {"gps": fixes}, landmarks)
    print(f"{len(odometry)} odometry records, {len(scans)} scans, "
          f"{sum(len(seen) for _, seen in scans)} poles: {arguments.output}")


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("folder", help="folder of the published files")
    parser.add_argument("-o", "--output", required=True, help="the log's folder, new or empty")
    conversion.run(convert, parser.parse_args())
