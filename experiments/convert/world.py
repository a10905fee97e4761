#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a map of T. Bailey's SLAM simulators from MATLAB's format to the CSV of a world. The
file holds landmarks `lm` and way-points `wp`, each 2 x N or N x 2 [m].

    python3 world.py example_webmap.mat -o example_webmap.csv
"""
import conversion
from conversion import MatFile, np


def points_of(file, name):
    """The matrix `name` as {point, (x, y)}. A 2 x 2 matrix has rows of x and y, as published."""
    values = file.matrix(name)
    if 2 not in values.shape or not np.all(np.isfinite(values)):
        raise conversion.ConversionError(
            f"{file.path}: '{name}' is {values.shape[0]} x {values.shape[1]}, or a number of it is "
            "not finite (2 x N or N x 2 is needed): save x and y [m]")
    return values.T if values.shape[0] == 2 else values


def convert(arguments):
    file = MatFile(arguments.map)
    rows = [f"{kind},{conversion.number_text(x)},{conversion.number_text(y)}"
            for kind, name in (("waypoint", "wp"), ("landmark", "lm"))
            for x, y in points_of(file, name)]
    try:
        conversion.write_rows(arguments.output, "kind,x,y", rows)
    except FileExistsError:
        raise conversion.ConversionError(f"{arguments.output}: exists (nothing is overwritten): "
                                         "remove it, or name another file") from None


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("map", help="the .mat file")
    parser.add_argument("-o", "--output", required=True, help="the .csv file, which must not exist")
    conversion.run(convert, parser.parse_args())
