# SPDX-License-Identifier: BSD-3-Clause
# Checks the module montecarta and prints the ANEES of each cell: module_reader.py RESULT PROGRAM.
import sys, montecarta
results = montecarta.open(sys.argv[1])
tables = results.tables(sys.argv[2])
averages = tables["consistency"]
assert list(tables["cells"].cell) == list(results.labels) and "verdict" in tables["cells"]
for label in results.labels:
    cell = montecarta.at_scans(results[label])
    assert list(cell.component.values) == ["x", "y", "heading"], cell.component
    assert cell.pose_mean.attrs["units"] == "m, m, rad" and cell.sizes["scan"] == len(cell.scan_row)
    estimate = cell.get("pose_mean_mixture", cell.pose_mean)
    error = montecarta.pose_error(cell.truth, estimate).sel(component=["x", "y"])
    rmse = (error ** 2).sum("component", skipna=False).mean("run").values ** 0.5
    theirs = tables["series_" + label]["position_rmse [m]"].values
    assert abs(rmse / theirs - 1).max() < 1e-12, label
    print(label, *averages.query("cell == @label and error == 'pose'").anees_mean[:1])
for wrong, error in [(lambda: results["none"], KeyError),
                     (lambda: montecarta.open("/none"), OSError)]:
    try:
        wrong()
        sys.exit("nothing was raised")
    except error:
        pass
