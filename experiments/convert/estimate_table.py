# SPDX-License-Identifier: BSD-3-Clause
"""Tables of numbers in text files of other programs: rows of words, the names and units of their
columns, and exact times.
"""
import re
from decimal import Decimal

import conversion
from conversion import ConversionError, np

POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
SECONDS_IN = {"s": 0, "ms": -3, "us": -6, "ns": -9}  # power of ten
SAME_TIME = Decimal("1e-6")  # [s] tolerance between the times of pose and covariance
CNSPY_ERRORS = {"type1": "body", "type2": "right-invariant", "type3": "body",
                "type4": "right-invariant", "type5": "world", "type6": "world"}
CNSPY_CHARTS = ("theta_r", "theta_q", "r_small_theta", "q_small_theta", "so3_theta", "se3_tau",
                "rpy_rad", "rpy_degree")


class Table:
    """Words of a text file by row and column; names and units of the columns, if it has a header;
    declarations `#%KEY value`."""

    def __init__(self, path):
        self.path, self.rows, self.places = path, [], []
        self.names, self.units, self.written, self.header_place = (), (), (), path
        self.declared, self.begins_with_timestamp = {}, False
        text = conversion.text_of(path).lstrip("\ufeff")
        for number, line in enumerate(text.splitlines(keepends=True), 1):
            self._add_line(line, f"{path}:{number}")
        if not (self.rows or self.names or "FORMAT" in self.declared or
                self.begins_with_timestamp):
            raise ConversionError(f"{path}: no rows (only a file with a header may have none, of a "
                                  "run that failed): write one row for each time")

    def _add_line(self, line, place):
        content, _, comment = line.partition("#")
        words = self._words(content, place)
        if not words:
            if not self.rows:
                self._add_comment(comment, place)
            return
        if not self.rows and not any(map(is_float, words)):
            self._set_header(words, place)
            return
        if not line.endswith(("\n", "\r")):
            raise ConversionError(f"{place}: the last row has no end (the file may have been cut "
                                  "short): end it with a line break if it is whole")
        if not self.rows and self._names_only_the_pose(len(words)):
            self.names = self.units = self.written = ()
        width = len(self.names or (self.rows[0] if self.rows else words))
        if len(words) != width:
            raise ConversionError(f"{place}: {len(words)} fields, but {width} in the "
                                  f"{'header' if self.names else 'first row'} (fields are "
                                  "missing, or left over): write all rows alike" +
                                  (", and a name for each column" if self.names else ""))
        self.rows.append(words)
        self.places.append(place)

    def _add_comment(self, comment, place):
        if comment.startswith("%"):
            key, _, value = comment[1:].strip().partition(" ")
            self.declared[key.upper()] = value.strip()
            return
        words = self._words(comment, place, is_comment=True)
        names = [pose_name(plain(name_and_unit(word)[0])) for word in words]
        if names[:1] == ["time"]:
            self.begins_with_timestamp = True
            if len({*names} & {*POSE}) >= 4 or words[0].strip() == "time_s":
                self._set_header(words, place)

    def _set_header(self, words, place):
        self.header_place = place
        names = [name_and_unit(word)[0].lower() for word in words]
        twice = [name for name in names if name and names.count(name) > 1]
        if twice:
            raise ConversionError(f"{place}: '{twice[0]}' twice in the header (columns are known "
                                  "by their names): name each column once")
        # cnspy ends the header with the kind of error and its chart, which are no columns.
        for name in names:
            if name in CNSPY_ERRORS or name in CNSPY_CHARTS:
                self.declared["TYPE" if name in CNSPY_ERRORS else "CHART"] = name
        kept = [word for word, name in zip(words, names)
                if name not in CNSPY_ERRORS and name not in CNSPY_CHARTS]
        self.written, self.units = zip(*map(name_and_unit, kept))
        self.names = tuple(map(plain, self.written))

    def _names_only_the_pose(self, width):
        """Whether a row is the pose that the header names in the order of TUM, and behind it a
        covariance of which the header names at most the first number."""
        named = tuple(map(pose_name, self.names[:8]))
        return (named == ("time", *POSE) and len(self.names) <= 9 and width in (8 + 21, 8 + 36) and
                self.units[0] in ("", "s"))

    @staticmethod
    def _words(text, place, is_comment=False):
        text = re.sub(r"\s+(?=[\[(])", "", text.strip())  # "timestamp [ns]" is one name
        if ";" in text and not is_comment:
            raise ConversionError(f"{place}: semicolons (fields are separated by commas or "
                                  "blanks, with decimal points): write commas")
        if "," in text:
            return [word.strip().strip('"') for word in text.split(",")]
        return text.split()

    def column(self, name):
        """Index of the column whose name in a pose is `name`; None without one."""
        found = [k for k, own in enumerate(self.names) if pose_name(own) == name]
        if len(found) > 1 and name != "time":
            raise ConversionError(f"{self.header_place}: '{self.names[found[0]]}' and "
                                  f"'{self.names[found[1]]}' are both {name} of a pose (one is "
                                  "needed): leave out the other")
        return found[0] if found else None

    def numbers(self, columns):
        """The numbers of some columns, {row, column}."""
        values = np.empty((len(self.rows), len(columns)))
        for k, row in enumerate(self.rows):
            for c, column in enumerate(columns):
                value = conversion.finite_number(row[column])
                if value is None:
                    raise ConversionError(f"{self.places[k]}: '{row[column][:40]}' is no finite "
                                          "number (leave out the row of a time without estimate): "
                                          "correct it")
                values[k, c] = value
        return values


