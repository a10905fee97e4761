# SPDX-License-Identifier: BSD-3-Clause
"""A small log in the format of the course on robot mapping at Freiburg."""
import math
import unittest

from scripts import Scripts, np, path_of

import freiburg

MOTIONS = [(0.5, 1.0, 0.25), (0.0, 0.5, 0.0), (-2.0, 0.75, 3.0), (math.pi, 1.0, 0.5)]


class Freiburg(Scripts):
    """Four motions and two landmarks, which are 4 and 9."""

    def setUp(self):
        super().setUp()
        lines = ["ODOMETRY %r %r %r" % motion for motion in MOTIONS]
        lines[1:1] = ["SENSOR 9 2.5 0.5", "SENSOR 4 3 -0.25"]
        lines.append("SENSOR 9 4.5 1")
        self.lines = lines
        self.write_log()
        self.write("world.dat", "4 1 2\n9 -3 0.5\n")
        self.arguments = {"log": self.path("sensor_data.dat"), "world": self.path("world.dat"),
                          "output": self.path("log")}

    def write_log(self):
        self.write("sensor_data.dat", "\n".join(self.lines) + "\n")

    def test_moves_as_the_motions_say(self):
        printed = self.converted(freiburg, **self.arguments)
        self.assertIn("4 motions of 1 s each", printed)
        pose, poses = (0.0, 0.0, 0.0), []
        for rot1, trans, rot2 in MOTIONS:  # as the course defines a motion
            x, y, heading = pose
            pose = (x + trans * math.cos(heading + rot1), y + trans * math.sin(heading + rot1),
                    heading + rot1 + rot2)
            poses.append(pose)
        odometry = self.numbers("log/odometry.csv")
        self.assertEqual(odometry[-1], [4, 0, 0, 0])
        self.assertLess(max(abs(row[3]) for row in odometry), math.pi)
        found = path_of(self.numbers("log/start.csv")[0], odometry, [1, 2, 3, 4])
        np.testing.assert_allclose(found[:, :2], np.array(poses)[:, :2], rtol=0, atol=1e-5)
        turned = found[:, 2] - np.array(poses)[:, 2]
        np.testing.assert_allclose(np.sin(turned / 2), 0, rtol=0, atol=1e-9)

    def test_sees_after_the_motion(self):
        self.assertIn("identities 0 to 1 are the landmarks 4 to 9",
                      self.converted(freiburg, **self.arguments))
        self.assertEqual(self.rows("log/detections.csv"),
                         [["1", "2.5", "0.5", "1"], ["1", "3", "-0.25", "0"],
                          ["4", "4.5", "1", "1"]])
        self.assertEqual(self.rows("log/landmarks.csv"), [["1", "2"], ["-3", "0.5"]])

    def test_does_without_a_world(self):
        self.converted(freiburg, **{**self.arguments, "world": None})
        self.assertEqual(sorted(self.bytes_of("log")),
                         ["detections.csv", "odometry.csv", "start.csv"])
        self.assertEqual(self.rows("log/detections.csv")[0], ["1", "2.5", "0.5", "1"])

    def test_prints_the_noise_of_a_motion(self):
        printed = self.converted(freiburg, **self.arguments)
        for line in ("vehicle = omnidirectional\n", "sigma_forward = 0.316\n",
                     "sigma_yaw_rate_deg = 5.73\n", "sigma_range = 0.1\n"):
            self.assertIn(line, printed)

    def test_counts_what_it_repairs(self):
        self.lines[2:2] = ["SENSOR 9 2.5 0.5", "SENSOR 9 2.75 0.5"]
        self.write_log()
        printed = self.converted(freiburg, **self.arguments)
        self.assertIn("3 rows; ", printed)
        self.assertIn("1 equal to another, left out; 1 of a landmark that the scan has before, "
                      "left out", printed)
        self.assertEqual(len(self.rows("log/detections.csv")), 3)

    def test_names_file_and_line_of_a_mistake(self):
        for line, *pieces in (("SENSOR 9 2.5", ":2", "1 numbers of 2"),
                              ("SENSOR nine 2 1", ":2", "'nine' is no whole number"),
                              ("SENSOR", ":2", "no whole number"),
                              ("SENSOR 9 far 1", ":2", "'far'", "range"),
                              ("SENSOR 9 0 1", ":2", "range 0 m"),
                              ("SENSOR 7 2 1", ":2", "landmark 7 is not in"),
                              ("ODOMETRY 1 2", ":2", "2 numbers of 3"),
                              ("FLASER 3 1 1 1", ":2", "'FLASER' is no tag")):
            self.lines[1] = line
            self.write_log()
            self.expect_refused(freiburg, ["sensor_data.dat" + pieces[0], *pieces[1:]],
                                **self.arguments)
        for text, piece in (("ODOMETRY 1 1 1\n", "no line SENSOR"),
                            ("SENSOR 9 1 1\n", "no line ODOMETRY"),
                            ("ODOMETRY 1 1 1\nSENSOR 9 1 1", ":2: the last line has no end")):
            self.write("sensor_data.dat", text)
            self.expect_refused(freiburg, ["sensor_data.dat", piece], **self.arguments)

    def test_names_a_mistake_in_the_world(self):
        for text, *pieces in (("4 1 2\n9 0 0\n4 1 2\n", ":3", "landmark 4 twice"),
                              ("4 1\n", ":1", "1 numbers of 2"),
                              ("four 1 2\n", ":1", "'four'")):
            self.write("world.dat", text)
            self.expect_refused(freiburg, ["world.dat" + pieces[0], *pieces[1:]], **self.arguments)
        self.arguments["world"] = self.path("no.dat")
        self.expect_refused(freiburg, ["no.dat", "cannot be opened"], **self.arguments)

    def test_writes_the_same_bytes_twice_and_overwrites_nothing(self):
        self.expect_same_bytes_twice(freiburg, **self.arguments)


if __name__ == "__main__":
    unittest.main()
