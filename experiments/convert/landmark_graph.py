#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a graph of poses and landmarks in the plane, as g2o and TORO write it, to the CSV log of
montecarta.

    python3 landmark_graph.py GRAPH.g2o -o graph_log
    python3 landmark_graph.py GRAPH.g2o -o graph_log --truth TRUE_GRAPH.g2o

The edges EDGE_SE2 (or EDGE2) of consecutive poses are the odometry, each for 1 s, since a graph has
no times. The edges EDGE_SE2_XY are the detections, as positions, or with --sensor range_bearing as
ranges and bearings. Other edges between poses, which close loops, are left out and counted. The
vertices VERTEX_SE2 (or VERTEX2) and VERTEX_XY of TRUE_GRAPH are the reference and the landmarks;
the graph itself may be named there if its vertices are true. The noise that the information
matrices stand for is printed. See experiments/RECORDED_DRIVES.md.
"""
import math

import conversion
import robot_log
from conversion import ConversionError, np

POSE = ("x", "y", "heading")
POINT = ("x", "y")
MATRIX = tuple(f"element {k} of the information" for k in range(1, 7))
KINDS = {"VERTEX_SE2": "pose", "VERTEX2": "pose", "VERTEX_XY": "landmark", "EDGE_SE2": "motion",
         "EDGE2": "motion", "EDGE_SE2_XY": "detection", "FIX": None,
         "PARAMS_SE2OFFSET": None}  # these edges have no sensor that is mounted elsewhere
IDS = {"pose": ("pose",), "landmark": ("landmark",), "motion": ("first pose", "second pose"),
       "detection": ("pose", "landmark")}
NUMBERS = {"pose": POSE, "landmark": POINT, "motion": (*POSE, *MATRIX),
           "detection": (*POINT, *MATRIX[:3])}
# Where the six numbers of an information matrix of x, y and heading are: g2o writes its upper
# triangle row by row, TORO xx, xy, yy, hh, xh, yh.
ORDER = {"EDGE_SE2": [[0, 1, 2], [1, 3, 4], [2, 4, 5]], "EDGE2": [[0, 1, 4], [1, 2, 5], [4, 5, 3]]}


class Graph:
    """The vertices and edges of a file."""

    def __init__(self, path):
        self.path, self.poses, self.landmarks = path, {}, {}
        self.motions = {}      # {(first, second): [forward, left, turn, *information]}, 3 + 9
        self.detections = []   # (line, pose, landmark, [x, y, *information]), 2 + 4
        self.repeated = 0      # further edges between the same two poses
        for line, (tag, *words) in robot_log.lines_of(path):
            place = f"{path}:{line}"
            if tag not in KINDS:
                raise ConversionError(f"{place}: '{tag[:40]}' is no tag that is read ("
                                      f"{', '.join(KINDS)} are): leave out the line if the drive "
                                      "does without it")
            if KINDS[tag] is not None:
                self._add(KINDS[tag], tag, words, line)

    def _add(self, kind, tag, words, line):
        place = f"{self.path}:{line}"
        names = IDS[kind]
        if len(words) < len(names):
            raise ConversionError(f"{place}: {len(words)} fields (the line ends within the ids): "
                                  "take the whole file")
        ids = tuple(robot_log.whole_number(word, name, place) for word, name in zip(words, names))
        numbers = robot_log.numbers_of(words[len(names):], NUMBERS[kind], place)
        if kind in ("pose", "landmark"):
            if ids[0] in self.poses or ids[0] in self.landmarks:
                raise ConversionError(f"{place}: vertex {ids[0]} twice (each has one line): leave "
                                      "one out")
            (self.poses if kind == "pose" else self.landmarks)[ids[0]] = numbers
        elif kind == "motion":
            information = np.array(numbers[3:])[ORDER[tag]].ravel()
            self.repeated += ids in self.motions
            self.motions.setdefault(ids, [*numbers[:3], *information])
        else:
            a, b, c = numbers[2:]
            self.detections.append((line, *ids, [*numbers[:2], a, b, b, c]))

    def drive(self):
        """The ids of all poses in their order."""
        ids = sorted({*self.poses, *(one for edge in self.motions for one in edge)})
        if len(ids) < 2 or not self.detections:
            raise ConversionError(f"{self.path}: {len(ids)} poses and {len(self.detections)} "
                                  "edges EDGE_SE2_XY (a drive has motions and detections of "
                                  "landmarks): give the whole graph of poses and landmarks")
        return ids


def motion(graph, first, second):
    """The step (forward, left, turn) between consecutive poses and its information {3, 3}. An
    edge from the second to the first is inverted."""
    if (first, second) in graph.motions:
        edge = graph.motions[first, second]
        return edge[:3], np.reshape(edge[3:], (3, 3))
    if (second, first) not in graph.motions:
        raise ConversionError(f"{graph.path}: no edge between the poses {first} and {second} "
                              "(consecutive poses have one, the odometry): add it")
    x, y, turn, *information = graph.motions[second, first]
    c, s = math.cos(turn), math.sin(turn)
    step = [-c * x - s * y, s * x - c * y, -turn]
    back = np.linalg.inv([[-c, -s, step[1]], [s, -c, -step[0]], [0, 0, -1]])  # of its derivative
    return step, back.T @ np.reshape(information, (3, 3)) @ back


def check_direction(graph, ids, steps):
    """Raises ConversionError if the vertices agree with the steps only from the second to the first
    pose of each edge. Some descriptions of TORO name the observed vertex first."""
    if not all(one in graph.poses for one in ids):
        return
    poses = np.array([graph.poses[one] for one in ids])
    moved = poses[1:, :2] - poses[:-1, :2]

    def misfit(headings, sign):
        c, s = np.cos(headings), np.sin(headings)
        own = np.column_stack([c * moved[:, 0] + s * moved[:, 1],
                               c * moved[:, 1] - s * moved[:, 0]])
        return np.median(np.hypot(*(own - sign * np.array(steps)[:, :2]).T))

    forward, backward = misfit(poses[:-1, 2], 1), misfit(poses[1:, 2], -1)
    if backward < 0.1 * forward:
        raise ConversionError(f"{graph.path}: the vertices agree with edges that lead from the "
                              f"second pose to the first (misfit {backward:.3g} m, in the order of "
                              f"g2o {forward:.3g} m): exchange the two ids of every edge")


def deviations(information):
    """Medians of the standard deviations that information matrices {edge, d, d} stand for; None if
    one of them is not positive definite."""
    if not (np.linalg.eigvalsh(information) > 0).all():
        return None
    return np.sqrt(np.median(np.einsum("kii->ki", np.linalg.inv(information)), axis=0))


def suggest(motions, detections, sensor):
    """Prints the noise of information matrices of the motions {edge, 3, 3} and of the detections
    {edge, 2, 2}."""
    motion_noise, detection_noise = deviations(motions), deviations(detections)
    if motion_noise is None or detection_noise is None:
        print("no noise is suggested, since an information matrix is not positive definite")
        return
    names = (("sigma_position_forward", "sigma_position_left") if sensor == "position" else
             ("sigma_range", "sigma_bearing_deg"))
    robot_log.suggest({"vehicle": "omnidirectional", "sigma_forward": motion_noise[0],
                       "sigma_left": motion_noise[1],
                       "sigma_yaw_rate_deg": math.degrees(motion_noise[2]), "sensor": sensor,
                       names[0]: detection_noise[0],
                       names[1]: detection_noise[1] if sensor == "position" else
                       math.degrees(detection_noise[1])}, "medians of the information matrices")


def detections_in(graph, ids, sensor):
    """The detections [(line, time, landmark, components), ...] and their information {edge, 2, 2}.
    """
    time_of = {one: k for k, one in enumerate(ids)}
    found, informations = [], []
    for line, pose, landmark, (x, y, *information) in graph.detections:
        if pose not in time_of or landmark in time_of:
            raise ConversionError(f"{graph.path}:{line}: an edge from {pose} to {landmark} (it "
                                  "leads from a pose of the drive to a landmark): correct the ids")
        seen, information = (x, y), np.reshape(information, (2, 2))
        if sensor == "range_bearing":
            distance, bearing = math.hypot(x, y), math.atan2(y, x)
            c, s = math.cos(bearing), math.sin(bearing)
            turned = np.array([[c, -distance * s], [s, distance * c]])
            seen, information = (distance, bearing), turned.T @ information @ turned
        found.append((line, time_of[pose], landmark, seen))
        informations.append(information)
    return found, np.array(informations)


def true_path(path, ids):
    """The reference, rows (time, x, y, heading), and the landmarks {id: (x, y)}, of true vertices.
    """
    truth = Graph(path)
    missing = [one for one in ids if one not in truth.poses]
    if missing:
        raise ConversionError(f"{path}: no vertex of pose {missing[0]} (the truth has all poses of "
                              "the graph): give the true graph of the same drive")
    return [(time, *truth.poses[one]) for time, one in enumerate(ids)], truth.landmarks


def convert(arguments):
    graph = Graph(arguments.graph)
    ids = graph.drive()
    steps, information = zip(*(motion(graph, *pair) for pair in zip(ids, ids[1:])))
    check_direction(graph, ids, steps)
    found, of_detections = detections_in(graph, ids, arguments.sensor)
    reference, places = true_path(arguments.truth, ids) if arguments.truth else ([], {})
    detections, landmarks = robot_log.detections_of(arguments.graph, found, places,
                                                    arguments.truth if places else None)
    if arguments.sensor == "range_bearing":
        robot_log.check_ranges(detections, 2)
    start = reference[0] if reference else (0, *graph.poses.get(ids[0], (0, 0, 0)))
    columns = ("forward_m,left_m" if arguments.sensor == "position" else "range_m,bearing_rad")
    conversion.write_log(arguments.output, start, robot_log.odometry_of(steps),
                         robot_log.scans_of(detections), {"truth": reference} if reference else {},
                         landmarks, robot_log.OMNIDIRECTIONAL, columns + ",identity")
    robot_log.report(detections)
    print(f"{len(steps)} motions of 1 s each, since a graph has no times; edges between poses that "
          f"are left out: {len(graph.motions) - len(steps)} others, {graph.repeated} repeated: "
          f"{arguments.output}")
    suggest(np.array(information), of_detections, arguments.sensor)


if __name__ == "__main__":
    parser = conversion.parser_of(__doc__)
    parser.add_argument("graph", metavar="GRAPH", help="the graph, in the format of g2o or TORO")
    parser.add_argument("--sensor", choices=("position", "range_bearing"), default="position",
                        help="the sensor of the log (default: %(default)s)")
    parser.add_argument("--truth", metavar="TRUE_GRAPH",
                        help="a graph of the same ids whose vertices are true")
    robot_log.add_options(parser, is_sorted=False)
    conversion.run(convert, parser.parse_args())
