// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/mismatch.hpp"

#include "analysis/metrics/study_analysis.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <regex>
#include <string_view>

namespace montecarta::analysis {
namespace {

double factor_of(const StoredCell& cell, std::string_view name) {
  double factor = 1.0;
  for (const auto& [key, value] : cell.settings) {
    if (key == name) std::from_chars(value.data(), value.data() + value.size(), factor);
  }
  return factor;
}

std::vector<double> factors_of(const std::vector<const CellAnalysis*>& cells,
                               double Mismatch::*kind) {
  std::vector<double> factors;
  for (const CellAnalysis* cell : cells) factors.push_back(cell->mismatch.*kind);
  std::ranges::sort(factors);
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

Eigen::Index place_of(double factor, const std::vector<double>& factors) {
  return std::ranges::find(factors, factor) - factors.begin();
}

MismatchGrid grid_of(const std::vector<const CellAnalysis*>& cells) {
  MismatchGrid grid{cells.front()->mismatch.family,
                    factors_of(cells, &Mismatch::motion_noise),
                    factors_of(cells, &Mismatch::sensor_noise),
                    {}};
  grid.anees.setConstant(static_cast<Eigen::Index>(grid.motion_noise.size()),
                         static_cast<Eigen::Index>(grid.sensor_noise.size()),
                         std::numeric_limits<double>::quiet_NaN());
  for (const CellAnalysis* cell : cells) {
    const NeesResult* pose = cell->find_nees(ErrorBlock::pose, cell->leading);
    if (pose == nullptr || pose->consistency.verdict == Verdict::untested) continue;
    grid.anees(place_of(cell->mismatch.motion_noise, grid.motion_noise),
               place_of(cell->mismatch.sensor_noise, grid.sensor_noise)) =
        pose->consistency.mean / static_cast<double>(pose->series.dimension);
  }
  return grid;
}

}  // namespace

Mismatch mismatch_of(const StoredCell& cell) {
  const std::regex factors("_(motion|sensor)_noise_[0-9a-z]+");
  return {factor_of(cell, "motion_noise"), factor_of(cell, "sensor_noise"),
          std::regex_replace(cell.label, factors, "")};
}

std::vector<MismatchGrid> mismatch_grids(const StudyAnalysis& study) {
  std::vector<std::vector<const CellAnalysis*>> families;
  for (const CellAnalysis& cell : study.cells) {
    const auto found = std::ranges::find_if(families, [&](const auto& family) {
      return family.front()->mismatch.family == cell.mismatch.family;
    });
    if (found == families.end()) {
      families.push_back({&cell});
    } else {
      found->push_back(&cell);
    }
  }
  std::vector<MismatchGrid> grids;
  for (const auto& family : families) {
    MismatchGrid grid = grid_of(family);
    if (grid.anees.rows() > 1 && grid.anees.cols() > 1) grids.push_back(std::move(grid));
  }
  return grids;
}

}  // namespace montecarta::analysis
