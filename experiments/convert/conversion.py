# SPDX-License-Identifier: BSD-3-Clause
"""Functions that the scripts of this folder share: they read foreign files and write the CSV files
that montecarta reads (experiments/RECORDED_DRIVES.md). Needs NumPy and SciPy (.ci/packages.txt,
group `convert`).
"""
import argparse
import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from decimal import Decimal

try:
    import numpy as np
    import scipy.io
except ImportError as missing:
    sys.exit(f"{os.path.basename(sys.argv[0])}: {missing.name} is missing in this Python (these "
             "scripts compute with NumPy and SciPy): install both, on Debian with 'apt-get install "
             "python3-scipy', for /usr/bin/python3")

LASER_BEAMS = 361  # per sweep, half a degree apart: beam 0 right, 180 ahead, 360 left
ROUNDING = 0.0006  # [s] tolerance: the list of all records has times in whole milliseconds
SENSORS = ("GPS", "odometry", "laser")


class ConversionError(Exception):
    """A file is missing, damaged or unexpected. The text is "file: problem (why): remedy"."""


def number_text(value):
    """The shortest text of a number that reads back as the same bits, with an exponent only if that
    makes it shorter: "0.1", "-0", "12", "1e-05"."""
    text = repr(float(value)).removesuffix(".0")
    if "e" not in text and (1e-3 <= abs(value) < 1e5 or value == 0.0):
        return text
    number = Decimal(text)
    sign, digits, exponent = number.as_tuple()
    mantissa = "".join(map(str, digits)).rstrip("0")
    exponent += len(digits) - 1
    point = "." if len(mantissa) > 1 else ""
    scientific = (f"{'-' * sign}{mantissa[0]}{point}{mantissa[1:]}"
                  f"e{'-' if exponent < 0 else '+'}{abs(exponent):02d}")
    return min(format(number, "f"), scientific, key=len)


def finite_number(word):
    """The finite number in a word; None if it is not one."""
    try:
        value = float(word)
    except ValueError:
        return None
    return value if abs(value) < float("inf") and "_" not in word else None


