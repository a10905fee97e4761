// SPDX-License-Identifier: BSD-3-Clause
#include "filters/evolution/evolution_report.hpp"

#include <algorithm>

namespace montecarta::filters {

std::vector<OwnColumn> EvolutionReport::columns() {
  return {{"evolution_evaluations", "evolution", "1", "evaluations of the fitness at the scan"},
          {"evolution_generations", "evolution", "1",
           "generations until evolution ended, mean over the populations"},
          {"evolution_gain", "evolution", "1",
           "log fitness after minus before evolution, mean over the populations"},
          {"evolution_displacement", "evolution", "1",
           "way from before to after evolution in standard deviations, mean over the populations"}};
}

void EvolutionReport::remove_columns(Capabilities& reports) {
  std::erase_if(reports.own_columns,
                [](const OwnColumn& column) { return column.group == "evolution"; });
}

void EvolutionReport::begin_scan() {
  values_ = {};
  populations_ = 0;
}

void EvolutionReport::add(const EvolutionEffect& effect) {
  values_[0] += static_cast<double>(effect.members) * (1.0 + effect.generations);
  values_[1] += effect.generations;
  values_[2] += effect.gain;
  values_[3] += effect.displacement;
  ++populations_;
}

void EvolutionReport::end_scan() {
  if (populations_ == 0) return;
  for (double& mean : std::span(values_).subspan(1)) mean /= static_cast<double>(populations_);
}

}  // namespace montecarta::filters
