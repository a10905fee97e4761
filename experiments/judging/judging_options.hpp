// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"
#include "engine/records/result_writer.hpp"
#include "experiments/judging/anchor.hpp"
#include "experiments/judging/error_convention.hpp"
#include "experiments/judging/gate.hpp"
#include "experiments/judging/state_rows.hpp"
#include "experiments/judging/truth_path.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The settings by which the estimates of another program become a result file.
struct JudgingOptions {
  std::filesystem::path output;
  /// The convention; nullopt if the user gave none, which is allowed for a state that has only one.
  std::optional<ErrorConvention> convention = {};
  TimeMatch match;
  std::optional<Anchor> anchor = {};  ///< how truths are moved onto the first estimates
  /// {cell} whether covariances of moved errors are only bounds; empty without an anchor
  std::vector<bool> bounds_anchored = {};
  bool adds_truth_covariance = false;  ///< whether truths have errors, of known covariance
  std::string pair =
      {};  ///< two estimators, the second of which is in place of the truth; or empty
  bool are_innovations = false;              ///< whether the files have innovations alone
  std::vector<double> windows = {};          ///< [s] increments over these are judged; or empty
  std::vector<bool> bounds_increments = {};  ///< {cell} whether their covariances are only bounds
  std::optional<Gates> gates = {};           ///< of the innovations
  std::vector<std::string> components = {};  ///< names of those that are judged; empty: all
  EqualTimes equal_times = EqualTimes::refuse;
  Existing existing = Existing::refuse;
  TextPairs provenance;
  /// Whether cells have scans of their own, so that others are not missing: those of a sensor, or
  /// the ends of windows.
  bool have_own_scans() const { return are_innovations || !windows.empty(); }

  std::optional<double> within;  ///< margin of consistent ratios; not stored if not given
};

}  // namespace montecarta::experiments
