// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/judgement.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace montecarta::experiments {

/// The stopping rule study.until. With METRIC < HALF-WIDTH a cell stops when its mean is that
/// precise. With verdict it stops when its verdict is known. With verdict, N runs it does the same,
/// but "consistent" needs N runs.
struct StoppingRule {
  static constexpr double kLevel = kUsualLevel;

  /// Name of a score of runs; nullopt: the verdict decides.
  std::optional<std::string> metric = {};
  double half_width = 0.0;  ///< half width of the kLevel interval of the mean, in the score's unit
  /// Number of runs that the verdict "consistent" needs, because an early stop would miss rare
  /// divergence.
  std::uint64_t least_runs = kUsualLeastRuns;
  static constexpr std::uint64_t kUsualLeastRuns = 300;
};

/// Parses study.until; nullopt if `text` is empty, which means all runs. Throws StudyError that
/// begins with `place` if the text is malformed. Whether runs have the metric is not checked, see
/// enough_runs().
std::optional<StoppingRule> parse_stopping_rule(const std::string& text, const std::string& place);

/// The rule in the canonical spelling of the resolved study.
std::string text_of(const StoppingRule& rule);

}  // namespace montecarta::experiments
