# SPDX-License-Identifier: BSD-3-Clause
"""A filter in Python as a cell of a montecarta study; copy this file beside yours.

    class MyFilter(montecarta_filter.Filter): ...
    montecarta_filter.serve(MyFilter())

Python's own library alone; numpy arrays and numbers may be answered as they are. What the filter
prints goes to standard error, since standard output belongs to the answers.
"""
import json
import os
import sys


class Filter:
    """What to write. Lengths in m, angles in rad, time in s."""

    def start(self, pose, settings, run, seed):
        """A run begins at `pose` [x, y, heading], known exactly, with an empty map.

        Forget every earlier run. `settings`: dict of vehicle and noise as the study has the filter
        believe them. `seed`: for a random generator; the same for the same study and run.
        """
        raise NotImplementedError

    def predict(self, speed, steer, duration):
        """The vehicle drove at `speed` [m/s] with its wheel at `steer` [rad] for `duration` [s].

        Other vehicles have other controls: those that settings["controls"] names, then `duration`.
        """
        raise NotImplementedError

    def update(self, detections):
        """The sensor saw `detections`, a list of [range, bearing, identity], perhaps empty.

        Identity -1: a false alarm, or, where settings["association"] is "nearest", unknown.
        """
        raise NotImplementedError

    def estimate(self):
        """What is believed now: mean (x, y, heading) and its 3 x 3 covariance; changes nothing."""
        raise NotImplementedError

    def report(self):
        """Of the last update: a dict of log_likelihood, nis, nis_dof, ess, map_size, or some."""
        return {}

    def map(self):
        """Landmarks as rows (identity, x, y, xx, xy, yy) with the covariance; else by
        initialisation."""
        return []


def _answer(filter, message):
    """What to say to a message, without its number."""
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
    """Answers montecarta's messages until there are no more."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    encode = json.JSONEncoder(default=lambda array: array.tolist()).encode
    while line := sys.stdin.buffer.readline():
        message = json.loads(line.decode())
        answers.write(encode({"id": message["id"], **_answer(filter, message)}) + "\n")
        answers.flush()
