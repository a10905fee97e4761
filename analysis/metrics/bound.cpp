// SPDX-License-Identifier: BSD-3-Clause
// The Cramer-Rao bound of the study, and the efficiency of each cell with respect to it.
#include "analysis/study/efficiency.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/study_analysis.hpp"

#include <vector>

namespace montecarta::analysis {
namespace {

const std::vector<ResultNumber<Efficiency>> kEfficiencies = {
    {"position_efficiency", "1", &Efficiency::position},
    {"heading_efficiency", "1", &Efficiency::heading},
    {"map_efficiency", "1", &Efficiency::map}};

/// Makes a file with one row for each scan: the Cramer-Rao bound of position and heading.
Frame bound_frame(const StudyAnalysis& study) {
  if (study.bound.empty()) return {};
  return {{{"time", "s", study.times},
           {"position_bound", "m", study.bound.position},
           {"heading_bound", "rad", study.bound.heading}}};
}

}  // namespace

Metric bound_metric() {
  return {.add_numbers = numbers_by(kEfficiencies), .files = {{"bound.csv", bound_frame}}};
}

}  // namespace montecarta::analysis
