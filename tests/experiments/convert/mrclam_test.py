# SPDX-License-Identifier: BSD-3-Clause
"""A small recording in the format of UTIAS MRCLAM, and the repairs of robots' logs."""
import argparse
import math
import os
import unittest

from scripts import Scripts, conversion, np, path_of

import mrclam
import robot_log

SPEED, YAW_RATE = 0.5, 0.3
ORIGIN = 1248444187.0  # [s] the recordings have the time since 1970


def pose_at(time):
    """The pose on a circle through the origin of the map."""
    turn, radius = YAW_RATE * time, SPEED / YAW_RATE
    return radius * math.sin(turn), radius * (1 - math.cos(turn)), turn


class Mrclam(Scripts):
    """Robots 1 and 2 on the same circle, for 2 s; landmarks are subjects 6 and 7."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("set"))
        self.write("set/Barcodes.dat", "# Subject #  Barcode #\n1 5\n2 14\n6 63\n7 81\n")
        self.write("set/Landmark_Groundtruth.dat", "# comment\n7 1 -2 1e-4 2e-4\n6 3 4 0 0\n")
        self.odometry = [f"{ORIGIN + k / 50:.3f} \t  {SPEED} \t {YAW_RATE}" for k in range(101)]
        self.truth = ["%.3f %.9f %.9f %.9f" % (ORIGIN - 0.04 + k / 25, *pose_at(k / 25 - 0.04))
                      for k in range(60)]
        self.detections = [f"{ORIGIN + 0.5:.3f} 63 4.5 0.7", f"{ORIGIN + 0.5:.3f} 81 2.25 -1.1",
                           f"{ORIGIN + 1:.3f} 14 1.5 0.2", f"{ORIGIN + 1.5:.3f} 63 4.25 0.5"]
        for robot in (1, 2):
            self.write_robot(robot)
        self.arguments = {"folder": self.path("set"), "output": self.path("logs"),
                          "sort_within": robot_log.SORT_WITHIN, "accuracy": None}

    def write_robot(self, robot):
        for kind, rows in (("Odometry", self.odometry), ("Groundtruth", self.truth),
                           ("Measurement", self.detections)):
            self.write(f"set/Robot{robot}_{kind}.dat", "# comment\n" + "\n".join(rows) + "\n")

    def expect_complaint(self, *pieces):
        self.expect_refused(mrclam, pieces, **self.arguments)

    def test_has_a_drive_of_each_robot_that_moves_on_the_true_path(self):
        printed = self.converted(mrclam, **self.arguments)
        self.assertIn("2 drives with 2 landmarks", printed)
        for robot in ("robot1", "robot2"):
            start = self.numbers("logs", robot, "start.csv")[0]
            self.assertEqual(start[0], ORIGIN)
            truth = np.array(self.numbers("logs", robot, "reference_motion_capture.csv"))
            found = path_of(start, self.numbers("logs", robot, "odometry.csv"), truth[:, 0])
            np.testing.assert_allclose(found, truth[:, 1:], rtol=0, atol=1e-6)
            self.assertGreater(np.ptp(truth[:, 1]), 0.9)

    def test_states_how_accurate_the_motion_capture_is(self):
        self.arguments["accuracy"] = mrclam.deviations("0.003,0.01")
        self.converted(mrclam, **self.arguments)
        with open(self.path("logs/robot1/reference_motion_capture.csv"), encoding="utf-8") as file:
            self.assertEqual(file.readline(), "time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,"
                                              "sigma_heading_rad\n")
            self.assertEqual(file.readline().split(",")[4:], ["0.003", "0.003", "0.01\n"])
        for text in ("0.003", "0,1", "0.003,nan", "a,b", "0.003,0.01,1"):
            self.assertRaises(ValueError, mrclam.deviations, text)

    def test_has_landmarks_in_the_order_of_their_subjects(self):
        printed = self.converted(mrclam, **self.arguments)
        self.assertEqual(self.rows("logs/robot1/landmarks.csv"), [["3", "4"], ["1", "-2"]])
        self.assertEqual(self.rows("logs/robot1/detections.csv"),
                         [["1248444187.5", "4.5", "0.7", "0"],
                          ["1248444187.5", "2.25", "-1.1", "1"],
                          ["1248444188.5", "4.25", "0.5", "0"]])
        self.assertIn("Robot1_Measurement.dat: 3 rows; 1 of other robots, left out", printed)

    def test_counts_what_it_repairs(self):
        self.odometry.insert(5, self.odometry[4])                       # the same row again
        self.odometry.insert(8, f"{ORIGIN + 0.14:.3f} 9 9")             # replaced by the next one
        self.odometry[30], self.odometry[31] = self.odometry[31], self.odometry[30]
        self.detections += [f"{ORIGIN + 1.5:.3f} 63 4.5 0.5", f"{ORIGIN + 1.5:.3f} 99 4 0",
                            f"{ORIGIN + 1.5:.3f} 99 4.25 0", f"{ORIGIN + 3:.3f} 63 4 0"]
        self.detections.insert(0, f"{ORIGIN - 1:.3f} 63 4 0")
        self.write_robot(1)
        printed = self.converted(mrclam, **self.arguments)
        for line in ("Robot1_Odometry.dat: 101 rows; 1 out of order by up to 0.02 s, sorted; "
                     "1 equal to another, left out; 1 replaced by a later row of the same time\n",
                     "Robot1_Measurement.dat: 5 rows; 1 of other robots, left out; 2 of unknown "
                     "barcodes, kept as false alarms; 1 of a landmark that the scan has before, "
                     "left out; 2 before or after the drive",
                     "Robot1_Groundtruth.dat: 51 rows; 9 before or after the odometry, left out\n",
                     "Robot2_Odometry.dat: 101 rows\n"):
            self.assertIn(line, printed)
        self.assertEqual(self.rows("logs/robot1/odometry.csv"),
                         self.rows("logs/robot2/odometry.csv"))
        self.assertEqual(self.rows("logs/robot1/detections.csv")[2:],
                         [["1248444188.5", "4.25", "0.5", "0"], ["1248444188.5", "4", "0", ""],
                          ["1248444188.5", "4.25", "0", ""]])

    def test_sorts_only_what_is_a_little_late(self):
        self.odometry.append(f"{ORIGIN + 1.5:.3f} 0 0")
        self.write_robot(1)
        self.expect_complaint("Robot1_Odometry.dat:103: time 1248444188.5 s comes 0.5 s too late",
                              "0.1 s", "--sort-within")
        self.arguments["sort_within"] = 0.6
        self.assertIn("1 out of order by up to 0.5 s, sorted",
                      self.converted(mrclam, **self.arguments))
        self.assertEqual(robot_log.duration("0.25"), 0.25)
        for text in ("nan", "-1", "long"):
            with self.assertRaises(argparse.ArgumentTypeError):
                robot_log.duration(text)

    def test_names_file_and_line_of_a_mistake(self):
        for name, text, *pieces in (
                ("Robot2_Odometry.dat", "# c\n0 1 0\n1 fast 0\n", ":3", "'fast'", "forward speed"),
                ("Robot2_Odometry.dat", "0 1 0\n1 1\n", ":2", "2 numbers of 3"),
                ("Robot2_Odometry.dat", "0 1 0\n1 1 0.25", ":2", "no end"),
                ("Robot2_Odometry.dat", "# nothing\n", "no rows"),
                ("Robot2_Groundtruth.dat", "0 1 nan 0\n", ":1", "'nan'", "(it is the y)"),
                ("Robot2_Groundtruth.dat", "0 1 0 0\n", "no pose during the odometry"),
                ("Robot2_Measurement.dat", f"{ORIGIN + 1} 63 0 1\n", ":1", "range 0 m"),
                ("Robot2_Measurement.dat", f"{ORIGIN + 1} 5 1 1\n", "no detection of a landmark"),
                ("Barcodes.dat", "6 63\n7 81\n6 64\n", ":3", "subject 6 twice"),
                ("Barcodes.dat", "6 63\n7 63\n", ":2", "barcode 63 twice"),
                ("Barcodes.dat", "6 63\n", "no barcode of subject 7")):
            with open(self.path("set", name), encoding="utf-8") as file:
                good = file.read()
            self.write("set/" + name, text)
            self.expect_complaint(name, *pieces)
            self.write("set/" + name, good)
        os.remove(self.path("set/Robot2_Groundtruth.dat"))
        self.expect_complaint("Robot2_Groundtruth.dat", "is missing")
        self.arguments["folder"] = self.path("nowhere")
        self.expect_complaint("nowhere", "is missing")

    def test_writes_the_same_bytes_twice_and_overwrites_nothing(self):
        self.expect_same_bytes_twice(mrclam, **self.arguments)

    def test_writes_no_drive_if_the_folder_of_one_is_taken(self):
        os.makedirs(self.path("logs/robot2"))
        self.write("logs/robot2/notes", "mine")
        with self.assertRaisesRegex(conversion.ConversionError, "robot2: not empty"):
            self.converted(mrclam, **self.arguments)
        self.assertEqual(os.listdir(self.path("logs")), ["robot2"])


if __name__ == "__main__":
    unittest.main()
