// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/figure.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The cells of one filter that differ in the number of particles alone.
struct ParticleCurve {
  std::string legend;     ///< what their labels have in common, e.g. "fastslam2"
  std::size_t style = 0;  ///< for line_colour()
  struct Point {
    std::size_t particles = 0;
    std::size_t runs = 0;  ///< complete
    Spread raw, aligned;   ///< [m] RMS to the leading reference
  };
  std::vector<Point> points;  ///< by particles, increasing
};

/// One for each filter with a complete run; none where no filter has two numbers of particles.
std::vector<ParticleCurve> particle_curves(const StudyAnalysis& study);

/// (raw, aligned) mean RMS [m] of the cell that others are asked to beat.
std::optional<std::array<double, 2>> baseline_errors(const StudyAnalysis& study);

/// Adds the two panels, raw and aligned, and their numbers to a figure.
void draw_particle_curves(const std::vector<ParticleCurve>& curves,
                          const std::optional<std::array<double, 2>>& baseline, Figure& figure);

}  // namespace montecarta::analysis
