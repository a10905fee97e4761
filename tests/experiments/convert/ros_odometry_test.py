# SPDX-License-Identifier: BSD-3-Clause
"""Small files of nav_msgs/Odometry, as rostopic and converters of bags write them."""
import math
import os
import unittest

from scripts import Scripts, conversion, np, path_of

import robot_log
import ros_odometry

SPEED, YAW_RATE = 0.5, -0.25
STAMP = 1600000000  # [s]
TWIST = [f"twist.twist.{one}.{axis}" for one in ("linear", "angular") for axis in "xyz"]


def twist(forward=SPEED, left=0.0, yaw_rate=YAW_RATE):
    return [repr(forward), repr(left), "0.0", "0.0", "0.0", repr(yaw_rate)]


class RosOdometry(Scripts):
    """101 rows, 20 ms apart, on a circle."""

    def setUp(self):
        super().setUp()
        self.header = ["%time", "field.header.stamp", "field.header.frame_id",
                       *("field." + name for name in TWIST)]
        self.lines = [self.row(20 * k) for k in range(101)]
        self.arguments = {"file": self.path("odom.csv"), "output": self.path("drive"),
                          "vehicle": "differential_drive", "time": None,
                          "sort_within": robot_log.SORT_WITHIN}
        self.write_file()

    @staticmethod
    def row(milliseconds, **components):
        stamp = str(STAMP * 10**9 + milliseconds * 10**6)
        return [str(int(stamp) + 12345), stamp, "odom", *twist(**components)]

    def write_file(self):
        self.write("odom.csv", "\n".join(map(",".join, [self.header, *self.lines])) + "\n")

    def test_moves_on_the_circle(self):
        self.assertIn("times from 1600000000.000 to 1600000002.000 s",
                      self.converted(ros_odometry, **self.arguments))
        odometry = self.numbers("drive/odometry.csv")
        self.assertEqual(len(odometry), 101)
        x, y, heading = path_of((STAMP, 0, 0, 0), odometry, [STAMP + 2.0])[0]
        radius, turn = SPEED / YAW_RATE, YAW_RATE * 2
        np.testing.assert_allclose([x, y, heading],
                                   [radius * math.sin(turn), radius * (1 - math.cos(turn)), turn],
                                   rtol=0, atol=1e-6)

    def test_reads_seconds_and_nanoseconds_in_two_columns(self):
        self.converted(ros_odometry, **self.arguments)
        whole = self.bytes_of("drive")
        self.header = ["Time", "header.seq", "header.stamp.secs", "header.stamp.nsecs", *TWIST]
        self.lines = [[f"{STAMP + 5}.5", "7", str(STAMP + k // 50), str(k % 50 * 20_000_000),
                       *twist()] for k in range(101)]
        self.write_file()
        self.converted(ros_odometry, **{**self.arguments, "output": self.path("again")})
        self.assertEqual(self.bytes_of("again"), whole)

    def test_has_the_speed_to_the_left_only_if_asked(self):
        self.lines[7] = self.row(140, left=0.25)
        self.write_file()
        self.expect_refused(ros_odometry, ["odom.csv:9", "0.25 m/s", "--vehicle omnidirectional"],
                            **self.arguments)
        self.converted(ros_odometry, **{**self.arguments, "vehicle": "omnidirectional"})
        self.assertEqual(self.rows("drive/odometry.csv")[7],
                         ["1600000000.14", "0.5", "0.25", "-0.25"])
        self.lines[7] = self.row(140, left=0.005)
        self.write_file()
        self.assertIn("speeds of up to 0.005 m/s to the side, ignored", self.converted(
            ros_odometry, **{**self.arguments, "output": self.path("new")}))

    def test_counts_what_it_repairs(self):
        self.converted(ros_odometry, **{**self.arguments, "output": self.path("good")})
        self.lines.insert(4, self.lines[4])
        self.lines.insert(9, self.row(160, forward=9.0))
        self.lines[50], self.lines[51] = self.lines[51], self.lines[50]
        self.write_file()
        self.assertIn("101 rows; times are in ns by the header, written in s; 1 out of order by up "
                      "to 0.02 s, sorted; 1 equal to another, left out; 1 replaced by a later row "
                      "of the same time\n", self.converted(ros_odometry, **self.arguments))
        self.assertEqual(self.bytes_of("drive"), self.bytes_of("good"))

    def test_names_file_and_line_of_a_mistake(self):
        for change, *pieces in (
                ((3, ["1", "2", "odom"]), "odom.csv:5", "3 fields"),
                ((3, [*self.row(60)[:8], "fast"]), "odom.csv:5", "'fast'"),
                ((3, ["0", "soon", "odom", *twist()]), "odom.csv:5", "'soon' is no time"),
                ((3, self.row(900)), "odom.csv:6", "too late")):
            good = list(self.lines)
            self.lines[change[0]] = change[1]
            self.write_file()
            self.expect_refused(ros_odometry, pieces, **self.arguments)
            self.lines = good
        self.header[-1] = "field.pose"
        self.write_file()
        self.expect_refused(ros_odometry, ["odom.csv:1", "0 columns twist.angular.z"],
                            **self.arguments)
        self.write("odom.csv", ",".join(self.header) + "\n")
        self.expect_refused(ros_odometry, ["odom.csv", "no rows"], **self.arguments)
        os.remove(self.path("odom.csv"))
        self.expect_refused(ros_odometry, ["odom.csv", "cannot be opened"], **self.arguments)

    def test_refuses_a_last_line_without_end(self):
        with open(self.path("odom.csv"), "rb+") as file:
            file.seek(-1, os.SEEK_END)
            file.truncate()
        self.expect_refused(ros_odometry, ["odom.csv:102", "no end"], **self.arguments)

    def test_writes_beside_other_files_and_overwrites_nothing(self):
        os.mkdir(self.path("drive"))
        self.write("drive/start.csv", "mine")
        self.converted(ros_odometry, **self.arguments)
        before = self.bytes_of("drive")
        self.assertEqual(sorted(before), ["odometry.csv", "start.csv"])
        with self.assertRaisesRegex(conversion.ConversionError, "nothing is overwritten"):
            self.converted(ros_odometry, **self.arguments)
        self.assertEqual(self.bytes_of("drive"), before)

    def test_writes_the_same_bytes_twice(self):
        self.expect_same_bytes_twice(ros_odometry, **self.arguments)


if __name__ == "__main__":
    unittest.main()