def text_of(path):
    """The whole text of a file."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read()
    except OSError as error:
        raise ConversionError(f"{path}: cannot be opened ({error.strerror}): check the path and "
                              "its permissions") from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise ConversionError(f"{path}:{line}: a NUL byte (this is no text, or it is damaged): "
                              "take the whole file as it was recorded")
    return text


def numbers_in(path, width, record_is_line=True):
    """The records of a text file of numbers separated by white space, {record, width}. A record is
    a line if `record_is_line`, otherwise the next `width` numbers, independent of line breaks."""
    text = text_of(path)
    words = text.split()
    if words and not text[-1].isspace():
        raise ConversionError(
            f"{path}: record {(len(words) - 1) // width + 1}: '{words[-1][:40]}' ends with the "
            "file (it may have been cut short within the number): take the whole file as published")
    lines = [line.split() for line in text.splitlines()] if record_is_line else [words]
    record = 0
    for line in filter(None, lines):
        for k, word in enumerate(line):
            if finite_number(word) is None:
                raise ConversionError(
                    f"{path}: record {record + k // width + 1}: '{word[:40]}' is no finite number "
                    "(only numbers stand here): take the file as published")
        if len(line) % width or (record_is_line and len(line) != width):
            found = len(line) if record_is_line else len(line) % width
            raise ConversionError(
                f"{path}: record {record + len(line) // width * (not record_is_line) + 1}: "
                f"{found} of {width} numbers (some are missing, or left over): take the whole "
                "file as published")
        record += len(line) // width
    return np.array(words, dtype=float).reshape(-1, width)


def loaded_elsewhere(path):
    """What SciPy reads of a MATLAB file, read by another process: by some damage SciPy ends it."""
    try:
        with ProcessPoolExecutor(1, multiprocessing.get_context("fork")) as other:
            return other.submit(scipy.io.loadmat, path, appendmat=False).result()
    except BrokenProcessPool:
        raise ConversionError(f"{path}: is damaged (reading it ends the program that reads it): "
                              "take the file as published, or save it again") from None


class MatFile:
    """The variables of a MATLAB file up to version 7."""

    def __init__(self, path):
        self.path = path
        try:
            self.variables = loaded_elsewhere(path)
        except ConversionError:
            raise
        except Exception as fault:  # SciPy raises various errors for a damaged file
            if isinstance(fault, OSError) and fault.errno:
                raise ConversionError(f"{path}: cannot be opened ({fault.strerror}): check the "
                                      "path and its permissions") from None
            raise ConversionError(
                f"{path}: is damaged or no MATLAB file up to version 7 ({fault}): take the file "
                "as published, or save it with -v7") from None

    def matrix(self, name):
        """A real matrix of numbers, as doubles."""
        values = self.variables.get(name)
        if not isinstance(values, np.ndarray) or values.ndim != 2 or values.dtype.kind not in "iuf":
            known = ", ".join(key for key in self.variables if not key.startswith("__"))
            raise ConversionError(f"{self.path}: no variable '{name}' (a real matrix of numbers; "
                                  f"there are: {known[:200]}): save it under that name")
        return values.astype(float)

    def series(self, name, count=None):
        """A matrix of one row or one column as a vector. Checks its length if `count` is given."""
        values = self.matrix(name)
        if 1 not in values.shape:
            raise ConversionError(f"{self.path}: '{name}' is {values.shape[0]} x {values.shape[1]} "
                                  "(one row or one column is needed): save it so")
        if count is not None and values.size != count:
            raise ConversionError(f"{self.path}: '{name}' has {values.size} records of {count} (as "
                                  "many as times are needed): take the file as published")
        if not np.all(np.isfinite(values)):
            raise ConversionError(
                f"{self.path}: '{name}': record {np.argmin(np.isfinite(values.ravel())) + 1} is no "
                "finite number (only numbers stand here): take the file as published")
        return values.ravel()

    def sweeps(self, name, count):
        """The matrix `name` as {scan, beam}, with one row for each of `count` scans."""
        values = self.matrix(name)
        if values.shape != (count, LASER_BEAMS):
            raise ConversionError(
                f"{self.path}: '{name}' is {values.shape[0]} x {values.shape[1]} (each of {count} "
                f"scans has {LASER_BEAMS} beams): take the file as published")
        return values


def check_times(times, path):
    """Raises ConversionError if there are no records or times do not increase."""
    if len(times) == 0:
        raise ConversionError(f"{path}: no records (it is empty): take the file as published")
    wrong = np.flatnonzero(~(np.diff(times) > 0))
    if wrong.size:
        k = int(wrong[0])
        raise ConversionError(
            f"{path}: record {k + 2}: time {number_text(times[k + 1])} s comes after "
            f"{number_text(times[k])} s (times must increase): take the file as published")


def check_sweeps(sweeps, path):
    """Raises ConversionError if a range is negative or not a number."""
    wrong = np.argwhere(~(sweeps >= 0))
    if wrong.size:
        scan, beam = wrong[0]
        raise ConversionError(
            f"{path}: record {scan + 1}: {sweeps[scan, beam]:g} of beam {beam} (a beam "
            "measures 0 or more; 80 m or more where nothing came back): take the file as published")


def check_events(events, times, path):
    """Checks that `events` {record, (time, sensor, index)} lists every record of the sensors 1, 2
    and 3 once and in order. `times` holds the times of each sensor, or None if it was not read.
    This finds missing records in files that look complete by themselves."""
    def refuse(fault):
        raise ConversionError(f"{path}: {fault} (the list and the sensors' files must be of one "
                              "drive): take all files as published")

    seen = [0, 0, 0]
    for k, (time, number, index) in enumerate(events):
        if number not in (1, 2, 3):
            refuse(f"record {k + 1}: sensor {number_text(number)} is none of 1, 2, 3")
        sensor = int(number) - 1
        expected, own = seen[sensor], times[sensor]
        if own is None:
            continue
        if (index != expected + 1 or expected >= len(own)
                or not abs(own[expected] - time) <= ROUNDING):
            refuse(f"record {k + 1} ({SENSORS[sensor]}): record {number_text(index)} at "
                   f"{number_text(time)} s is not the next of that sensor's {len(own)}")
        seen[sensor] += 1
    for sensor, own in enumerate(times):
        if own is not None and seen[sensor] != len(own):
            refuse(f"{seen[sensor]} of {len(own)} records of {SENSORS[sensor]} are listed")


def write_rows(path, header, rows):
    """Writes a CSV file: the header, then rows, which are sequences of numbers or ready texts. None
    is an empty field."""
    with open(path, "x", encoding="utf-8") as file:
        file.write(header + "\n")
        for row in rows:
            file.write((row if isinstance(row, str) else
                        ",".join("" if one is None else number_text(one) for one in row)) + "\n")


def check_new(folder):
    """Raises ConversionError if a log cannot be written to the folder."""
    if os.path.isdir(folder) and os.listdir(folder):
        raise ConversionError(f"{folder}: not empty (other files would be read with the log): "
                              "name a new folder")


def write_log(folder, start, odometry, scans, references, landmarks=(),
              controls="speed_mps,steer_rad", components="range_m,bearing_rad"):
    """Writes a drive as the CSV log of experiments/RECORDED_DRIVES.md into a new or empty folder.
    `start` is (time, x, y, heading), `odometry` has rows (time, *controls), `scans` are (time,
    [detection, ...]), a detection has the components, `references` {name: rows (time, x, y) or
    (time, x, y, heading), or the latter with their standard deviations}; seconds, metres,
    radians."""
    check_new(folder)
    os.makedirs(folder, exist_ok=True)
    write_rows(os.path.join(folder, "start.csv"), "time_s,x_m,y_m,heading_rad", [start])
    write_rows(os.path.join(folder, "odometry.csv"), f"time_s,{controls}", odometry)
    detections = []
    for time, seen in scans:
        nothing = number_text(time) + "," * len(components.split(","))
        detections += [(time, *one) for one in seen] or [nothing]
    write_rows(os.path.join(folder, "detections.csv"), f"time_s,{components}", detections)
    for name, fixes in references.items():
        columns = ("time_s,x_m,y_m", ",heading_rad", ",sigma_x_m,sigma_y_m,sigma_heading_rad")
        header = "".join(columns[:{3: 1, 4: 2, 7: 3}[len(fixes[0])]])
        write_rows(os.path.join(folder, f"reference_{name}.csv"), header, fixes)
    if len(landmarks):
        write_rows(os.path.join(folder, "landmarks.csv"), "x_m,y_m", landmarks)


def parser_of(text):
    """The parser of a script's arguments; `text` is the script's docstring."""
    return argparse.ArgumentParser(description=text,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)


def run(convert, arguments):
    """Calls convert(arguments). A ConversionError or an error of the disk ends the script with its
    text and exit code 2."""
    try:
        convert(arguments)
    except (ConversionError, OSError) as error:
        print(f"{os.path.basename(sys.argv[0])}: {error}", file=sys.stderr)
        sys.exit(2)
