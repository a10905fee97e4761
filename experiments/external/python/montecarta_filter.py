# SPDX-License-Identifier: BSD-3-Clause
"""Runs a filter in Python as a cell of a montecarta study. Copy this file beside yours.

    class MyFilter(montecarta_filter.Filter): ...
    montecarta_filter.serve(MyFilter())

Needs only Python's standard library. The filter may return numpy arrays and numbers.
"""
import json
import os
import sys


class Filter:
    """The interface of a filter. Lengths are in m, angles in rad, times in s.

    What print() writes goes to standard error, since standard output is reserved for the answers.
    montecarta shows only the last line of it, as the reason if the program ends. To see all of it,
    send it to a file: command="sh -c 'python3 mine.py 2>>log.txt'".
    """

    def start(self, pose, settings, run, seed):
        """Starts a run at `pose` [x, y, heading], which is known exactly, with an empty map.

        Must reset all state of earlier runs. `settings` is a dict of the vehicle and the noise that
        the filter should assume. `seed` is for a random generator, and depends on study and run.
        """
        raise NotImplementedError

    def predict(self, speed, steer, duration):
        """Predicts a drive at `speed` [m/s] with the wheel at `steer` [rad] for `duration` [s].

        Other vehicles have other controls: those that settings["controls"] names, then `duration`.
        """
        raise NotImplementedError

    def update(self, detections):
        """Updates with `detections`, a list of [range, bearing, identity] that may be empty.

        Identity -1 means a false alarm or, if settings["association"] is "nearest", unknown.
        """
        raise NotImplementedError

    def estimate(self):
        """Returns the mean (x, y, heading) and its 3 x 3 covariance. Must not change the filter."""
        raise NotImplementedError

    def report(self):
        """Returns a dict with any of log_likelihood, nis, nis_dof, ess, map_size of the update."""
        return {}

    def map(self):
        """Returns landmarks as rows (identity, x, y, xx, xy, yy), where xx, xy, yy are the
        covariance. With unknown association the identity is the order of initialisation."""
        return []


def _answer(filter, message):
    """Returns the answer to a message, without its id."""
    if message["type"] == "start":
        filter.start(message["start"], message["settings"], message["run"], message["seed"])
        return {}
    if message["type"] == "map":
        return {"map": filter.map()}
    for control in message["controls"]:
        filter.predict(*control)
    report = {}
    if message["type"] == "scan":
        filter.update(message["detections"])
        report = filter.report()
    mean, covariance = filter.estimate()
    return {"mean": mean, "covariance": covariance, **report}


def serve(filter):
    """Answers the messages of montecarta until its input ends."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    encode = json.JSONEncoder(default=lambda array: array.tolist()).encode
    while line := sys.stdin.buffer.readline():
        message = json.loads(line.decode())
        answers.write(encode({"id": message["id"], **_answer(filter, message)}) + "\n")
        answers.flush()
