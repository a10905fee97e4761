# SPDX-License-Identifier: BSD-3-Clause
"""A small log with everything that the script repairs."""
import unittest

from scripts import Scripts

import repair_log
import robot_log

START = "time_s,x_m,y_m,heading_rad\n1,0,0,0\n"
ODOMETRY = "time_s,speed_mps,yaw_rate_radps\n"
DETECTIONS = "time_s,range_m,bearing_rad,identity\n"
REFERENCE = "time_s,x_m,y_m,sigma_x_m,sigma_y_m\n"


class RepairLog(Scripts):
    def setUp(self):
        super().setUp()
        self.arguments = {"folder": self.folder, "output": self.path("new"),
                          "sort_within": robot_log.SORT_WITHIN}
        self.write("start.csv", START)
        self.write("odometry.csv", ODOMETRY + "0,1,0\n1,1.0,0\n1,1.1,0\n2.05,3,0\n2,2,0\n3,1,0\n")
        self.write("detections.csv", DETECTIONS + "0.5,9,0,0\n1,5,0.10,0\n1,5,0.10,0\n1,6,0.2,0\n"
                   "1,7,0.3,\n1,7,0.4,\n2,,,\n2,,,\n3,5,0.1,1  # seen\n3.5,5,0.1,1\n")
        self.write("reference_gps.csv", REFERENCE + "1,0,0,0.1,0.1\n2,1,0,0.1,0.1\n2,2,0,0.1,1\n")
        self.write("landmarks.csv", "x_m,y_m\n1,2\n\n3,4\n")

    def test_repairs_by_the_stated_rules_and_keeps_the_text_of_rows(self):
        said = self.converted(repair_log, **self.arguments)
        self.assertEqual(self.bytes_of("new"), {
            "start.csv": START.encode(),
            "odometry.csv": (ODOMETRY + "0,1,0\n1,1.1,0\n2,2,0\n2.05,3,0\n3,1,0\n").encode(),
            "detections.csv": (DETECTIONS + "1,5,0.10,0\n1,7,0.3,\n1,7,0.4,\n2,,,\n3,5,0.1,1\n"
                               ).encode(),
            "reference_gps.csv": (REFERENCE + "1,0,0,0.1,0.1\n2,2,0,0.1,1\n").encode(),
            "landmarks.csv": b"x_m,y_m\n1,2\n3,4\n"})
        for piece in ("1 out of order by up to 0.05 s, sorted", "1 replaced by a later row",
                      "2 equal to another", "1 of a landmark that the scan has before",
                      "2 before or after the start or the last odometry"):
            self.assertIn(piece, said)

    def test_changes_nothing_in_a_log_without_faults(self):
        self.converted(repair_log, **self.arguments)
        self.converted(repair_log, **{**self.arguments, "folder": self.path("new"),
                                      "output": self.path("again")})
        self.assertEqual(self.bytes_of("new"), self.bytes_of("again"))

    def test_writes_the_same_bytes_twice_and_overwrites_nothing(self):
        self.expect_same_bytes_twice(repair_log, **self.arguments)

    def test_reads_detections_without_identities(self):
        header = "time_s,range_m,bearing_rad\n"
        self.write("detections.csv", header + "1,5,0.1\n1,5,0.1\n1,6,0.1\n2,,\n")
        self.converted(repair_log, **self.arguments)
        self.assertEqual(self.bytes_of("new")["detections.csv"],
                         (header + "1,5,0.1\n1,6,0.1\n2,,\n").encode())

    def test_takes_one_start(self):
        self.write("start.csv", START + "1,0,0,0.1\n")
        self.expect_refused(repair_log, ["start.csv:3", "another start"], **self.arguments)
        self.write("start.csv", START + START.splitlines()[1] + "\n")
        self.assertIn("start.csv: 1 rows; 1 equal to another",
                      self.converted(repair_log, **self.arguments))
        self.assertEqual(self.bytes_of("new")["start.csv"], START.encode())

    def test_sorts_rows_that_are_late_by_the_limit_itself(self):
        self.write("odometry.csv", ODOMETRY + "0,1,0\n1.1,1,0\n1.0,1,0\n3,1,0\n")
        self.assertGreater(1.1 - 1.0, robot_log.SORT_WITHIN, "by rounding")
        self.assertIn("1 out of order by up to 0.1 s, sorted",
                      self.converted(repair_log, **self.arguments))

    def test_refuses_a_file_of_which_no_row_is_left(self):
        self.write("reference_gps.csv", REFERENCE + "1001,0,0,0.1,0.1\n1002,1,0,0.1,0.1\n")
        self.expect_refused(repair_log, ["reference_gps.csv", "no row", "one clock"],
                            **self.arguments)

    def test_refuses_a_file_that_is_no_text(self):
        self.write("detections.csv", DETECTIONS + "1,5,0.1,0\n1,\0,0.1,1\n")
        self.expect_refused(repair_log, ["detections.csv:3", "NUL byte"], **self.arguments)

    def test_refuses_what_it_cannot_repair(self):
        self.write("odometry.csv", ODOMETRY + "0,1,0\n2,1,0\n1,1,0\n")
        self.expect_refused(repair_log, ["odometry.csv:4", "too late", "--sort-within"],
                            **self.arguments)
        self.write("odometry.csv", ODOMETRY + "0,1,fast\n")
        self.expect_refused(repair_log, ["odometry.csv:2", "'fast' is no finite number"],
                            **self.arguments)
        self.write("odometry.csv", ODOMETRY + "0,1,0\n1,1")
        self.expect_refused(repair_log, ["odometry.csv:3", "no end"], **self.arguments)
        self.write("odometry.csv", "x,y\n0,1\n")
        self.expect_refused(repair_log, ["odometry.csv", "no header"], **self.arguments)


if __name__ == "__main__":
    unittest.main()
