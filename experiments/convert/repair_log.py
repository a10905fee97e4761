#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Repairs a CSV log that montecarta refuses, by the rules of experiments/RECORDED_DRIVES.md: rows
that are slightly out of order, several rows of odometry or of a reference at one time, several
detections of one landmark in one scan, rows before the start or after the last odometry.

    python3 repair_log.py drive -o repaired

Prints how many rows of each file were repaired. Rows that are used keep their text.
"""
import dataclasses
import functools
import glob
import os

import conversion
import robot_log
from conversion import ConversionError, np

TIME = "time_s"


@dataclasses.dataclass
class Table:
    """A file of a log."""
    name: str
    header: str
    rows: robot_log.Rows  # of detections: time, identity, components; else all columns
    texts: dict           # {line: text of the row}

    def repaired(self, *repairs):
        """The table with rows to which `repairs` were applied, one after the other."""
        rows = self.rows
        for repair in repairs:
            rows = repair(rows)
        return dataclasses.replace(self, rows=rows)


def lines_in(path):
    """(number of the line, its text) of every line that is neither blank nor a comment."""
    lines = conversion.text_of(path).splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        raise ConversionError(f"{path}:{len(lines)}: the last row has no end (the file may have "
                              "been cut short): end it with a line break if it is whole")
    stripped = ((k, line.partition("#")[0].strip()) for k, line in enumerate(lines, 1))
    return [(k, line) for k, line in stripped if line]


def table_in(folder, name):
    """A file of the log whose first column is the time."""
    path = robot_log.file_in(folder, name)
    lines = lines_in(path)
    names = [column.strip() for column in lines[0][1].split(",")] if lines else []
    if len(lines) < 2 or names[0] != TIME:
        raise ConversionError(f"{path}: no header that begins with {TIME}, or no rows (it is no "
                              "file of a log): write it as experiments/RECORDED_DRIVES.md says")
    numbers = [numbers_of(line, names, f"{path}:{k}") for k, line in lines[1:]]
    rows = robot_log.Rows(path, np.array(numbers), np.array([k for k, _ in lines[1:]]))
    return Table(name, lines[0][1], rows, dict(lines[1:]))


def numbers_of(line, names, place):
    """The numbers of a row. An identity comes second, and one that is missing is a false alarm;
    other empty fields, those of a scan that saw nothing, are 0."""
    words = [word.strip() for word in line.split(",")]
    is_empty = len(words) == len(names) and not any(words[1:])
    filled = [word or str(robot_log.FALSE_ALARM if name == "identity" else 0) if
              is_empty or name == "identity" else word for name, word in zip(names, words)]
    numbers = robot_log.numbers_of(filled + words[len(names):], names, place)
    if "identity" in names:
        numbers.insert(1, numbers.pop(names.index("identity")))
    return numbers


def repaired_detections(table, within):
    """Detections in order, of each landmark one in a scan."""
    steps = [functools.partial(robot_log.in_order, within=within), robot_log.without_equal]
    if table.header.endswith("identity"):
        steps.append(robot_log.first_of_each_landmark)
    return table.repaired(*steps)


def start_in(folder):
    """The start, which is one row."""
    start = table_in(folder, "start.csv").repaired(robot_log.without_equal)
    if len(start.rows.numbers) > 1:
        raise ConversionError(f"{start.rows.place(1)}: another start (a drive starts at one pose): "
                              "leave one out")
    return start


def check_some(table):
    """Raises ConversionError if no row is left."""
    if not len(table.rows.numbers):
        raise ConversionError(f"{table.rows.path}: no row is between the start and the last "
                              "odometry (the file would be empty): take the times of all files "
                              "from one clock")


def convert(arguments):
    folder, within = arguments.folder, arguments.sort_within
    conversion.check_new(arguments.output)
    start = start_in(folder)
    once = functools.partial(robot_log.one_row_a_time, within=within)
    odometry = table_in(folder, "odometry.csv").repaired(once)
    first, last = start.rows.numbers[0, 0], odometry.rows.numbers[-1, 0]
    driven = functools.partial(robot_log.between, first=first, last=last,
                               what="the start or the last odometry")
    names = sorted(os.path.basename(path)
                   for path in glob.glob(os.path.join(glob.escape(folder), "reference*.csv")))
    tables = [odometry,
              repaired_detections(table_in(folder, "detections.csv"), within).repaired(driven),
              *(table_in(folder, name).repaired(once, driven) for name in names)]
    for table in tables:
        check_some(table)
    os.makedirs(arguments.output, exist_ok=True)
    for table in [start, *tables]:
        conversion.write_rows(os.path.join(arguments.output, table.name), table.header,
                              [table.texts[line] for line in table.rows.lines])
    landmarks = os.path.join(folder, "landmarks.csv")
    if os.path.exists(landmarks):
        (_, header), *rows = lines_in(landmarks)
        conversion.write_rows(os.path.join(arguments.output, "landmarks.csv"), header,
                              [line for _, line in rows])
    robot_log.report(*(table.rows for table in [start, *tables]))


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("folder", metavar="FOLDER", help="the log")
    robot_log.add_options(parser)
    conversion.run(convert, parser.parse_args())
