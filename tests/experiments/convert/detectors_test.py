# SPDX-License-Identifier: BSD-3-Clause
"""Trees and poles in sweeps, and numbers as text."""
import math
import unittest

from scripts import conversion, np, sweep_of

import car_park
import victoria_park

HALF_DEGREE = math.pi / 360


def trees(*surfaces):
    return victoria_park.detect_trees(sweep_of(*surfaces))


class Numbers(unittest.TestCase):
    def test_are_the_shortest_text_of_the_same_bits(self):
        for value, text in ((0.0, "0"), (-0.0, "-0"), (12.0, "12"), (0.1, "0.1"), (1e5, "1e+05"),
                            (12e5, "1200000"), (123456.0, "123456"), (0.001, "0.001"),
                            (1e-4, "1e-04"), (0.00012, "0.00012"), (-1e-17, "-1e-17"),
                            (5e-324, "5e-324"), (1 / 3, "0.3333333333333333"),
                            (1.5e300, "1.5e+300")):
            self.assertEqual(conversion.number_text(value), text)
            self.assertEqual(float(text), value)

    def test_are_finite(self):
        for word in ("nan", "inf", "1e999", "1_0", "", "x"):
            self.assertIsNone(conversion.finite_number(word), word)


class Trees(unittest.TestCase):
    def test_have_the_centre_of_a_trunk(self):
        (distance, bearing), = trees((199, 202, 10.0))
        self.assertAlmostEqual(distance, 10 + 4 * HALF_DEGREE * 10 / 2, 12)
        self.assertAlmostEqual(bearing, 20.5 * HALF_DEGREE, 12)  # counter-clockwise of ahead

    def test_take_the_two_middle_beams_for_the_range(self):
        even = trees((199, 202, 10.0), (200, 200, 9.8), (201, 201, 9.7))
        self.assertAlmostEqual(even[0][0], 9.75 + 4 * HALF_DEGREE * 10 / 2, 12)
        odd = trees((199, 201, 10.0), (200, 200, 9.8))
        self.assertAlmostEqual(odd[0][0], 9.8 + 3 * HALF_DEGREE * 10 / 2, 12)

    def test_are_found_and_left_out_by_each_step(self):
        third = 4 * HALF_DEGREE * 10 / 3  # of the diameter of four beams at 10 m
        for count, *surfaces in (
                # 1: a point that is too far
                (1, (200, 200, 74.9)), (0, (200, 200, 75.0)), (0,),
                # 2: cut where range or angle steps; segments that crowd each other are none
                (1, (150, 151, 20.0), (152, 152, 21.4), (153, 154, 20.0)),
                (0, (150, 151, 20.0), (152, 152, 21.6), (153, 154, 20.0)),
                (1, (200, 200, 2.0), (209, 209, 2.0)), (0, (200, 200, 2.0), (211, 211, 2.0)),
                # 3: trunks stand alone; 18 beams at 20 m are 3.14 m
                (2, (200, 201, 20), (219, 219, 20)), (0, (200, 201, 20), (217, 218, 20)),
                (1, (200, 201, 20), (204, 204, 50), (214, 215, 20)),
                (2, (200, 201, 20), (204, 204, 50), (207, 207, 40), (214, 215, 20)),
                (5, (200, 201, 20), (204, 204, 50), (207, 207, 40), (210, 210, 60), (214, 215, 20)),
                # 4: what is partly hidden, behind segments that are no trunks too
                (1, (200, 202, 10), (203, 203, 20)), (1, (200, 200, 20), (201, 203, 10)),
                (2, (200, 202, 10), (205, 205, 20)),
                (1, (190, 191, 10), (194, 196, 10), (197, 197, 20)),
                (0, (180, 181, 10), (193, 196, 10), (197, 197, 20)),
                # 5: a short chord, far from the vehicle and the edges
                (1, (200, 211, 10)), (0, (200, 212, 10)), (1, (200, 201, 1.1)),
                (0, (200, 201, 1.0)), (1, (6, 8, 10)), (0, (5, 8, 10)), (1, (352, 354, 10)),
                (0, (352, 355, 10)),
                # 7: surfaces that lead away
                (1, (200, 202, 10), (203, 203, 10 + 0.9 * third)),
                (0, (200, 202, 10), (203, 203, 10 + 1.1 * third))):
            self.assertEqual(len(trees(*surfaces)), count, surfaces)
        self.assertLess(trees((200, 202, 10), (203, 203, 20))[0][0], 11)
        self.assertLess(trees((200, 200, 20), (201, 203, 10))[0][0], 11)


class Reflectors(unittest.TestCase):
    @staticmethod
    def poles(echoes):
        """In a sweep of walls at 5 m with bright echoes {beam: range}."""
        ranges = np.full(conversion.LASER_BEAMS, 5.0)
        intensities = np.zeros(conversion.LASER_BEAMS)
        for beam, distance in echoes.items():
            ranges[beam], intensities[beam] = distance, 8192
        return car_park.detect_reflectors(ranges, intensities)

    def test_have_mean_range_and_angle_of_bright_echoes(self):
        (distance, bearing), = self.poles({200: 10.0, 201: 10.2, 203: 10.1})
        self.assertAlmostEqual(distance, 10.1 + 0.03, 12)
        self.assertAlmostEqual(bearing, (604 / 3 - 180) * HALF_DEGREE, 12)

    def test_are_parted_by_angle_and_range(self):
        for count, echoes in ((1, {200: 10.0, 203: 10.0}), (2, {200: 10.0, 204: 10.0}),
                              (1, {200: 10.0, 201: 11.0}), (2, {200: 10.0, 201: 11.01}),
                              (0, {}), (0, {200: 80.0})):
            self.assertEqual(len(self.poles(echoes)), count, echoes)


if __name__ == "__main__":
    unittest.main()
