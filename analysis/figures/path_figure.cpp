// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/path_figure.hpp"

#include "analysis/data/run_reader.hpp"
#include "analysis/figures/chosen_run.hpp"
#include "analysis/figures/path_bounds.hpp"
#include "analysis/figures/path_chart.hpp"
#include "analysis/figures/path_data.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostPanels = 8, kMostRecordedPanels = 18;

DrawnPath drawn_path(const ResultFile& file, std::size_t cell_index, std::size_t run_index) {
  const StoredCell& cell = file.cells()[cell_index];
  const RunRows run = read_run(file, cell, run_index);
  DrawnPath drawn{
      cell.label, cell_index, path_data(file, cell, run), {}, map_data(file, cell, run_index)};
  // On a recorded drive they would be far smaller than a line is thick.
  if (file.has_truth()) drawn.poses = pose_ellipses(cell, run);
  return drawn;
}

std::vector<DrawnPath> drawn_cells(const ResultFile& file, std::size_t run_index) {
  const std::size_t most = file.has_truth() ? kMostPanels : kMostRecordedPanels;
  std::vector<DrawnPath> cells;
  for (std::size_t c = 0; c < file.cells().size() && cells.size() < most; ++c) {
    if (file.status(file.cells()[c])[run_index] != RunStatus::complete) continue;
    if (!file.cells()[c].has("pose_mean")) continue;
    cells.push_back(drawn_path(file, c, run_index));
  }
  return cells;
}

std::string sentence_of(const ResultFile& file, std::size_t run_index, std::size_t cells) {
  const std::string run = "Run " + std::to_string(file.runs()[run_index]);
  if (file.has_truth()) {
    return run +
           ": the true path in grey, the filter's in colour. Ellipses hold two standard deviations "
           "of the pose, at " +
           std::to_string(kPoseEllipses) +
           " moments, and of landmarks at the end: where the filter is consistent, the truth is "
           "seldom "
           "outside.";
  }
  return run +
         ", as it stands, not aligned: the filter's path in colour over the fixes of the reference "
         "as grey dots, with the landmarks of its map at the end. The panels reach no farther than "
         "a quarter beyond the fixes: a filter that lost the map may leave them." +
         (cells == kMostRecordedPanels
              ? " The first " + std::to_string(cells) + " cells that completed the run."
              : "");
}

}  // namespace

Figure path_figure(const ResultFile& file, std::optional<std::uint64_t> run) {
  Figure figure{"paths", "Where did the filter think it was?", ""};
  const auto run_index = chosen_run(file, run);
  const auto cells = run_index ? drawn_cells(file, *run_index) : std::vector<DrawnPath>{};
  if (cells.empty()) return figure;
  figure.sentence = sentence_of(file, *run_index, cells.size());
  for (const DrawnPath& cell : cells) {
    figure.data.insert(figure.data.end(), {cell.path, cell.map});
    if (file.has_truth()) figure.data.push_back(cell.poses);
  }
  const FigureData landmarks = landmark_data(file, *run_index);
  const FigureData fixes = file.has_truth() ? FigureData{} : fix_data(file, *run_index);
  if (!file.has_truth()) figure.data.push_back(fixes);
  figure.data.push_back(landmarks);
  const Bounds bounds =
      file.has_truth() ? path_bounds(figure.data) : recorded_bounds(figure.data, fixes, landmarks);
  figure.chart = path_chart(cells, landmarks, fixes, bounds);
  return figure;
}

}  // namespace montecarta::analysis
