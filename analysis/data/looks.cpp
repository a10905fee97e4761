// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/data/looks.hpp"

#include "analysis/data/study_setting.hpp"
#include "engine/runs/rounds.hpp"

namespace montecarta::analysis {

std::vector<std::uint64_t> looks_in(const std::string& study_text, std::uint64_t runs) {
  if (study_setting(study_text, "until") != kUntilVerdict) return {};
  return rounds_of(runs);
}

}  // namespace montecarta::analysis
