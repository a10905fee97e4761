# SPDX-License-Identifier: BSD-3-Clause
"""Logs as robots write them: lines of words, rows of numbers with the line that each is from, and
the repairs of experiments/RECORDED_DRIVES.md, each with a note that counts it.
"""
import argparse
import dataclasses
import math
import os

import conversion
from conversion import ConversionError, np

SORT_WITHIN = 0.1  # [s] rows that are later than this by their time are an error, not sorted
ROUNDING = 1e-6    # [s] of differences of times since 1970
FALSE_ALARM = -1   # identity of a detection of no known landmark
OMNIDIRECTIONAL = "forward_mps,left_mps,yaw_rate_radps"


@dataclasses.dataclass
class Rows:
    """Rows of numbers of one file. The first column is the time [s]. Rows of detections have the
    identity in the second one."""
    path: str
    numbers: np.ndarray  # {row, column}
    lines: np.ndarray    # {row} number of its line in the file
    notes: list = dataclasses.field(default_factory=list)  # what was repaired or left out
    separator: str = ":"                                   # between the file and the line

    def place(self, k):
        return f"{self.path}{self.separator}{self.lines[k]}"

    def taken(self, which, note):
        """The rows `which`, a mask or indices. `note` says why others are missing."""
        lost = len(self.numbers) - len(self.numbers[which])
        return dataclasses.replace(self, numbers=self.numbers[which], lines=self.lines[which],
                                   notes=self.notes + [f"{lost} {note}"] * (lost > 0))


def lines_of(path):
    """(number of the line, words) of every line that is neither blank nor a comment."""
    for number, line in enumerate(conversion.text_of(path).splitlines(keepends=True), 1):
        words = line.partition("#")[0].split()
        if words and not line.endswith(("\n", "\r")):
            raise ConversionError(f"{path}:{number}: the last line has no end (the file may have "
                                  "been cut short): end it with a line break if it is whole")
        if words:
            yield number, words


def numbers_of(words, names, place):
    """The numbers in the words of a line, which are the quantities `names`."""
    if len(words) != len(names):
        raise ConversionError(f"{place}: {len(words)} numbers of {len(names)} (a line is "
                              f"{', '.join(names)}): take the whole file as it was recorded")
    numbers = [conversion.finite_number(word) for word in words]
    for word, number, name in zip(words, numbers, names):
        if number is None:
            raise ConversionError(f"{place}: '{word[:40]}' is no finite number (it is the {name}): "
                                  "take the file as it was recorded, or leave out the line")
    return numbers


def whole_number(word, name, place):
    """The number from 0 in a word, such as an id."""
    if not (word.isascii() and word.isdigit()):
        raise ConversionError(f"{place}: '{word[:40]}' is no whole number (it is the {name}): take "
                              "the file as it was recorded")
    return int(word)


def rows_in(path, names):
    """The rows of a file that has one row of the quantities `names` in each line."""
    found = [(number, numbers_of(words, names, f"{path}:{number}"))
             for number, words in lines_of(path)]
    if not found:
        raise ConversionError(f"{path}: no rows (it is empty): take the whole file as it was "
                              "recorded")
    return Rows(path, np.array([row for _, row in found]), np.array([line for line, _ in found]))


# ---- repairs

def in_order(rows, within=SORT_WITHIN):
    """The rows in the order of their times. Rows that are too late by more than `within` are an
    error."""
    times = rows.numbers[:, 0]
    late = np.maximum.accumulate(times) - times
    wrong = np.flatnonzero(late > within + ROUNDING)
    if wrong.size:
        k = wrong[0]
        raise ConversionError(
            f"{rows.place(k)}: time {conversion.number_text(times[k])} s comes {late[k]:.6g} s "
            f"too late (rows up to {within:g} s out of order are sorted): sort the file, or say "
            "--sort-within SECONDS if the clock is right")
    count = np.count_nonzero(late)
    notes = [f"{count} out of order by up to {late.max():.3g} s, sorted"] if count else []
    order = np.argsort(times, kind="stable")
    return dataclasses.replace(rows, numbers=rows.numbers[order], lines=rows.lines[order],
                               notes=rows.notes + notes)


def without_equal(rows):
    """The rows without those that equal an earlier one in all columns."""
    seen = {}
    for k, row in enumerate(map(tuple, rows.numbers.tolist())):
        seen.setdefault(row, k)
    return rows.taken(list(seen.values()), "equal to another, left out")


def last_of_each_time(rows):
    """The last row of each time, since a row holds from its time until the next one."""
    times = rows.numbers[:, 0]
    return rows.taken(np.append(times[1:] != times[:-1], True),
                      "replaced by a later row of the same time")


