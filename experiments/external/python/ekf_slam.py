# SPDX-License-Identifier: BSD-3-Clause
"""EKF-SLAM with known association (EQUATIONS 1, 2, 15). Gives the numbers of the cell ekf_slam."""
import math

import numpy as np

import montecarta_filter


def wrapped(angle):
    return math.remainder(angle, 2 * math.pi)


class EkfSlam(montecarta_filter.Filter):
    def start(self, pose, settings, run, seed):
        if settings["association"] != "known" or settings["vehicle"] != "front_axle":
            raise ValueError("for known association and vehicle = front_axle only")
        self.wheelbase = settings["wheelbase"]
        self.Q = np.diag([settings["sigma_speed"], settings["sigma_steer"]]) ** 2
        self.R = np.diag([settings["sigma_range"], settings["sigma_bearing"]]) ** 2
        self.m = np.array(pose)  # pose, then x and y of each landmark in order of initialisation
        self.P = np.zeros((3, 3))
        self.row_of = {}  # index of a landmark in m and P, by identity
        self.said = {}

    def predict(self, speed, steer, duration):
        c = self.m[2] + steer
        way = speed * duration
        dx, dy = way * math.cos(c), way * math.sin(c)
        F = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]])
        G = duration * np.array([[math.cos(c), -speed * math.sin(c)],
                                 [math.sin(c), speed * math.cos(c)],
                                 [math.sin(steer) / self.wheelbase,
                                  speed * math.cos(steer) / self.wheelbase]])
        self.m[:3] += dx, dy, way * math.sin(steer) / self.wheelbase
        self.m[2] = wrapped(self.m[2])
        self.P[:3, :] = F @ self.P[:3, :]
        self.P[:, :3] = self.P[:, :3] @ F.T
        self.P[:3, :3] += G @ self.Q @ G.T

    def update(self, detections):
        self.said = {"log_likelihood": 0.0, "nis": 0.0, "nis_dof": 0}
        seen_before = dict(self.row_of)
        for r, b, identity in detections:
            if identity in seen_before:
                self.update_with(r, b, seen_before[identity])
        for r, b, identity in detections:
            if identity >= 0 and identity not in seen_before:
                self.append(r, b, identity)
        self.said["map_size"] = len(self.row_of)

    def update_with(self, r, b, row):
        dx, dy = self.m[row:row + 2] - self.m[:2]
        d = math.hypot(dx, dy)
        Hf = np.array([[dx / d, dy / d], [-dy / d**2, dx / d**2]])
        H = np.zeros((2, len(self.m)))
        H[:, :2], H[1, 2], H[:, row:row + 2] = -Hf, -1, Hf
        v = np.array([r - d, wrapped(b - (math.atan2(dy, dx) - self.m[2]))])
        PHt = self.P @ H.T
        S = H @ PHt + self.R
        K = np.linalg.solve(S, PHt.T).T
        self.m += K @ v
        self.m[2] = wrapped(self.m[2])
        self.P -= K @ PHt.T
        self.P = (self.P + self.P.T) / 2
        nis = v @ np.linalg.solve(S, v)
        self.said["nis"] += nis
        self.said["nis_dof"] += 2
        self.said["log_likelihood"] -= 0.5 * (nis + math.log(np.linalg.det(2 * math.pi * S)))

    def append(self, r, b, identity):
        c, s = math.cos(self.m[2] + b), math.sin(self.m[2] + b)
        Gx = np.array([[1, 0, -r * s], [0, 1, r * c]])
        Gz = np.array([[c, -r * s], [s, r * c]])
        cross = Gx @ self.P[:3, :]
        own = cross[:, :3] @ Gx.T + Gz @ self.R @ Gz.T
        self.P = np.block([[self.P, cross.T], [cross, own]])
        self.row_of[identity] = len(self.m)
        self.m = np.append(self.m, self.m[:2] + (r * c, r * s))

    def estimate(self):
        return self.m[:3], self.P[:3, :3]

    def report(self):
        return self.said

    def map(self):
        return [[identity, *self.m[i:i + 2], self.P[i, i], self.P[i, i + 1], self.P[i + 1, i + 1]]
                for identity, i in self.row_of.items()]


if __name__ == "__main__":
    montecarta_filter.serve(EkfSlam())
