# SPDX-License-Identifier: BSD-3-Clause
"""Small drives in the formats of the published ones."""
import math
import os
import random
import unittest

from scripts import Scripts, conversion, np, savemat, sweep_of

import car_park
import victoria_park


class VictoriaPark(Scripts):
    """Three odometry records, two scans of one tree each and three fixes, in both releases."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("park"))
        self.sweeps = [sweep_of((179, 181, 10.0)), sweep_of((199, 201, 10.0))]
        self.write("park/DRS.txt", "0.975\t1.5\t-0.01\r\n1\t1.5\t0\r\n1.025\t1.6\t0.02\r\n")
        self.write("park/LASER.txt", self.laser(0.98, self.sweeps[0]) +
                   self.laser(1.02, self.sweeps[1]))
        self.write("park/GPS.txt", "0\t0\t0\n1\t-2\t3\n2\t-4\t6.5\n")
        self.write("park/Sensors_manager.txt",
                   "0 1 1\n0.975 2 1\n0.98 3 1\n1 1 2\n1 2 2\n1.02 3 2\n1.025 2 3\n2 1 3\n")
        self.save("park/aa3_dr.mat", {"time": np.int32([[21942], [21967], [21992]]),
                                      "speed": [[1.5], [1.5], [1.6]],
                                      "steering": [[-0.0125], [-0.003], [0.018]]})
        self.save("park/aa3_gpsx.mat", {"timeGps": np.int32([[20967, 21967, 22467, 22967]]),
                                        "La_m": [[-41.0, -43, -44, -45]],
                                        "Lo_m": [[-67.0, -64, -62, -60.5]]})

    @staticmethod
    def laser(time, ranges):
        return "".join(f"{value}\t" for value in (time, *ranges))

    def convert(self, output="log", steering="calibrated"):
        self.converted(victoria_park, folder=self.path("park"), output=self.path(output),
                       steering=steering)

    def expect_complaint(self, *pieces, steering="calibrated"):
        self.expect_refused(victoria_park, pieces, folder=self.path("park"),
                            output=self.path("log"), steering=steering)

    def expect_complaint_with(self, name, text, *pieces):
        with open(self.path("park", name), encoding="utf-8", newline="") as file:
            good = file.read()
        self.write("park/" + name, text)
        self.expect_complaint(name, *pieces)
        self.write("park/" + name, good)

    def test_is_read_in_the_text_release(self):
        self.convert()
        self.assertEqual(self.rows("log", "odometry.csv"),
                         [["0.975", "1.5", "-0.01"], ["1", "1.5", "0"], ["1.025", "1.6", "0.02"]])
        self.assertEqual(self.rows("log", "start.csv"), [["0", "0", "0", "0.619591884457987"]])
        times, _, bearings = zip(*self.rows("log", "detections.csv"))
        self.assertEqual(times, ("0.98", "1.02"))
        self.assertAlmostEqual(float(bearings[1]), math.radians(10), 12)
        self.assertEqual(self.rows("log", "reference_gps.csv")[1], ["1", "3", "-2"])  # East, North

    def test_has_the_mat_release_on_the_texts_clock_and_origin(self):
        self.convert(steering="raw")
        self.assertEqual(self.rows("log", "odometry.csv")[0], ["0.975", "1.5", "-0.0125"])
        self.assertEqual(self.rows("log", "reference_gps_all.csv")[:2],
                         [["0", "0", "0"], ["1", "3", "-2"]])

    def test_has_the_same_sweeps_in_either_release(self):
        self.convert()
        os.remove(self.path("park/LASER.txt"))
        centimetres = np.round(np.array(self.sweeps) * 100).astype(np.uint16)
        intensity = (np.arange(conversion.LASER_BEAMS) % 8 << 13).astype(np.uint16)
        for compress in (False, True):
            savemat(self.path("park/aa3_lsr2.mat"), {"TLsr": np.int32([[21947], [21987]]),
                                                     "LASER": centimetres | intensity},
                    do_compression=compress)
            self.convert(f"log_{compress}")
            self.assertEqual(self.rows("log", "detections.csv"),
                             self.rows(f"log_{compress}", "detections.csv"))

    def test_keeps_a_scan_that_saw_nothing(self):
        self.write("park/LASER.txt", self.laser(0.98, sweep_of()) +
                   self.laser(1.02, self.sweeps[1]))
        self.convert()
        self.assertEqual(self.rows("log", "detections.csv")[0], ["0.98", "", ""])

    def test_does_with_one_reference_and_without_the_manager(self):
        os.remove(self.path("park/Sensors_manager.txt"))
        os.remove(self.path("park/GPS.txt"))
        self.convert()
        self.assertEqual(sorted(os.listdir(self.path("log"))),
                         ["detections.csv", "odometry.csv", "reference_gps_all.csv", "start.csv"])
        os.remove(self.path("park/aa3_gpsx.mat"))
        self.expect_refused(victoria_park, ("GPS.txt", "cannot be opened"),
                            folder=self.path("park"), output=self.path("new"),
                            steering="calibrated")

    def test_names_file_and_record_of_a_mistake(self):
        for text, *pieces in (("1 2 0\n1.025 2\n", "record 2", "2 of 3"),
                              ("1 2 0\n1.025 fast 0\n", "record 2", "'fast'"),
                              ("1 2 0\n0.5 2 0\n", "record 2", "times must increase"),
                              ("", "no records"),
                              ("1 2 0\n2 2 1", "record 2", "ends with the file")):
            self.expect_complaint_with("DRS.txt", text, *pieces)
        self.expect_complaint_with("GPS.txt", "0 0 0\n1 nan 2\n", "record 2", "'nan'")
        wrong = self.sweeps[1].copy()
        wrong[7] = -3
        good = self.laser(0.98, self.sweeps[0])
        self.expect_complaint_with("LASER.txt", good + self.laser(1.02, wrong), "record 2",
                                   "-3 of beam 7")
        self.expect_complaint_with("LASER.txt", good + "1.02\t10\t", "record 2", "2 of 362")
        os.remove(self.path("park/DRS.txt"))
        self.expect_complaint("DRS.txt", "cannot be opened")

    def test_holds_the_manager_against_the_files(self):
        manager = "Sensors_manager.txt"
        for name, text, *pieces in (
                ("DRS.txt", "0.975 1.5 0\n1 1.5 0\n", "record 7 (odometry)", "2"),
                ("DRS.txt", "0.975 1.5 0\n1 1.5 0\n1.025 1 0\n1.05 1 0\n", "3 of 4"),
                ("GPS.txt", "0 0 0\n1.01 -2 3\n2 -4 6.5\n", "record 4 (GPS)")):
            with open(self.path("park", name), encoding="utf-8") as file:
                good = file.read()
            self.write("park/" + name, text)
            self.expect_complaint(manager, *pieces)
            self.write("park/" + name, good)
        self.expect_complaint_with(manager, "0 4 1\n", "record 1", "sensor 4")
        self.expect_complaint_with(manager, "0 1 2\n", "record 1 (GPS)")

    def test_refuses_mat_files_of_other_shapes(self):
        times = np.int32([[21942], [21967]])
        for variables, piece in (({"time": times, "speed": [[1.0], [2], [3]]}, "'speed' has 3"),
                                 ({"time": times, "speed": [[1.0], [2]]}, "no variable 'steering'"),
                                 ({"time": times, "speed": [["a"], ["b"]]}, "no variable 'speed'"),
                                 ({"time": np.ones((2, 2))}, "'time' is 2 x 2")):
            self.save("park/aa3_dr.mat", variables)
            self.expect_complaint("aa3_dr.mat", piece, steering="raw")
        self.write("park/aa3_dr.mat", "no MATLAB file")
        self.expect_complaint("aa3_dr.mat", "damaged", "take the file as published", steering="raw")

    def test_writes_into_no_folder_that_holds_something(self):
        self.convert()
        with self.assertRaisesRegex(conversion.ConversionError, "log: not empty"):
            self.convert()


class CarPark(Scripts):
    """Three odometry records, two scans (one pole, nothing), two fixes, two surveyed poles."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("park"))
        tree = sweep_of((199, 201, 10.0))
        self.variables = {
            "Time_VS": [45.0, 45.025, 45.05], "Velocity": [2.0, 2.1, 2.2],
            "Steering": [0.1, 0.2, 0.3], "TimeLaser": [45.02, 45.04],
            "Laser": np.array([tree, np.full(tree.size, 5.0)]),
            "Intensity": np.array([np.where(tree < 80, 8192.0, 0.0), np.zeros(tree.size)]),
            "TimeGPS": [45.01, 45.22], "GPSLon": [5.0, 5.5], "GPSLat": [4.0, 3.5],
            "Time": [45.0, 45.01, 45.02, 45.025, 45.04, 45.05, 45.22],
            "Sensor": [2.0, 1, 3, 2, 3, 2, 1], "Index": [1.0, 1, 1, 2, 2, 3, 2]}
        self.save("park/data_set.mat", self.variables)
        self.save("park/beac_juan3.mat", {"estbeac": [[1.0, 10], [2, 20]]})
        self.arguments = {"folder": self.path("park"), "output": self.path("log")}

    def test_has_poles_and_survey(self):
        self.converted(car_park, **self.arguments)
        self.assertEqual(self.rows("log", "odometry.csv")[1], ["45.025", "2.1", "0.2"])
        first, second = self.rows("log", "detections.csv")
        self.assertAlmostEqual(float(first[1]), 10.03, 12)
        self.assertEqual(second, ["45.04", "", ""])
        self.assertEqual(self.rows("log", "start.csv"),
                         [["45.01", "5", "4", "-2.1903882112528836"]])
        self.assertEqual(self.rows("log", "landmarks.csv"), [["1", "10"], ["2", "20"]])
        os.remove(self.path("park/beac_juan3.mat"))
        self.converted(car_park, **{**self.arguments, "output": self.path("bare")})
        self.assertFalse(os.path.exists(self.path("bare/landmarks.csv")))

    def test_names_file_and_record_of_a_mistake(self):
        ranges = np.full((2, conversion.LASER_BEAMS), 5.0)
        ranges[1, 9] = math.nan
        for name, values, piece in (
                ("Laser", ranges, "record 2: nan of beam 9"),
                ("Laser", np.ones((2, 2)), "'Laser' is 2 x 2"),
                ("Intensity", np.ones((3, conversion.LASER_BEAMS)), "'Intensity' is 3 x 361"),
                ("Time_VS", [45.0, 45.05, 45.025], "record 3: time 45.025 s"),
                ("Velocity", [1.0, 2], "'Velocity' has 2 records of 3"),
                ("Velocity", np.ones((2, 2)), "'Velocity' is 2 x 2"),
                ("GPSLon", [5.0, math.inf], "'GPSLon': record 2"),
                ("Sensor", [2.0, 1, 3, 2, 2, 2, 1], "record 5 (odometry)")):
            self.save("park/data_set.mat", {**self.variables, name: values})
            self.expect_refused(car_park, ("data_set.mat", piece, "): "), **self.arguments)

    def test_knows_a_file_that_was_cut_short_from_one_that_is_missing(self):
        with open(self.path("park/data_set.mat"), "rb+") as file:
            file.truncate(5000)
        self.expect_refused(car_park, ("data_set.mat", "damaged"), **self.arguments)
        os.remove(self.path("park/data_set.mat"))
        self.expect_refused(car_park, ("data_set.mat", "cannot be opened"), **self.arguments)

    def test_converts_or_names_a_damaged_file(self):
        path, draw, refused = self.path("park/data_set.mat"), random.Random(1), 0
        with open(path, "rb") as file:
            good = file.read()
        for case in range(60):
            bad = bytearray(good[:draw.randrange(len(good))] if case % 2 else good)
            for _ in range(0 if case % 2 else 8):
                bad[draw.randrange(400)] = draw.randrange(256)
            with open(path, "wb") as file:
                file.write(bad)
            try:
                self.converted(car_park, **{**self.arguments, "output": self.path(f"log{case}")})
            except conversion.ConversionError as error:
                self.assertIn("data_set.mat", str(error))
                refused += 1
        self.assertGreater(refused, 30)


if __name__ == "__main__":
    unittest.main()