def one_row_a_time(rows, within=SORT_WITHIN):
    """Odometry or a path in order, with one row at each time."""
    return last_of_each_time(without_equal(in_order(rows, within)))


def first_of_each_landmark(rows):
    """The detections without those of a landmark that the same scan has before. A scan is all
    detections of one time."""
    seen, kept = set(), []
    for time, identity in rows.numbers[:, :2].tolist():
        kept.append(identity == FALSE_ALARM or (time, identity) not in seen)
        seen.add((time, identity))
    return rows.taken(np.array(kept, dtype=bool),
                      "of a landmark that the scan has before, left out")


def between(rows, first, last, what):
    """The rows from one time to another; `what` names these in the note."""
    times = rows.numbers[:, 0]
    return rows.taken((times >= first) & (times <= last), f"before or after {what}, left out")


# ---- the parts of a drive

def check_ranges(rows, column):
    """Raises ConversionError if a range is not above 0."""
    wrong = np.flatnonzero(~(rows.numbers[:, column] > 0))
    if wrong.size:
        raise ConversionError(f"{rows.place(wrong[0])}: range {rows.numbers[wrong[0], column]:g} m "
                              "(a landmark is farther than 0 m): leave out the line")


def scans_of(rows):
    """The scans of detections with rows (time, identity, component, ...)."""
    scans = {}
    for time, identity, *components in rows.numbers.tolist():
        scans.setdefault(time, []).append(
            (*components, None if identity == FALSE_ALARM else identity))
    return list(scans.items())


def detections_of(path, found, places, source, within=math.inf, separator=":"):
    """The detections `found`, each (line, time, id of the landmark, [component, ...]), as rows
    (time, identity, component, ...), and the positions of the landmarks. Identities count from 0 in
    the order of the ids. `places` {id: (x, y)} is from the file `source`; without a file, every
    landmark that was seen has an identity, and no positions are known."""
    known = sorted(places if source else {one for _, _, one, _ in found})
    identity = {one: k for k, one in enumerate(known)}  # ids may have more digits than a double
    for line, _, one, _ in found:
        if one not in identity:
            raise ConversionError(f"{path}{separator}{line}: landmark {one} is not in {source} (if "
                                  "positions are given, every landmark has one): add it there")
    rows = Rows(path, np.array([(time, identity[one], *seen) for _, time, one, seen in found]),
                np.array([line for line, *_ in found]),
                [f"identities 0 to {len(known) - 1} are the landmarks {known[0]} to {known[-1]}"],
                separator)
    return (first_of_each_landmark(without_equal(in_order(rows, within))),
            [places[one] for one in known] if source else [])


def odometry_of(steps):
    """The odometry of steps (forward, left, turn) in the frame of the vehicle, which begin at time
    0 and take 1 s each: rows (time, forward, left, yaw rate), the last of which ends the last step.
    Held for 1 s, the speeds move an omnidirectional vehicle by the step; this inverts (1.9) of
    filters/EQUATIONS.md, with turns in [-pi, pi]."""
    rows = []
    for time, (forward, left, turn) in enumerate(steps):
        turn = math.remainder(turn, 2 * math.pi)
        half = turn / 2
        scale = half / math.tan(half) if half else 1.0
        rows.append((time, scale * forward + half * left, scale * left - half * forward, turn))
    return [*rows, (len(rows), 0.0, 0.0, 0.0)]


def suggest(settings, source):
    """Prints settings of a study; `source` says where they are from."""
    print(f"[belief]    # {source}")
    for name, value in settings.items():
        print(f"{name} = {value if isinstance(value, str) else format(value, '.3g')}")


def report(*tables):
    """Prints how many rows of each file are used, and what was repaired."""
    for rows in tables:
        print("; ".join([f"{rows.path}: {len(rows.numbers)} rows", *rows.notes]))


def duration(text):
    """The seconds in the text of an option."""
    value = conversion.finite_number(text)
    if value is None or value < 0:
        raise argparse.ArgumentTypeError(f"'{text}' is no time from 0 s on")
    return value


def add_options(parser, is_sorted=True):
    """Adds the options that these scripts share."""
    parser.add_argument("-o", "--output", required=True, metavar="FOLDER",
                        help="the folder of the log, new or empty")
    if is_sorted:
        parser.add_argument("--sort-within", type=duration, default=SORT_WITHIN, metavar="SECONDS",
                            help="sort rows that are out of order by no more than this (default: "
                            "%(default)g)")


def file_in(folder, name):
    """The path of a file of a folder that must be there."""
    path = os.path.join(folder, name)
    if not os.path.isfile(path):
        raise ConversionError(f"{path}: is missing (a drive needs it): put it there")
    return path
