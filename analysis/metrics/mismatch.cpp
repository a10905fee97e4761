// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/mismatch.hpp"

#include "analysis/metrics/cell_report.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
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
                         static_cast<Eigen::Index>(grid.sensor_noise.size()), kNaN);
  for (const CellAnalysis* cell : cells) {
    const NeesResult* pose = cell->find_nees(ErrorBlock::pose, cell->leading);
    if (pose == nullptr || !pose->is_tested()) continue;
    grid.anees(place_of(cell->mismatch.motion_noise, grid.motion_noise),
               place_of(cell->mismatch.sensor_noise, grid.sensor_noise)) =
        pose->mean / static_cast<double>(pose->series.dimension);
  }
  return grid;
}

constexpr std::size_t kMostMismatchColumns = 3;

/// Blue, white and red (ColorBrewer's RdBu, safe for the colour-blind), light enough for dark
/// numbers at both ends; 1 is white, ten times and a tenth are the ends.
constexpr std::array kPalette = {Colour{0x43, 0x93, 0xc3}, Colour{0xa6, 0xcf, 0xe3},
                                 Colour{0xf7, 0xf7, 0xf7}, Colour{0xf6, 0xb7, 0x99},
                                 Colour{0xd6, 0x60, 0x4d}};

/// The colour of the palette at `at`, from -1 to 1.
std::string colour_at(double at) { return colour_within(kPalette, 0.5 * (at + 1.0)); }

FigureData data_of(const MismatchGrid& grid) {
  FigureData data{"mismatch_" + grid.family + ".csv"};
  for (Eigen::Index m = 0; m < grid.anees.rows(); ++m) {
    for (Eigen::Index s = 0; s < grid.anees.cols(); ++s) {
      const double anees = grid.anees(m, s);
      if (std::isnan(anees)) continue;
      data.frame.add({{"motion_noise", "1", grid.motion_noise[static_cast<std::size_t>(m)]},
                      {"sensor_noise", "1", grid.sensor_noise[static_cast<std::size_t>(s)]},
                      {"anees_per_component", "1", anees},
                      {"column", "1", static_cast<double>(m)},
                      {"row", "1", static_cast<double>(s)},
                      {"log10 of anees_per_component, from -1 to 1", "1",
                       std::clamp(std::log10(anees), -1.0, 1.0)}});
    }
  }
  return data;
}

std::vector<std::string> names_of(const std::vector<double>& factors) {
  std::vector<std::string> names;
  for (const double factor : factors) names.push_back(exact_text(factor));
  return names;
}

/// From the columns of data_of().
ChartPanel chart_panel(const MismatchGrid& grid, const Frame& data) {
  const auto rows = static_cast<double>(grid.sensor_noise.size());
  ChartPanel panel{
      grid.family + ", sensor noise, believed by told", {false, -0.5, rows - 0.5}, {}, {}, {}};
  panel.x_names = names_of(grid.motion_noise);
  panel.y_names = names_of(grid.sensor_noise);
  ChartMarks& tiles = panel.marks.emplace_back();
  tiles.name = grid.family;
  tiles.shape = ChartMarks::Shape::boxes;
  if (data.columns.empty()) return panel;
  const auto column = [&](std::size_t c) { return data.columns[c].numbers; };
  tiles.facts = {
      {"motion noise", column(0)}, {"sensor noise", column(1)}, {"ANEES by components", column(2)}};
  tiles.x = column(3);
  tiles.y = column(4);
  for (const double anees : column(2)) tiles.text.push_back(readable(anees, 3));
  for (const double at : column(5)) tiles.fill.push_back(colour_at(at));
  tiles.width.assign(tiles.x.size(), 0.98);
  tiles.height = tiles.width;
  return panel;
}

Chart chart_of(const std::vector<MismatchGrid>& grids, const std::vector<FigureData>& data) {
  std::size_t most = 0;
  for (const MismatchGrid& grid : grids) most = std::max(most, grid.motion_noise.size());
  Chart chart{"motion noise, believed by told", -0.5, static_cast<double>(most) - 0.5, {}};
  chart.columns = kMostMismatchColumns;
  chart.least = 260;
  chart.aspect = 0.7;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    chart.panels.push_back(chart_panel(grids[g], data[g].frame));
  }
  return chart;
}

Figure mismatch_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("mismatch");
  const std::vector<MismatchGrid> grids = mismatch_grids(study);
  if (grids.empty()) return figure;
  for (const MismatchGrid& grid : grids) figure.data.push_back(data_of(grid));
  figure.chart = chart_of(grids, figure.data);
  return figure;
}

/// The heading of the figure.
std::vector<Section> mismatch_sections(const StudyAnalysis& study) {
  const CellNumber ratio = [](const CellAnalysis& cell) { return cell.verdict.ratio_estimate(); };
  return {section_of("mismatch", {{"ratios", range_over_cells(study, ratio)}})};
}

std::vector<Figure> mismatch_figures(const StudyAnalysis& study) {
  return {mismatch_figure(study)};
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

Metric mismatch_metric() { return {.sections = mismatch_sections, .figures = mismatch_figures}; }

}  // namespace montecarta::analysis
