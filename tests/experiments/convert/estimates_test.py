# SPDX-License-Identifier: BSD-3-Clause
"""Estimates and truths of other programs, one small file for each layout and each damage."""
import contextlib
import io
import os
import unittest

from scripts import Scripts, np, savemat

import estimates
from conversion import ConversionError

QUATERNION = np.array([-0.3, 0.7, 0.2, 0.5]) / np.linalg.norm([-0.3, 0.7, 0.2, 0.5])
POSE = [1.0, 2.0, 3.0, *QUATERNION]
TURN = np.array([  # of QUATERNION, written otherwise than in the script: rotated unit vectors
    v + 2 * np.cross(QUATERNION[:3], np.cross(QUATERNION[:3], v) + QUATERNION[3] * v)
    for v in np.eye(3)]).T
WHOLE = np.diag([4.0, 5, 6, 7, 8, 9]) + 0.1 * np.arange(36).reshape(6, 6) / 36
WHOLE = (WHOLE + WHOLE.T) / 2
BLOCKS = np.where(np.arange(6)[:, None] // 3 == np.arange(6) // 3, WHOLE, 0.0)
UPPER, LOWER, UPPER3 = np.triu_indices(6), np.tril_indices(6), np.triu_indices(3)
POSITION, ROTATION = WHOLE[:3, :3][UPPER3], WHOLE[3:, 3:][UPPER3]

TUM = "# timestamp tx ty tz qx qy qz qw\n"
OPEN_VINS = ("# timestamp(s) tx ty tz qx qy qz qw Pr11 Pr12 Pr13 Pr22 Pr23 Pr33 Pt11 Pt12 Pt13 "
             "Pt22 Pt23 Pt33\n")
EUROC = ("#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],"
         "q_RS_z []\n")
CNSPY = "t,tx,ty,tz,qx,qy,qz,qw,pxx,pxy,pxz,pyy,pyz,pzz,qrr,qrp,qry,qpp,qpy,qyy"
CNSPY_WHOLE = "#t,tx,ty,tz,qx,qy,qz,qw," + ",".join(
    "T" + "xyzabc"[i] + "xyzabc"[j] for i, j in zip(*UPPER)) + "\n"
ROS = ("%time,field.header.seq,field.header.stamp,field.header.frame_id,"
       + ",".join(f"field.pose.pose.position.{a}" for a in "xyz") + ","
       + ",".join(f"field.pose.pose.orientation.{a}" for a in "xyzw") + ","
       + ",".join(f"field.pose.covariance{k}" for k in range(36)) + ",field.twist.covariance0\n")
SQUARE = """#%FORMAT SQUARE/0.3
#%REPRESENTATION gaussian_se3
#%POSE_FRAME world
#%BODY_FRAME imu
#%GAUGE gravity_yaw
#%TIMESTAMP_UNIT seconds
#%TANGENT_CONVENTION right_perturbation
#%TANGENT_ORDER rotation_translation
"""


def row(*values, separator=" "):
    """A line of numbers and words."""
    flat = np.concatenate([np.ravel(np.asarray(value, dtype=object)) for value in values])
    return separator.join(str(one) for one in flat) + "\n"


def comma(*values):
    return row(*values, separator=",")


class Estimates(Scripts):
    def converted(self, script, **arguments):
        """Runs the script; what it says is kept in self.said."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            script.convert(estimates.Options(**arguments))
        self.said = said.getvalue()

    def convert(self, text, name="e.txt", kind="estimate", **options):
        """[(time, state, covariance)] of a file with this text."""
        self.write(name, text)
        self.number = getattr(self, "number", 0) + 1
        folder = self.path(f"out_{self.number}")
        self.converted(estimates, kind=kind, files=[self.path(name)], output=folder, **options)
        output, = os.listdir(folder)
        self.header = self.lines(folder, output)[0].split(",")
        d = len([one for one in self.header if one.startswith("cov_")])
        rows = [(one[0], np.array(one[1:len(one) - d], dtype=float),
                 np.array(one[len(one) - d:], dtype=float).reshape(2 * (int(d**0.5),)))
                for one in self.rows(folder, output)]
        return rows

    def lines(self, *names):
        with open(self.path(*names), encoding="utf-8") as file:
            return file.read().splitlines()

    def expect_refusal(self, text, *pieces, name="e.txt", kind="estimate", **options):
        self.write(name, text)
        self.expect_refused(estimates, pieces, kind=kind, files=[self.path(name)],
                            output=self.path("refused"), **options)

    def expect(self, text, covariance, *said, time="1.5", pose=POSE, **options):
        """A file of one estimate has this covariance and pose; the script says so."""
        (own_time, state, P), = self.convert(text, **options)
        self.assertEqual(own_time, time)
        np.testing.assert_allclose(state, pose, rtol=0, atol=1e-15)
        np.testing.assert_allclose(P, covariance, rtol=0, atol=1e-13)
        for piece in said:
            self.assertIn(piece, self.said)


class Layouts(Estimates):
    IN_MAP = np.block([[BLOCKS[:3, :3], np.zeros((3, 3))],
                       [np.zeros((3, 3)), TURN @ BLOCKS[3:, 3:] @ TURN.T]])

    def test_open_vins_is_rotation_first_in_the_body(self):
        line = row(1.5, POSE, ROTATION, POSITION)
        self.expect(OPEN_VINS + line, self.IN_MAP, "OpenVINS", "Pr11", "--error world")
        self.expect(line, self.IN_MAP, "OpenVINS", order="rotation-first")
        self.expect(row(1.5, POSE, POSITION, ROTATION), BLOCKS, order="position-first")
        self.expect_refusal("# timestamp\n" + line, "e.txt:2", "--order rotation-first",
                            "--order position-first")
        self.expect_refusal(OPEN_VINS + line, "--order", "leave", order="position-first")

    def test_blocks_are_read_by_the_names_of_their_columns(self):
        names = OPEN_VINS.split()
        exchanged = " ".join(names[:9] + names[15:] + names[9:15]) + "\n"
        self.expect(exchanged + row(1.5, POSE, POSITION, ROTATION), self.IN_MAP)

    def test_tum_has_covariances_beside(self):
        for numbers, how in ((WHOLE, "36 numbers"), (WHOLE[UPPER], "upper"),
                             (WHOLE[LOWER], "lower")):
            self.write("e.cov", row(1.5, numbers))
            self.expect(TUM + row(1.5, POSE), WHOLE, "TUM", how, "position-first by --order",
                        order="position-first")
            self.expect_refusal(TUM + row(1.5, POSE), "e.cov:1", "2, 2.24",
                                "--order position-first", "--order rotation-first")
        moved = np.roll(WHOLE, 3, (0, 1))
        self.write("e.cov", row(1.5, moved))
        self.expect(TUM + row(1.5, POSE), WHOLE, order="rotation-first")
        self.expect_refusal(CNSPY + "\n" + comma(1.5, POSE, POSITION, ROTATION), "e.txt", "e.cov",
                            "move one")
        self.write("e.cov", row(1.4, WHOLE))
        self.expect_refusal(TUM + row(1.5, POSE), "e.cov:1", "1.4", "e.txt:2")
        self.write("e.cov", row(1.5, WHOLE) + row(2.5, WHOLE))
        self.expect_refusal(TUM + row(1.5, POSE), "e.cov", "2 covariances of 1 poses")

    def test_wide_tum_is_known_by_the_triangle_that_is_a_covariance(self):
        first = {"order": "position-first"}
        self.expect(row(1.5, POSE, WHOLE), WHOLE, "wide TUM", "\nASSUMED of", "order xyzw",
                    "--quaternion wxyz", **first)
        self.expect(row(1.5, POSE, WHOLE[UPPER]), WHOLE, "upper", quaternion="xyzw", **first)
        self.assertNotIn("ASSUMED", self.said)
        for behind in ("", " cov"):  # a header of the pose alone
            self.expect(TUM.rstrip() + behind + "\n" + row(1.5, POSE, WHOLE), WHOLE, "wide TUM",
                        **first)
        self.expect_refusal("# timestamp tx ty tz qw qx qy qz\n" + row(1.5, POSE, WHOLE), "e.txt:2",
                            "44 fields", "a name for each column")
        self.expect(row(1.5, POSE, WHOLE[LOWER]), WHOLE, "lower", **first)
        self.expect_refusal(row(1.5, POSE, WHOLE), "e.txt:1", "--order position-first",
                            "--order rotation-first")
        self.expect_refusal(row(1.5, POSE, np.zeros(21)), "e.txt:1", "2 of 2", "--triangle upper",
                            "--triangle lower")
        self.expect_refusal(row(1.5, POSE, -np.ones(21)), "0 of 2", "--triangle upper")
        self.expect(row(1.5, POSE, np.arange(21.0)), np.array(
            [[0, 1, 2, 3, 4, 5], [1, 6, 7, 8, 9, 10], [2, 7, 11, 12, 13, 14],
             [3, 8, 12, 15, 16, 17], [4, 9, 13, 16, 18, 19], [5, 10, 14, 17, 19, 20]]),
            triangle="upper", **first)

    def test_euroc_has_nanoseconds_and_q_w_first(self):
        line = comma(1403636579763555584, POSE[:3], QUATERNION[3], QUATERNION[:3])
        blanks, first = EUROC.replace(",", " "), {"order": "position-first"}
        self.write("e.cov", row("1403636579763555584", WHOLE))
        for text in (EUROC + line, blanks + line.replace(",", " "),
                     "#timestamp p_x p_y p_z q_w q_x q_y q_z\n" + line.replace(",", " ")):
            self.expect(text, WHOLE, "EuRoC", "in ns", time="1403636579.763555584", **first)
            self.assertNotIn("ASSUMED", self.said)
        biases = line.replace("\n", "," + comma(np.zeros(9)))
        self.expect(biases, WHOLE, "17 numbers", "ASSUMED", "wxyz", time="1403636579.763555584",
                    **first)
        self.expect(line, WHOLE, quaternion="wxyz", time="1403636579.763555584", **first)
        last = row(1403636579763555584, POSE)
        self.expect(last, WHOLE, quaternion="xyzw", time="1403636579.763555584", **first)
        os.remove(self.path("e.cov"))
        for text in (line, line.replace("\n", "," + comma(WHOLE[UPPER]))):
            self.expect_refusal(text, "e.txt:1", "--quaternion wxyz", "--quaternion xyzw")

    def test_times_are_exact_and_their_unit_is_said(self):
        def time(word, **options):
            (own, *_), = self.convert(TUM + row(word, POSE), kind="truth", **options)
            return own
        self.assertEqual(time("1403636579763555"), "1403636579.763555")
        self.assertIn("in us by their size", self.said)
        self.assertEqual(time("1.403636579763555584e18"), "1403636579.763555584")
        self.assertEqual(time("1403636579.763555584"), "1403636579.763555584")
        self.assertNotIn("times are in", self.said)
        self.assertEqual(time("12500000000", time="ns"), "12.5")
        self.expect_refusal(TUM + row("12500000000", POSE), "e.txt:2", "--time ns", "--time s")
        self.expect_refusal(TUM + row("0", POSE) + row("5000000", POSE), "--time ns")
        self.expect_refusal(TUM.replace("stamp", "stamp(s)") + row("1403636579763555584", POSE),
                            "--time ns")

    def test_cnspy_declares_its_error(self):
        line = comma(1.5, POSE, POSITION, ROTATION)
        self.expect(CNSPY + "\n" + line, BLOCKS, "cnspy", "choose --error", "taken as 0")
        self.expect(CNSPY + ",type6,R_small_theta\n" + line, BLOCKS, "--error world")
        typed = CNSPY + ",est_err_type,err_representation\n"
        self.expect(typed + line.replace("\n", ",type5,theta_R\n"), self.IN_MAP, "--error world")
        self.expect(typed + line.replace("\n", ",type1,theta_R\n"), BLOCKS, "--error body")
        self.expect_refusal(typed + line.replace("\n", ",type1,rpy_degree\n"), "degrees")
        self.expect(CNSPY_WHOLE + comma(1.5, POSE, WHOLE[UPPER]), WHOLE, "cnspy")

    def test_square_declares_triangle_and_order(self):
        moved = np.roll(WHOLE, 3, (0, 1))
        self.expect(SQUARE + row(1.5, POSE, moved[LOWER]), WHOLE, "SQUARE",
                    "--error left-invariant", "--anchor yaw")
        self.expect_refusal(SQUARE.replace("gaussian_se3", "ensemble_se3"), "ensemble_se3")
        self.expect_refusal(SQUARE.replace("TANGENT_ORDER", "ORDER") + row(
            1.5, POSE, moved[LOWER]), "TANGENT_ORDER")
        self.expect_refusal(SQUARE + row(1.5, POSE), "e.txt:9", "8 numbers", "29")

    def test_ros_has_names_for_all(self):
        stamp = "1500000000"
        line = comma(0, 7, stamp, "odom", POSE, WHOLE, -1)
        self.expect(ROS + line, WHOLE, "ROS", "--error world", "in ns")
        dotted = ROS.replace("field.", "").replace("%time,header.seq,header.stamp",
                                                   "Time,header.stamp.secs,header.stamp.nsecs")
        line = comma(9, 1, 5000000, "odom", POSE, WHOLE, -1)
        for brackets in ("pose.covariance[{}]", "pose.covariance_{}"):
            header = dotted
            for k in reversed(range(36)):
                header = header.replace(f",pose.covariance{k},", f",{brackets.format(k)},")
            self.expect(header + line, WHOLE, "ROS", time="1.005")
        self.expect_refusal(ROS.replace("position.z", "position.q") + line, "e.txt:1",
                            "no column z")

    def test_a_covariance_may_have_names_of_many_kinds(self):
        moved = np.roll(WHOLE, 3, (0, 1))
        pose = "#timestamp [ns], p_x, p_y, p_z, q_x, q_y, q_z, q_w, "
        whole = [(i, j) for i in range(6) for j in range(6)]
        triangles = (UPPER, LOWER, tuple(zip(*whole)))

        def expect(form, places, first=0, order="rotation-first", **options):
            names = ", ".join(form.format(i + first, j + first, 6 * i + j + first)
                              for i, j in zip(*places))
            P = moved if order == "rotation-first" else WHOLE
            text = pose + names + "\n" + comma(1500000000, POSE, P[places])
            if order:
                self.expect_refusal(text, "e.txt:2", "named by indices",
                                    "--order position-first", "--order rotation-first")
            self.expect(text, WHOLE, "since the header names p_x, q_x first, and "
                        + form.format(first, first, first).split()[0], order=order, **options)
            self.assertNotIn("ASSUMED", self.said)

        for form in ("P_{}{}", "P_{}_{}", "cov_{}_{}", "cov_{}{}", "sigma_{}{}", "c{}{}",
                     "Cov[{}][{}]", "P_{}{} [m^2]", "pose_cov_{}_{}", "P{}x{}", "Sigma_{}_{}"):
            for first in (0, 1):
                for places in triangles:
                    expect(form, places, first)
        for first in (0, 1):
            expect("cov{2}", triangles[2], first)
            expect("P_{2:02}", triangles[2], first, order="position-first")
        names = ", ".join(f"P{n}" for n in range(21))
        self.expect(f"{pose}{names}\n" + comma(1500000000, POSE, WHOLE[LOWER]), WHOLE,
                    order="position-first")
        for words in (("x", "y", "z", "rx", "ry", "rz"),
                      ("px", "py", "pz", "theta_x", "theta_y", "theta_z")):
            for form in ("cov_{}_{}", "P_{}_{}", "covariance_{}{}"):
                names = ", ".join(form.format(words[i], words[j]) for i, j in zip(*UPPER))
                text = f"{pose}{names}\n" + comma(1500000000, POSE, WHOLE[UPPER])
                self.expect(text, WHOLE)
                self.assertNotIn("ASSUMED", self.said)
                self.expect_refusal(text, "names the order", order="rotation-first")
        words = ("x", "y", "z", "roll", "pitch", "yaw")
        names = ", ".join(f"cov_{words[i]}_{words[j]}" for i, j in zip(*UPPER))
        self.expect(f"{pose}{names}\n" + comma(1500000000, POSE, WHOLE[UPPER]), WHOLE,
                    "\nASSUMED of", "roll, pitch and yaw")

    def test_parts_of_a_covariance_are_read_and_said(self):
        pose = "t,tx,ty,tz,qx,qy,qz,qw,"
        places = [(i, j) for i, j in zip(*UPPER) if i // 3 == j // 3]
        text = (pose + ",".join(f"P_{i}{j}" for i, j in places) + "\n"
                + comma(1.5, POSE, [WHOLE[one] for one in places]))
        self.expect(text, BLOCKS, "between position and rotation", order="position-first")
        text = (pose + ",".join(f"P_{i}{i}" for i in range(6)) + "\n"
                + comma(1.5, POSE, np.diag(WHOLE)))
        self.expect(text, np.diag(np.diag(WHOLE)), "no covariances between components",
                    order="position-first")

    def test_columns_that_are_not_understood_are_named(self):
        pose = "t,tx,ty,tz,qx,qy,qz,qw,"
        names = [f"H_{i}{j}" for i, j in zip(*UPPER)]
        line = comma(1.5, POSE, WHOLE[UPPER])
        self.expect_refusal(pose + ",".join(names) + "\n" + line, "e.txt:1", "H_00, H_01",
                            "and 15 more", "cov_x_x", "cov_0_0", "e.cov")
        names = [f"P_{i}{j}" for i, j in zip(*UPPER)]
        names[7] = "P_mid"
        self.expect_refusal(pose + ",".join(names) + "\n" + line, "e.txt:1", "components 2 and 3",
                            "P_mid", "add it")
        names[7], names[20] = "P_12", "P_0_14"
        self.expect_refusal(pose + ",".join(names) + "\n" + line, "e.txt:1", "P_0_14",
                            "six components", "cov_x_x")
        names[20] = "cov_5_5"
        self.expect_refusal(pose + ",".join(names) + "\n" + line, "e.txt:1", "cov", "leave out")

    def test_planar_poses_have_three_components(self):
        heading = 2.5
        flat = [1.0, 2.0, 0.3, 0, 0, np.sin(heading / 2), np.cos(heading / 2)]
        line = comma(0, 7, "1500000000", "odom", flat, WHOLE, -1)
        taken = WHOLE[np.ix_([0, 1, 5], [0, 1, 5])]
        self.expect(ROS + line, taken, pose=[1.0, 2.0, heading], planar=True)
        self.assertEqual(self.header[:4], ["time_s", "x_m", "y_m", "heading_rad"])
        self.expect_refusal(ROS + comma(0, 7, "1500000000", "odom", POSE, WHOLE, -1), "e.txt:2",
                            "leaves the plane", planar=True)
        risen = line + line.replace("1500000000", "2500000000").replace(",0.3,", ",0.4,")
        self.expect_refusal(ROS + risen, "e.txt:3", "0.1 m", planar=True)

    def test_standard_deviations_are_variances_without_covariances(self):
        self.expect("time_s,x_m,y_m,heading_rad,sigma_x_m,sigma_y,sigma_heading_rad\n"
                    "1.5,1,2,3,0.5,0.25,0.125\n", np.diag([0.25, 0.0625, 0.015625]),
                    "standard deviations", "count as 0", pose=[1, 2, 3])
        self.assertEqual(self.header[:4], ["time_s", "x_m", "y_m", "heading_rad"])
        names = ",".join(f"sigma_{a}" for a in ("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"))
        self.expect(f"t,tx,ty,tz,qx,qy,qz,qw,{names}\n" + comma(1.5, POSE, [1, 2, 3, 4, 5, 6]),
                    np.diag([1.0, 4, 9, 16, 25, 36]))
        self.expect_refusal("time_s,x_m,heading_rad,sigma_x_m,sigma_heading_deg\n1,2,3,4,5\n",
                            "e.txt:1", "sigma_heading_rad")
        self.expect_refusal("time_s,x_m,sigma_x_m,sigma_y_m\n1,2,3,4\n", "sigma_y_m belongs to no")
        self.expect_refusal("time_s,x_m,sigma_x_m\n1,2,-3\n", "e.txt:2", "below 0")

    def test_what_judge_reads_is_not_converted_unless_an_option_changes_it(self):
        header = "time_s,x_m,y_m,z_m,qx,qy,qz,qw"
        covariance = "".join(f",cov_{i}_{j}" for i, j in zip(*UPPER))
        moved = np.roll(WHOLE, 3, (0, 1))
        text = header + covariance + "\n" + comma(1.5, POSE, moved[UPPER])
        self.expect_refusal(text, "already what judge reads", "montecarta judge", name="e.csv")
        self.expect_refusal(header + "\n" + comma(1.5, POSE), "already", name="t.csv", kind="truth")
        self.expect(text, WHOLE, name="e.csv", order="rotation-first")
        first = [*POSE[:3], POSE[6], *POSE[3:6]]
        text = header + covariance + "\n" + comma(1.5, first, WHOLE[UPPER])
        self.expect(text, WHOLE, name="e.csv", quaternion="wxyz")


class Arrays(Estimates):
    """Two runs of three scans; the first run misses a scan, the second ends early."""

    def setUp(self):
        super().setUp()
        self.mean = np.arange(12.0).reshape(2, 3, 2)
        self.mean[0, 1] = self.mean[1, 2] = np.nan
        self.P = np.broadcast_to([[2.0, 0.5], [0.5, 3.0]], (2, 3, 2, 2)).copy()
        self.P[0, 1] = np.nan
        self.arrays = {"mean": self.mean, "covariance": self.P, "truth": np.ones((2, 3, 2)),
                       "time": np.array([0.5, 1.0, 1.5]), "names": np.array(["x_m", "v_mps"])}

    def run_arrays(self, name, kind, order=None, **arrays):
        path = self.path(name)
        if name.endswith(".npz"):
            np.savez(path, **arrays)
        else:
            savemat(path, arrays)
        self.number = getattr(self, "number", 0) + 1
        folder = self.path(f"out_{self.number}")
        self.converted(estimates, kind=kind, files=[path], output=folder, order=order)
        return {os.path.relpath(os.path.join(at, one), folder): self.lines(at, one)
                for at, _, files in os.walk(folder) for one in files}

    def test_become_a_folder_for_each_run(self):
        header = "time_s,x_m,v_mps,cov_0_0,cov_0_1,cov_1_0,cov_1_1"
        for name in ("a.npz", "a.mat"):
            arrays = dict(self.arrays)
            if name == "a.mat":
                arrays["names"] = np.array(["x_m", "v_mps"], dtype=object)
            self.assertEqual(self.run_arrays(name, "estimate", **arrays), {
                "run_0/estimate.csv": [header, "0.5,0,1,2,0.5,0.5,3", "1.5,4,5,2,0.5,0.5,3"],
                "run_1/estimate.csv": [header, "0.5,6,7,2,0.5,0.5,3", "1,8,9,2,0.5,0.5,3"]})
            self.assertIn("NaN are left out", self.said)
            truth = ["time_s,x_m,v_mps", "0.5,1,1", "1,1,1", "1.5,1,1"]
            self.assertEqual(self.run_arrays(name, "truth", **arrays),
                             {"run_0/truth.csv": truth, "run_1/truth.csv": truth})
        self.assertEqual(self.run_arrays("a.npz", "truth", **self.arrays | {
            "truth": np.ones((3, 2))}), {"truth.csv": truth})

    def test_of_poses_may_have_the_rotation_first(self):
        columns = np.array(["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"])
        moved = np.roll(WHOLE, 3, (0, 1))
        pose = {"mean": np.array([[POSE]]), "names": columns}
        line, = self.run_arrays("a.npz", "estimate", covariance=moved[None, None],
                                order="rotation-first", **pose)["run_0/estimate.csv"][1:]
        np.testing.assert_allclose([float(one) for one in line.split(",")[8:]], WHOLE.ravel())
        with self.assertRaisesRegex(ConversionError, "only a 'mean' of poses in space"):
            self.run_arrays("a.npz", "estimate", order="rotation-first", **self.arrays)

    def test_may_have_names_in_one_text(self):
        rows = self.run_arrays("a.npz", "estimate", **self.arrays | {"names": "x_m, v_mps"})
        self.assertEqual(rows["run_0/estimate.csv"][0][:16], "time_s,x_m,v_mps")

    def test_may_be_errors_which_need_no_truth(self):
        arrays = {"error": self.mean, "covariance": self.P, "names": self.arrays["names"]}
        rows = self.run_arrays("a.npz", "estimate", **arrays)["run_1/estimate.csv"]
        self.assertEqual(rows[0][:28], "time_s,error_x_m,error_v_mps")
        self.assertEqual(rows[1][:6], "0,6,7,")
        self.assertIn("no time", self.said)
        self.expect_refused(estimates, ["needs no truth"], kind="truth",
                            files=[self.path("a.npz")], output=self.path("refused"))

    def test_are_refused_if_their_damage_ends_the_reader(self):
        path = self.path("a.mat")
        savemat(path, {"mean": np.ones((2, 3, 2))})
        with open(path, "r+b") as file:
            file.seek(184)  # the type of the numbers
            file.write(b"\xff")
        self.expect_refused(estimates, ["a.mat: is damaged"], kind="estimate", files=[path],
                            output=self.path("refused"))

    def test_are_refused_if_they_are_incomplete(self):
        def refuse(*pieces, kind="estimate", **changed):
            arrays = {**self.arrays, **changed}
            np.savez(self.path("a.npz"), **{k: v for k, v in arrays.items() if v is not None})
            self.expect_refused(estimates, pieces, kind=kind, files=[self.path("a.npz")],
                                output=self.path("refused"))
        refuse("no 'covariance'", covariance=None)
        refuse("'covariance' is 2 x 3 x 3 x 3", "2 x 3 x 2 x 2", covariance=np.ones((2, 3, 3, 3)))
        refuse("neither", mean=None)
        refuse("both", error=self.mean)
        refuse("no 'truth'", kind="truth", truth=None)
        refuse("'names'", names=np.array(["x_m"]))
        refuse("'time'", time=np.arange(4.0))
        refuse("numpy.savez", "objects", names=np.array(["x_m", None], dtype=object))
        self.P[1, 0] = np.inf
        refuse("run 1, scan 0", "NaN or infinite")


class Files(Estimates):
    LINE = row(1.5, POSE, WHOLE)

    def test_files_alike_are_reported_in_one_line(self):
        for k in range(3):
            self.write(f"e_{k}.txt", TUM + row(1.5, POSE))
            self.write(f"e_{k}.cov", row(1.5, WHOLE))
        self.converted(estimates, kind="estimate", order="position-first",
                       files=[self.path(f"e_{k}.txt") for k in range(3)])
        self.assertEqual(len(self.said.splitlines()), 2)
        self.assertIn("e_0.txt and 2 more", self.said)

    def test_damage_is_named_with_line_and_remedy(self):
        good = TUM + row(1.5, POSE)
        self.write("e.cov", row(1.5, WHOLE))
        self.expect_refusal(TUM.replace(" qw", "") + row(1.5, POSE[:6]), "e.txt:1", "no column qw",
                            "add it")
        self.expect_refusal(TUM + row(1.5, POSE[:6]), "e.txt:2", "7 fields, but 8 in the header")
        self.expect_refusal(good + "2.5 1 2", "e.txt:3", "no end", "end it")
        self.expect_refusal(TUM + row("nan", POSE), "e.txt:2", "'nan'", "correct")
        self.expect_refusal(TUM + row(1.5, "nan", POSE[1:]), "e.txt:2", "'nan'", "correct")
        self.expect_refusal(good.replace("3.0", "inf"), "e.txt:2", "'inf'")
        self.expect_refusal(TUM + row(1.5, 1, 2, 3, 0, 0, 0, 2), "e.txt:2", "length 2")
        self.expect_refusal(good + row(1.5, POSE), "e.txt:3", "1.5", "not later")
        self.expect_refusal(good.replace(" ", ";"), "semicolons", "commas")
        self.expect_refusal(row(1.5, POSE, 1), "e.txt:1", "9 numbers", "name the columns")
        self.expect_refusal("t,tx,tx,ty\n1,2,3,4\n", "e.txt:1", "'tx' twice")
        self.expect_refusal("", "e.txt", "no rows")
        self.expect_refusal(TUM, "e.txt", "no rows", kind="truth")
        self.expect_refusal("t,a,b\n1,2,3\n", "e.txt:1", "no column x")
        os.remove(self.path("e.cov"))
        self.expect_refusal(good, "e.txt", "no covariances", "e.cov")
        header = ROS.replace("field.pose.covariance7,", "other,").replace("covariance8,", "c8,")
        self.expect_refusal(header + comma(0, 7, "1500000000", "odom", POSE, WHOLE, -1), "e.txt:1",
                            "covariance of y and y", "add it")

    def test_a_run_that_failed_has_a_header_alone(self):
        for text in ("# timestamp\n", OPEN_VINS, TUM):
            self.assertEqual(self.convert(text), [])
            self.assertEqual(len(self.header), 1 + 7 + 36)

    def test_all_are_checked_before_one_is_written(self):
        for name, text in (("run_1", self.LINE), ("run_2", self.LINE * 2)):
            os.mkdir(self.path(name))
            self.write(f"{name}/e.txt", text)
        files = [self.path("run_1", "e.txt"), self.path("run_2", "e.txt")]
        first = {"kind": "estimate", "files": files, "order": "position-first"}
        self.expect_refused(estimates, ("run_2/e.txt:2", "not later"), **first)
        self.assertEqual(os.listdir(self.path("run_1")), ["e.txt"])
        self.write("run_2/e.txt", self.LINE)
        self.converted(estimates, **first)
        lines = self.lines("run_1", "e.csv")
        self.assertEqual(sorted(os.listdir(self.path("run_1"))), ["e.csv", "e.txt"])
        self.converted(estimates, output=self.path("again"), **first)
        self.assertEqual(self.lines("again", "run_2", "e.csv"), lines)
        self.expect_refused(estimates, ("e.csv", "exists", "-o FOLDER"), **first)

    def test_an_interruption_leaves_no_part_of_a_file(self):
        self.write("e.txt", self.LINE)
        rename, estimates.os.rename = os.rename, lambda *_: (_ for _ in ()).throw(OSError("full"))
        try:
            with self.assertRaises(OSError):
                self.converted(estimates, kind="estimate", files=[self.path("e.txt")],
                               order="position-first")
        finally:
            estimates.os.rename = rename
        self.assertEqual(os.listdir(self.folder), ["e.txt"])

    def test_a_csv_file_needs_a_folder(self):
        self.write("e.csv", CNSPY_WHOLE + comma(1.5, POSE, WHOLE[UPPER]))
        self.expect_refused(estimates, ("ends with .csv", "-o FOLDER"), kind="estimate",
                            files=[self.path("e.csv")])
        with self.assertRaisesRegex(ConversionError, "e.csv: is no folder"):
            self.converted(estimates, kind="estimate", files=[self.path("e.csv")],
                           output=self.path("e.csv"))


class Alignment(Estimates):
    """A truth in a frame that is moved and turned about the vertical."""

    def setUp(self):
        super().setUp()
        turn = 0.7
        half = np.array([0, 0, np.sin(turn / 2), np.cos(turn / 2)])
        Rz = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0],
                       [0, 0, 1]])
        self.estimates, truth = [], TUM
        for k in range(3):
            q = np.array([0.02, -0.1, 0.3 * k, 0.9])
            q /= np.linalg.norm(q)
            position = np.array([k, 2.0 * k, 0.1 * k])
            self.estimates.append([*position, *q])
            x, y, z, w = q
            turned = [half[3] * x - half[2] * y, half[3] * y + half[2] * x,
                      half[3] * z + half[2] * w, half[3] * w - half[2] * z]
            truth += row(0.5 * k, Rz @ position + [5, -6, 7], turned)
        self.write("t.txt", truth)
        self.write("e.txt", "".join(row(0.5 * k, pose, 1e-3 * WHOLE if k else np.zeros(36))
                                    for k, pose in enumerate(self.estimates)))

    def test_moves_the_truth_onto_the_first_estimate(self):
        self.converted(estimates, kind="truth", files=[self.path("t.txt")], align="yaw",
                       onto=[self.path("e.txt")])
        np.testing.assert_allclose(np.array(self.rows("t.csv"), dtype=float)[:, 1:], self.estimates,
                                   atol=1e-12)
        self.converted(estimates, kind="estimate", files=[self.path("e.txt")], align="yaw",
                       order="position-first")
        self.assertEqual([one[0] for one in self.rows("e.csv")], ["0.5", "1"])
        self.assertIn("left out", self.said)
        self.write("late.txt", row(0.5, self.estimates[1], 1e-3 * WHOLE))
        self.expect_refused(estimates, ("late.txt:1", "0.0954 m or rad", "judge --anchor yaw"),
                            kind="estimate", files=[self.path("late.txt")], align="yaw",
                            order="position-first")

    def test_interpolates_the_truth_at_the_first_estimate(self):
        self.write("t.txt", TUM + row(0, 0, 0, 0, 0, 0, 0, 1) + row(1, 4, 0, 0, 0, 0, 0, -1))
        self.write("e.txt", row(0.25, 5, 6, 7, 0, 0, 0, 1, WHOLE))
        self.converted(estimates, kind="truth", files=[self.path("t.txt")], align="yaw",
                       onto=[self.path("e.txt")])
        np.testing.assert_allclose(np.array(self.rows("t.csv"), dtype=float)[:, :4],
                                   [[0, 4, 6, 7], [1, 8, 6, 7]], atol=1e-12)

    def test_of_one_truth_makes_one_for_each_estimate(self):
        with open(self.path("e.txt"), encoding="utf-8") as file:
            late = file.read().split("\n", 1)[1]
        for k, text in enumerate((late, late)):
            os.mkdir(self.path(f"run_{k}"))
            self.write(f"run_{k}/e.txt", text)
        self.converted(estimates, kind="truth", files=[self.path("t.txt")], align="yaw",
                       onto=[self.path("run_0", "e.txt"), self.path("run_1", "e.txt")],
                       output=self.path("out"))
        for k in range(2):
            np.testing.assert_allclose(np.array(self.rows("out", f"run_{k}", "truth_e.csv"),
                                                dtype=float)[1:, 1:], self.estimates[1:],
                                       atol=1e-12)

    def test_is_refused_without_a_partner(self):
        self.expect_refused(estimates, ("--onto",), kind="truth", files=[self.path("t.txt")],
                            align="yaw")
        for name in ("t_1.txt", "t_2.txt", "e_1.txt", "e_2.txt"):
            with open(self.path(name[0] + ".txt"), encoding="utf-8") as file:
                self.write(name, file.read())
        self.expect_refused(estimates, ("e_2.txt", "t_1.txt"), kind="truth", align="yaw",
                            files=[self.path("t_1.txt"), self.path("t_2.txt")],
                            onto=[self.path("e_2.txt"), self.path("e_1.txt")])
        self.write("e.txt", row(9.5, POSE, WHOLE))
        self.expect_refused(estimates, ("t.txt", "9.5 s", "same run"), kind="truth", align="yaw",
                            files=[self.path("t.txt")], onto=[self.path("e.txt")])


if __name__ == "__main__":
    unittest.main()
