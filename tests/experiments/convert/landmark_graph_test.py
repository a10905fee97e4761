# SPDX-License-Identifier: BSD-3-Clause
"""A small graph of poses and landmarks in the formats of g2o and TORO."""
import math
import unittest

from scripts import Scripts, np, path_of

import landmark_graph

STEPS = [(1.0, 0.0, 0.0), (1.0, 0.25, 0.5), (0.5, -0.25, -1.0), (-0.5, 0.125, 3.0)]
LANDMARKS = {7782220156096217089: (4.0, 1.0), 7782220156096217088: (0.0, 3.0)}  # as GTSAM has ids
INFORMATION = np.diag([1 / 0.04, 1 / 0.01, 1 / 0.0025])


def after(pose, step):
    x, y, heading = pose
    c, s = math.cos(heading), math.sin(heading)
    return (x + c * step[0] - s * step[1], y + s * step[0] + c * step[1], heading + step[2])


def seen_from(pose, point):
    dx, dy = point[0] - pose[0], point[1] - pose[1]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return c * dx + s * dy, c * dy - s * dx


def line(tag, *fields):
    return " ".join([tag, *map(repr, fields)]) + "\n"


class LandmarkGraph(Scripts):
    """Poses 10 to 50 from (2, 1, 0.5) on; both landmarks are seen from every pose."""

    def setUp(self):
        super().setUp()
        self.poses = [(2.0, 1.0, 0.5)]
        for step in STEPS:
            self.poses.append(after(self.poses[-1], step))
        self.write("graph.g2o", self.graph())
        self.arguments = {"graph": self.path("graph.g2o"), "output": self.path("log"),
                          "sensor": "position", "truth": None}

    def graph(self, pose="VERTEX_SE2", motion="EDGE_SE2", order=(0, 1, 2, 4, 5, 8),
              is_swapped=False):
        upper = [float(one) for one in INFORMATION.ravel()[list(order)]]
        text = "".join(line(pose, 10 * (k + 1), *one) for k, one in enumerate(self.poses))
        text += "".join(line("VERTEX_XY", one, *place) for one, place in LANDMARKS.items())
        text += "FIX 10\nPARAMS_SE2OFFSET 0 0 0 0\n"
        for k, step in enumerate(STEPS):
            ids = (10 * (k + 2), 10 * (k + 1)) if is_swapped else (10 * (k + 1), 10 * (k + 2))
            text += line(motion, *ids, *step, *upper)
        for k, one in enumerate(self.poses):
            for landmark, place in LANDMARKS.items():
                text += line("EDGE_SE2_XY", 10 * (k + 1), landmark, *seen_from(one, place),
                             100.0, 0.0, 25.0)
        return text

    def expect_the_path(self, printed):
        self.assertIn("4 motions of 1 s each", printed)
        found = path_of(self.numbers("log/start.csv")[0], self.numbers("log/odometry.csv"),
                        [1, 2, 3, 4])
        np.testing.assert_allclose(found, self.poses[1:], rtol=0, atol=1e-5)

    def test_moves_along_its_edges(self):
        self.expect_the_path(self.converted(landmark_graph, **self.arguments))
        self.assertEqual(self.rows("log/start.csv"), [["0", "2", "1", "0.5"]])
        self.assertEqual(len(self.rows("log/odometry.csv")), 5)

    def test_is_read_in_the_format_of_toro(self):
        self.write("graph.g2o", self.graph("VERTEX2", "EDGE2", (0, 1, 4, 8, 2, 5)))
        printed = self.converted(landmark_graph, **self.arguments)
        self.expect_the_path(printed)
        self.assertIn("sigma_forward = 0.2\nsigma_left = 0.1\nsigma_yaw_rate_deg = 2.86\n", printed)

    def test_has_positions_or_ranges_and_bearings(self):
        self.assertIn("identities 0 to 1 are the landmarks 7782220156096217088 to "
                      "7782220156096217089", self.converted(landmark_graph, **self.arguments))
        found = self.numbers("log/detections.csv")
        self.assertEqual([row[0] for row in found], [0, 0, 1, 1, 2, 2, 3, 3, 4, 4])
        for time, forward, left, identity in found:
            place = LANDMARKS[7782220156096217088 + int(identity)]
            self.assertEqual((forward, left), seen_from(self.poses[int(time)], place))
        self.converted(landmark_graph, **{**self.arguments, "sensor": "range_bearing",
                                          "output": self.path("polar")})
        for (_, x, y, one), (_, distance, bearing, same) in zip(
                found, self.numbers("polar/detections.csv")):
            self.assertAlmostEqual(distance * math.cos(bearing), x, 12)
            self.assertAlmostEqual(distance * math.sin(bearing), y, 12)
            self.assertEqual(one, same)

    def test_suggests_the_noise_of_the_information(self):
        printed = self.converted(landmark_graph, **self.arguments)
        for text in ("sigma_forward = 0.2\nsigma_left = 0.1\nsigma_yaw_rate_deg = 2.86\n",
                     "sigma_position_forward = 0.1\nsigma_position_left = 0.2\n"):
            self.assertIn(text, printed)
        text = line("VERTEX_SE2", 1, 0.0, 0.0, 0.0) + line(
            "EDGE_SE2", 1, 2, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0)
        ahead = line("EDGE_SE2_XY", 2, 3, 0.0, 4.0, 100.0, 0.0, 25.0)  # to the left: x is across
        self.write("graph.g2o", text + ahead)
        printed = self.converted(landmark_graph, **{**self.arguments, "sensor": "range_bearing",
                                                    "output": self.path("polar")})
        self.assertIn("sigma_range = 0.2\nsigma_bearing_deg = 1.43\n", printed)
        self.write("graph.g2o", text + ahead.replace("25.0", "0.0"))
        self.assertIn("no noise is suggested",
                      self.converted(landmark_graph, **{**self.arguments,
                                                        "output": self.path("singular")}))

    def test_turns_an_edge_to_the_pose_before(self):
        x, y, turn = STEPS[1]
        c, s = math.cos(turn), math.sin(turn)
        kept = self.graph().splitlines(keepends=True)
        place = next(k for k, one in enumerate(kept) if one.startswith("EDGE_SE2 20 30"))
        kept[place] = line("EDGE_SE2", 30, 20, -c * x - s * y, s * x - c * y, -turn,
                           *[1.0, 0.0, 0.0, 1.0, 0.0, 1.0])
        self.write("graph.g2o", "".join(kept))
        self.expect_the_path(self.converted(landmark_graph, **self.arguments))

    def test_has_the_information_of_a_turned_edge(self):
        edge = [2.0, 1.0, 0.75, *np.diag([4.0, 9.0, 16.0]).ravel()]
        graph = landmark_graph.Graph.__new__(landmark_graph.Graph)
        graph.path, graph.motions = "graph", {(2, 1): edge}
        step, information = landmark_graph.motion(graph, 1, 2)
        draws = np.random.default_rng(1).normal(size=(20000, 3)) / [2, 3, 4] * 1e-3
        turned = np.array([landmark_graph.motion(
            self._with(graph, [a, b, c, *edge[3:]]), 1, 2)[0] for a, b, c in draws + edge[:3]])
        np.testing.assert_allclose(np.cov((turned - step).T) * 1e6, np.linalg.inv(information),
                                   rtol=0, atol=0.01)

    @staticmethod
    def _with(graph, edge):
        graph.motions = {(2, 1): edge}
        return graph

    def test_leaves_loops_and_repeated_edges_out_and_counts_them(self):
        more = line("EDGE_SE2", 10, 50, 0.0, 0.0, 0.0, *[1.0] * 6)
        more += line("EDGE_SE2", 10, 20, 9.0, 0.0, 0.0, *[1.0] * 6)
        more += line("EDGE_SE2_XY", 10, min(LANDMARKS), 9.0, 9.0, 1.0, 0.0, 1.0)
        self.write("graph.g2o", self.graph() + more)
        printed = self.converted(landmark_graph, **self.arguments)
        self.expect_the_path(printed)
        self.assertIn("that are left out: 1 others, 1 repeated", printed)
        self.assertIn("10 rows; ", printed)
        self.assertIn("1 of a landmark that the scan has before, left out", printed)

    def test_has_the_true_vertices_as_reference(self):
        self.write("truth.g2o", self.graph().replace("VERTEX_SE2 10 2.0", "VERTEX_SE2 10 2.5"))
        self.converted(landmark_graph, **{**self.arguments, "truth": self.path("truth.g2o")})
        truth = self.numbers("log/reference_truth.csv")
        self.assertEqual(truth[0], [0, 2.5, 1, 0.5])
        np.testing.assert_allclose(np.array(truth)[1:, 1:], self.poses[1:])
        self.assertEqual(self.rows("log/start.csv"), [["0", "2.5", "1", "0.5"]])
        self.assertEqual(self.rows("log/landmarks.csv"), [["0", "3"], ["4", "1"]])
        self.write("truth.g2o", line("VERTEX_SE2", 10, 0.0, 0.0, 0.0))
        self.expect_refused(landmark_graph, ["truth.g2o", "no vertex of pose 20"], **{
            **self.arguments, "output": self.path("new"), "truth": self.path("truth.g2o")})

    def test_refuses_edges_that_lead_backwards(self):
        self.write("graph.g2o", self.graph(is_swapped=True))
        self.expect_refused(landmark_graph, ["graph.g2o", "from the second pose to the first",
                                             "exchange the two ids"], **self.arguments)

    def test_names_file_and_line_of_a_mistake(self):
        good = self.graph()
        end = f":{good.count(chr(10)) + 1}"
        for text, *pieces in (
                ("EDGE_SE3 1 2\n", end, "'EDGE_SE3' is no tag"),
                ("EDGE_SE2 10\n", end, "ends within the ids"),
                ("EDGE_SE2 10 50 1 2 3 1 0 0\n", end, "6 numbers of 9"),
                ("EDGE_SE2_XY 10 1.5 1 2 3 1 0\n", end, "'1.5' is no whole number"),
                ("EDGE_SE2_XY 10 20 1 2 1 0 1\n", end, "an edge from 10 to 20"),
                ("EDGE_SE2_XY 11 90 1 2 1 0 1\n", end, "an edge from 11 to 90"),
                ("VERTEX_XY 90 1 up\n", end, "'up'", "(it is the y)"),
                ("VERTEX_XY 10 1 2\n", end, "vertex 10 twice"),
                ("VERTEX_SE2 60 1 2 0\n", "no edge between the poses 50 and 60"),
                ("VERTEX_XY 90 1 2", end, "no end")):
            self.write("graph.g2o", good + text)
            self.expect_refused(landmark_graph, ["graph.g2o", *pieces], **self.arguments)
        self.write("graph.g2o", line("VERTEX_SE2", 10, 0.0, 0.0, 0.0))
        self.expect_refused(landmark_graph, ["graph.g2o", "1 poses and 0 edges"], **self.arguments)
        self.arguments["graph"] = self.path("no.g2o")
        self.expect_refused(landmark_graph, ["no.g2o", "cannot be opened"], **self.arguments)

    def test_writes_the_same_bytes_twice_and_overwrites_nothing(self):
        self.expect_same_bytes_twice(landmark_graph, **self.arguments)


if __name__ == "__main__":
    unittest.main()
