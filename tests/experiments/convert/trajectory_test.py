# SPDX-License-Identifier: BSD-3-Clause
"""Trajectories in the layouts of TUM and OpenVINS."""
import os
import unittest

from scripts import Scripts, np

import trajectory


class Trajectories(Scripts):
    STAMP = "# timestamp(s) tx ty tz qx qy qz qw Pr11 ...\n"
    POSE = "1.5 1 2 3 0 0 0 1"
    OPEN_VINS = POSE + " 4 0.1 0.2 5 0.3 6 7 0.4 0.5 8 0.6 9\n"

    def estimates(self, text):
        """[(numbers up to the pose, covariance)] of a file with this text."""
        self.write("e.txt", text)
        if os.path.exists(self.path("e.csv")):
            os.remove(self.path("e.csv"))
        self.converted(trajectory, kind="estimate", files=[self.path("e.txt")])
        rows = [list(map(float, row)) for row in self.rows("e.csv")]
        return [(row[:8], np.reshape(row[8:], (6, 6))) for row in rows]

    def expect_complaint(self, text, *pieces, kind="estimate"):
        self.write("e.txt", text)
        self.expect_refused(trajectory, pieces, kind=kind, files=[self.path("e.txt")])
        self.assertFalse(os.path.exists(self.path("e.csv")))

    def test_have_the_covariances_of_open_vins_position_first(self):
        (pose, P), = self.estimates(self.STAMP + self.OPEN_VINS)
        self.assertEqual(pose, [1.5, 1, 2, 3, 0, 0, 0, 1])
        expected = np.zeros((6, 6))
        expected[:3, :3] = [[7, 0.4, 0.5], [0.4, 8, 0.6], [0.5, 0.6, 9]]
        expected[3:, 3:] = [[4, 0.1, 0.2], [0.1, 5, 0.3], [0.2, 0.3, 6]]
        np.testing.assert_array_equal(P, expected)

    def test_turn_the_rotation_of_open_vins_into_the_map(self):
        """Law: NEES of the rotation is that of ov_eval, of an error in the frame of the body."""
        mean = np.array([-0.3, 0.7, 0.2, 0.5])
        mean /= np.linalg.norm(mean)
        line = " ".join(map(repr, map(float, mean)))
        (_, P), = self.estimates(f"1 0 0 0 {line} 4 0.1 0.2 5 0.3 6 1 0 0 1 0 1\n")
        of_body = 0.2 * np.array([1, 2, -2]) / 3
        axis, w = mean[:3], mean[3]  # rotated by the quaternion, written otherwise than by a matrix
        t = 2 * np.cross(axis, of_body)
        of_map = of_body + w * t + np.cross(axis, t)
        Pr = np.array([[4, 0.1, 0.2], [0.1, 5, 0.3], [0.2, 0.3, 6]])
        self.assertAlmostEqual(of_map @ np.linalg.solve(P[3:, 3:], of_map),
                               of_body @ np.linalg.solve(Pr, of_body), 12)
        np.testing.assert_array_equal(P, P.T)

    def test_have_covariances_beside(self):
        k = np.arange(36).reshape(6, 6)
        whole = np.triu(k) + np.triu(k, 1).T
        self.write("e.cov", "1.5 " + " ".join(map(str, whole.ravel())) + "\n")
        np.testing.assert_array_equal(self.estimates(self.POSE + "\n")[0][1], whole)
        self.write("e.cov", "1.5 " + " ".join(map(str, k[np.triu_indices(6)])) + "\n")
        np.testing.assert_array_equal(self.estimates(self.POSE + "\n")[0][1], whole)
        os.remove(self.path("e.csv"))
        self.write("e.cov", "1.4 " + " ".join(map(str, whole.ravel())) + "\n")
        self.expect_complaint(self.POSE + "\n", "e.cov:1", "1.4", "row 1 of", "e.txt")
        self.write("e.cov", "# nothing\n")
        self.expect_complaint(self.POSE + "\n", "e.cov", "0 covariances of 1 poses")

    def test_are_refused_with_file_line_and_remedy(self):
        self.expect_complaint(self.POSE + "\n", "e.txt:1", "8 numbers", "e.cov", "): write")
        self.expect_complaint(self.STAMP + self.OPEN_VINS + self.POSE + " 1\n", "e.txt:3", "9 num")
        self.expect_complaint(self.OPEN_VINS * 2, "e.txt:2", "1.5", "not later")
        self.expect_complaint("1 2 nan\n", "e.txt:1", "'nan'")
        self.expect_complaint(self.OPEN_VINS.rstrip("\n"), "e.txt:1", "no end")
        self.expect_complaint("1 0 0 0 0 0 0 2" + self.OPEN_VINS[len(self.POSE):], "length 2")
        self.expect_complaint("", "e.txt", "no rows")
        self.expect_complaint(self.STAMP, "e.txt", "no rows", kind="truth")

    def test_may_be_of_a_run_that_gave_no_estimates(self):
        self.assertEqual(self.estimates(self.STAMP), [])

    def test_may_be_truths_of_poses_alone(self):
        self.write("long.txt", self.OPEN_VINS)
        self.write("t.txt", self.STAMP + self.POSE + "\n")
        files = [self.path("long.txt"), self.path("t.txt")]
        self.converted(trajectory, kind="truth", files=files)
        pose = [["1.5", "1", "2", "3", "0", "0", "0", "1"]]
        self.assertEqual([self.rows("long.csv"), self.rows("t.csv")], [pose, pose])
        self.expect_refused(trajectory, ("long.csv", "exists"), kind="truth", files=files)


if __name__ == "__main__":
    unittest.main()