def is_float(word):
    """Whether a word is a number, which may be infinite or NaN."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def name_and_unit(word):
    """The name of a column and its unit: "%timestamp [ns]" is timestamp and ns."""
    name, unit = re.fullmatch(r"[#%/]*(.*?)(?:[\[(]((?:[A-Za-z][^\])]*)?)[\])])?",
                              word.strip()).groups()
    return name.strip(), unit or ""


def plain(name):
    """A name of a column in lower case, without the prefix of `rostopic echo -p`."""
    return name.lower().removeprefix("field.")


def pose_name(name):
    """The usual name of a column of a pose ("time", "x", ..., "qw"); None for any other."""
    if re.fullmatch(r"t|time|time_s|timestamp|timestamp_(s|ns)|stamp|header\.stamp", name):
        return "time"
    found = re.fullmatch(r"(?:t|p|p_|pos_|p_rs_r_|(?:pose\.)?pose\.position\.)?([xyz])(?:_m)?",
                         name)
    if found:
        return found[1]
    found = re.fullmatch(r"(?:q|q_|q_rs_|(?:pose\.)?pose\.orientation\.)([xyzw])", name)
    return "q" + found[1] if found else None


def seconds(words, places, unit, given):
    """The times of times_in(), which must increase."""
    times, notes = times_in(words, places, unit, given)
    for k in range(1, len(times)):
        if not times[k] > times[k - 1]:
            raise ConversionError(f"{places[k]}: time {words[k]} is not later than that of the row "
                                  "before (rows go forward in time; equal times may have lost "
                                  "digits): sort them, or print all digits")
    return times, notes


def times_in(words, places, unit, given):
    """Exact times in seconds and a note if they were in another unit. `unit` is that of the header,
    `given` that of --time."""
    times = []
    for word, place in zip(words, places):
        value = conversion.finite_number(word)
        if value is None or abs(value) > 1e30 or not (value == 0 or abs(value) > 1e-30):
            raise ConversionError(f"{place}: '{word[:40]}' is no time (a finite number): correct "
                                  "it")
        times.append(Decimal(word) if value else Decimal(0))
    largest = max(map(abs, times), default=0)
    steps = sorted(b - a for a, b in zip(times, times[1:]))
    by_size = ("ns" if largest >= 10**17 else "us" if largest >= 10**14 else
               "ms" if largest >= 10**11 else
               "" if largest >= 10**10 or steps and steps[len(steps) // 2] > 10**4 else "s")
    if not given and (not (unit or by_size) or unit == "s" != by_size):
        raise ConversionError(f"{places[0]}: time {words[0]} (too large for seconds, but no other "
                              "unit is certain): say --time ns or --time s")
    taken = given or unit or by_size
    why = "--time" if given else "the header" if unit else "their size"
    times = [time.scaleb(SECONDS_IN[taken]) for time in times]
    return times, [] if taken == "s" else [f"times are in {taken} by {why}, written in s"]
