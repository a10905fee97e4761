# SPDX-License-Identifier: BSD-3-Clause
"""The published drives and maps themselves: their logs are the same bytes that the readers wrote of
which the results pages are. Ends with 77 where the data are not at hand: MONTECARTA_DATA, or
shared/data beside the project, holds victoria_park, car_park and bailey.
"""
import hashlib
import os
import sys
import unittest

from scripts import SOURCE, Scripts

import car_park
import victoria_park
import world

DATA = os.environ.get("MONTECARTA_DATA", os.path.join(SOURCE, "../shared/data"))


class PublishedFiles(Scripts):
    def expect_bytes(self, folder, hashes):
        """SHA-256, by the first 16 digits, of all files of a folder."""
        found = {}
        for name in sorted(os.listdir(self.path(folder))):
            with open(self.path(folder, name), "rb") as file:
                found[name] = hashlib.sha256(file.read()).hexdigest()[:16]
        self.assertEqual(found, hashes)

    def test_victoria_park(self):
        for steering, odometry in (("calibrated", "cefb85683b290934"), ("raw", "0865240a155f98ab")):
            self.converted(victoria_park, folder=os.path.join(DATA, "victoria_park"),
                           output=self.path(steering), steering=steering)
            self.expect_bytes(steering, {"detections.csv": "757599d05ac7d7d2",
                                         "odometry.csv": odometry,
                                         "reference_gps.csv": "eb439cb42c69269f",
                                         "reference_gps_all.csv": "16dfe31cebeb2d3d",
                                         "start.csv": "27c382e94c6d4451"})
        trees = self.rows("raw", "detections.csv")
        self.assertEqual(sum(row[1] != "" for row in trees), 52792)
        self.assertEqual(sum(row[1] == "" for row in trees), 19)

    def test_car_park(self):
        self.converted(car_park, folder=os.path.join(DATA, "car_park"), output=self.path("log"))
        self.expect_bytes("log", {"detections.csv": "0906b8d7caba0b7e",
                                 "landmarks.csv": "7ee0da18fa00cb37",
                                 "odometry.csv": "a1e53d9a7f6c7cdf",
                                 "reference_gps.csv": "da6ca6a46066bcbe",
                                 "start.csv": "75640cd21d8a06d0"})
        self.assertEqual(sum(row[1] != "" for row in self.rows("log", "detections.csv")), 892)

    def test_webmap(self):
        self.converted(world, map=os.path.join(DATA, "bailey/example_webmap.mat"),
                       output=self.path("web.csv"))
        kinds = [row[0] for row in self.rows("web.csv")]
        self.assertEqual((kinds.count("landmark"), kinds.count("waypoint")), (35, 17))


if __name__ == "__main__":
    missing = [name for name in ("victoria_park", "car_park", "bailey")
               if not os.path.isdir(os.path.join(DATA, name))]
    if missing:
        print(f"skipped: {', '.join(missing)} not in {DATA} (set MONTECARTA_DATA)")
        sys.exit(77)
    unittest.main()
