# SPDX-License-Identifier: BSD-3-Clause
"""A small range-only recording in the format of the Plaza data sets."""
import math
import unittest

from scripts import Scripts, np, path_of

import plaza
import robot_log

SPEED, YAW_RATE, BEGIN = 2.0, 0.4, 100.0  # m/s, rad/s, s


def pose_at(time):
    """The pose on a circle, from (1, -2) on with heading 0.25."""
    turn, radius = YAW_RATE * (time - BEGIN), SPEED / YAW_RATE
    return (1 + radius * (math.sin(0.25 + turn) - math.sin(0.25)),
            -2 + radius * (math.cos(0.25) - math.cos(0.25 + turn)), 0.25 + turn)


class Plaza(Scripts):
    """20 motions of 0.1 s, some of 0.2 s; nodes 0, 5 and 3."""

    def setUp(self):
        super().setUp()
        ends = BEGIN + np.cumsum([0.1, 0.2] * 10)
        begins = np.append(BEGIN, ends[:-1])
        self.variables = {
            "DR": np.column_stack([ends, SPEED * (ends - begins), YAW_RATE * (ends - begins)]),
            "GT": np.array([(time, *pose_at(time)) for time in np.append(BEGIN, ends)]),
            "TD": np.array([[100.25, 2, 5, 7.5], [100.5, 2, 0, 4.25], [101.0, 2, 3, 6]]),
            "TL": np.array([[0, 1.0, 2], [5, 3, 4], [3, 5, 6]])}
        self.arguments = {"file": self.path("plaza.mat"), "output": self.path("log"),
                          "sort_within": robot_log.SORT_WITHIN}
        self.save("plaza.mat", self.variables)

    def expect_the_path(self):
        truth = np.array(self.numbers("log/reference_gps.csv"))[1:]
        found = path_of(self.numbers("log/start.csv")[0], self.numbers("log/odometry.csv"),
                        truth[:, 0])
        np.testing.assert_allclose(found[:, :2], truth[:, 1:3], rtol=0, atol=1e-6)
        self.assertGreater(np.ptp(truth[:, 1]), 3)
        return found, truth

    def test_moves_on_the_path(self):
        printed = self.converted(plaza, **self.arguments)
        self.assertIn("3 nodes, ranges of 1 antenna(s)", printed)
        self.assertEqual(self.rows("log/start.csv"), [["100", "1", "-2", "0.25"]])
        found, truth = self.expect_the_path()
        np.testing.assert_allclose(found[:, 2], truth[:, 3], rtol=0, atol=1e-9)

    def test_has_ranges_and_nodes_in_the_order_of_their_numbers(self):
        self.assertIn("3 rows; identities 0 to 2 are the landmarks 0 to 5\n",
                      self.converted(plaza, **self.arguments))
        self.assertEqual(self.rows("log/detections.csv"), [
            ["100.25", "7.5", "2"], ["100.5", "4.25", "0"], ["101", "6", "1"]])
        self.assertEqual(self.rows("log/landmarks.csv"), [["1", "2"], ["5", "6"], ["3", "4"]])

    def test_turns_headings_that_point_backwards(self):
        self.variables["GT"][:, 3] += math.pi
        self.save("plaza.mat", self.variables)
        self.assertIn("turned by pi", self.converted(plaza, **self.arguments))
        found, truth = self.expect_the_path()
        np.testing.assert_allclose(np.sin((found - truth[:, 1:])[:, 2] / 2), 0, rtol=0, atol=1e-9)

    def test_counts_what_it_repairs(self):
        motions, ranges, path = (self.variables[name].tolist() for name in ("DR", "TD", "GT"))
        motions.insert(3, motions[2])                      # the same motion again
        half = [motions[6][0], motions[6][1] / 2, motions[6][2] / 2]
        motions[6:7] = [half[:1] + [0.25 * one for one in half[1:]],
                        half[:1] + [1.75 * one for one in half[1:]]]  # a motion in two parts
        motions[10], motions[11] = motions[11], motions[10]
        motions.insert(0, [100, 1, 1])                     # before the first pose
        ranges += [[101, 2, 3, 6.5], [200, 2, 3, 6]]
        path.append([200, 0, 0, 0])
        self.save("plaza.mat", {**self.variables, "DR": motions, "TD": ranges, "GT": path})
        self.arguments["sort_within"] = 0.25
        printed = self.converted(plaza, **self.arguments)
        for text in ("20 rows; 1 out of order by up to 0.", "1 equal to another, left out; 1 added "
                     "to another of the same time; 1 that end before the first pose, left out\n",
                     "'GT': 21 rows; 1 before or after the drive, left out\n",
                     "1 of a landmark that the scan has before, left out; 1 before or after the "
                     "drive, left out\n"):
            self.assertIn(text, printed)
        self.assertEqual(len(self.rows("log/detections.csv")), 3)
        self.expect_the_path()

    def test_names_file_and_record_of_a_mistake(self):
        def changed(name, row, column, value):
            values = self.variables[name].copy()
            values[row, column] = value
            return {name: values}

        for change, *pieces in (
                ({"DR": np.ones((3, 2))}, "'DR' is 3 x 2", "time, distance, turn"),
                (changed("GT", 2, 1, math.nan), "'GT': record 3", "(the x)"),
                (changed("DR", 4, 0, 100.1), "'DR': record 5", "too late"),
                (changed("TD", 1, 3, 0), "'TD': record 2", "range 0 m"),
                (changed("TD", 1, 2, 9), "'TD': record 2", "landmark 9 is not in 'TL'"),
                (changed("TD", 1, 2, 1.5), "'TD': record 2", "1.5 is no number of a node"),
                (changed("TD", 1, 1, 2.5), "'TD': record 2", "2.5 is no number of a node"),
                (changed("TL", 1, 0, 1e300), "'TL': record 2", "no number of a node"),
                (changed("TL", 1, 0, 0), "'TL': record 2", "node 0 twice"),
                ({"GT": self.variables["GT"] + [1e3, 0, 0, 0]}, "'DR': no motion after"),
                ({"TD": self.variables["TD"] + [1e3, 0, 0, 0]}, "'TD': no range during")):
            self.save("plaza.mat", {**self.variables, **change})
            self.expect_refused(plaza, ["plaza.mat: ", *pieces], **self.arguments)
        self.save("plaza.mat", {name: self.variables[name] for name in ("GT", "DR", "TD")})
        self.expect_refused(plaza, ["plaza.mat", "no variable 'TL'"], **self.arguments)
        self.write("plaza.mat", "no matrices")
        self.expect_refused(plaza, ["plaza.mat", "damaged"], **self.arguments)

    def test_writes_the_same_bytes_twice_and_overwrites_nothing(self):
        self.expect_same_bytes_twice(plaza, **self.arguments)


if __name__ == "__main__":
    unittest.main()
