# SPDX-License-Identifier: BSD-3-Clause
"""Maps in MATLAB's format."""
import math
import os
import unittest

from scripts import Scripts, conversion, np

import world


class World(Scripts):
    def arguments(self):
        return {"map": self.path("map.mat"), "output": self.path("map.csv")}

    def test_has_points_lying_or_standing(self):
        self.save("map.mat", {"lm": [[1.0, 3, 5], [2, 4, 6]],
                              "wp": [[10.5, 11], [20, 21], [30, 31]]})
        self.converted(world, **self.arguments())
        self.assertEqual(self.rows("map.csv"), [
            ["waypoint", "10.5", "11"], ["waypoint", "20", "21"], ["waypoint", "30", "31"],
            ["landmark", "1", "2"], ["landmark", "3", "4"], ["landmark", "5", "6"]])
        with self.assertRaisesRegex(conversion.ConversionError, "map.csv: exists"):
            self.converted(world, **self.arguments())

    def test_refuses_what_is_no_map(self):
        way = [[1.0, 2, 3], [1, 2, 3]]
        for variables, piece in (({"wp": way}, "no variable 'lm'"),
                                 ({"wp": way, "lm": np.ones((3, 3))}, "'lm' is 3 x 3"),
                                 ({"wp": way, "lm": [[1.0], [math.nan]]}, "'lm' is 2 x 1")):
            self.save("map.mat", variables)
            self.expect_refused(world, ("map.mat", piece), **self.arguments())
        os.remove(self.path("map.mat"))
        self.expect_refused(world, ("map.mat", "cannot be opened"), **self.arguments())


if __name__ == "__main__":
    unittest.main()
