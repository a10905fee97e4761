// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/study_settings.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/verdict/family.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

enum class Answer {
  untested,      ///< no covariance is stored, or no run is complete
  consistent,    ///< every deviation is shown to be within the margin
  optimistic,    ///< squared errors are shown to be larger than claimed
  conservative,  ///< squared errors are shown to be smaller than claimed
  inconsistent,  ///< both, in different parts; or bias, correlation or spread between runs alone
  undecided      ///< neither is shown: more runs are needed
};

/// "consistent", ...
std::string name_of(Answer answer);

/// Verdict on the covariances of a cell (STATISTICS 5).
struct Verdict {
  Answer answer = Answer::untested;
  double level = 0.95;           ///< of all tests together
  double within = kUsualMargin;  ///< the margin r: ratios in [1/r, r] are consistent
  std::vector<FamilyTest> families = {};
  std::uint64_t runs = 0;      ///< that ended, complete or failed
  std::uint64_t failed = 0;    ///< of them
  std::uint64_t samples = 0;   ///< of the complete runs, one a scan
  std::uint64_t unusable = 0;  ///< of them: no finite error or no covariance matrix
  std::optional<std::uint64_t> more_runs = {};  ///< needed for a decision, if known

  /// nullptr where the family does not apply.
  const FamilyTest* find(Family family) const;
  /// Interval of the ratio of all squared errors to the expected ones; NaN where there is none.
  Interval ratio() const;
  double ratio_estimate() const;
};

/// Judges families that were judged together at `level` by the margin `within`, from `runs`
/// complete runs.
Verdict judge(std::vector<FamilyTest> families, double level, double within, std::uint64_t runs);

/// For a table: "consistent within 1.1", "optimistic: NEES 1.28 to 2.25 times too large", ...
/// Failed runs and unusable samples are part of it.
std::string in_words(const Verdict& verdict);

/// One sentence on the cell `label`, with when and in which component.
std::string sentence(const std::string& label, const Verdict& verdict);

/// Decision of a script on a filter: accept it, reject it, or wait for more runs.
enum class GateAnswer : std::uint8_t { consistent, inconsistent, undecided };

/// Numbers that a gate tolerates. More than these are inconsistent for any errors.
struct Allowance {
  std::uint64_t failed = 0;    ///< runs
  std::uint64_t unusable = 0;  ///< samples
};

/// Throws StudyError if nothing was judged and nothing failed.
GateAnswer gate(const Verdict& verdict, const Allowance& allowed = {});

}  // namespace montecarta::analysis
