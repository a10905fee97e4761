# SPDX-License-Identifier: BSD-3-Clause
"""Set 6 of UTIAS MRCLAM itself. Ends with 77 where it is not at hand: MONTECARTA_DATA, or
shared/data beside the project, holds mrclam/mrclam6.tar.xz.
"""
import os
import sys
import tarfile
import unittest

from scripts import SOURCE, Scripts, np, path_of

import mrclam
import robot_log

DATA = os.environ.get("MONTECARTA_DATA", os.path.join(SOURCE, "../shared/data"))
ARCHIVE = os.path.join(DATA, "mrclam/mrclam6.tar.xz")


class PublishedRecording(Scripts):
    def test_five_robots(self):
        with tarfile.open(ARCHIVE) as archive:
            archive.extractall(self.folder)
        printed = self.converted(mrclam, folder=self.path("6"), output=self.path("logs"),
                                 sort_within=robot_log.SORT_WITHIN, accuracy=None)
        for line in ("5 drives with 15 landmarks", "Robot1_Odometry.dat: 61785 rows\n",
                     "Robot1_Measurement.dat: 1535 rows; 407 of other robots, left out; 1 of "
                     "unknown barcodes, kept as false alarms\n",
                     "Robot4_Odometry.dat: 52906 rows; 7 equal to another, left out; 3 replaced by "
                     "a later row of the same time\n"):
            self.assertIn(line, printed)
        for robot in range(1, 6):
            odometry, detections, truth, landmarks = (
                np.array(self.numbers("logs", f"robot{robot}", name + ".csv"), dtype=float)
                for name in ("odometry", "detections", "reference_motion_capture", "landmarks"))
            self.expect_landmarks_where_they_are(detections, truth, landmarks)
            self.expect_odometry_on_the_path(odometry[:3000].tolist(), truth)

    def expect_landmarks_where_they_are(self, detections, truth, landmarks):
        seen = detections[~np.isnan(detections[:, 3])]  # false alarms have no identity
        x, y, heading = (np.interp(seen[:, 0], truth[:, 0], column) for column in
                         (truth[:, 1], truth[:, 2], np.unwrap(truth[:, 3])))
        there = landmarks[seen[:, 3].astype(int)]
        ranges = np.hypot(there[:, 0] - x, there[:, 1] - y)
        bearings = np.arctan2(there[:, 1] - y, there[:, 0] - x) - heading
        self.assertLess(np.median(np.abs(seen[:, 1] - ranges)), 0.2)
        self.assertLess(np.median(np.abs(np.sin(seen[:, 2] - bearings))), 0.02)

    def expect_odometry_on_the_path(self, odometry, truth):
        later = truth[(truth[:, 0] > truth[0, 0]) & (truth[:, 0] < truth[0, 0] + 15)][::50, :3]
        found = path_of(truth[0], odometry, later[:, 0])
        self.assertGreater(np.abs(later[:, 1:] - truth[0, 1:3]).max(), 0.25)
        self.assertLess(np.abs(found[:, :2] - later[:, 1:]).max(), 0.2)


if __name__ == "__main__":
    if not os.path.isfile(ARCHIVE):
        print(f"skipped: mrclam/mrclam6.tar.xz not in {DATA} (set MONTECARTA_DATA)")
        sys.exit(77)
    unittest.main()
