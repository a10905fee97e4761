# SPDX-License-Identifier: BSD-3-Clause
"""Draws the ANEES of the pose over time with the band of a consistent filter, as the README shows
it: python3 anees_figure.py out.h5 figure.svg [montecarta]

The last argument is the program, where it is not on the path. Needs matplotlib."""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import montecarta

path, figure, *program = sys.argv[1:]
results = montecarta.open(path)
tables = results.tables(*program)
leading = tables["consistency"].query("error == 'pose'").drop_duplicates("cell")  # of the verdict
covariances = leading[leading.anees_mean.notna()].set_index("cell").covariance

axes = plt.figure(figsize=(8, 4.5)).add_subplot(yscale="log", xlabel="time [s]",
                                                ylabel="ANEES of the pose")
for label in results.labels:
    if label not in covariances:
        continue
    series, which = tables["series_" + label], "pose_" + covariances[label]
    if not axes.collections:
        axes.fill_between(series["time [s]"], series["lower_" + which], series["upper_" + which],
                          color="0.8", label="95 % band")
    axes.plot(series["time [s]"], series["anees_" + which], linewidth=1, label=label)
axes.legend(fontsize="small", ncols=2)
axes.set_title(results.attrs["title"], fontsize="medium")
axes.figure.savefig(figure, bbox_inches="tight")
