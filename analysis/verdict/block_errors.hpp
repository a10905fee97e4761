// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/imported_state.hpp"
#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/verdict/verdict.hpp"
#include "analysis/verdict/whole_error.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// The verdict on one block of the components of a state by itself.
struct BlockVerdict {
  std::string name;  ///< "position"
  Verdict verdict;
};

/// Adds up imported errors over runs, block by block: each with its block of the covariance.
class BlockErrors {
 public:
  BlockErrors() = default;  ///< empty sums, to be filled by a SumReader
  BlockErrors(std::span<const StateBlock> blocks, std::size_t scans);

  /// Adds run number `run`. Samples that are not judged as a whole have no part here either.
  void add(const ErrorRows& errors, std::uint64_t run, std::span<const StateBlock> blocks);
  /// {block} Verdicts on `runs` complete runs, all of them together at `level` (Bonferroni).
  std::vector<BlockVerdict> result(std::span<const StateBlock> blocks, const ErrorNames& names,
                                   double level, double within, std::uint64_t runs) const;
  static constexpr auto parts() { return std::tuple(added(&BlockErrors::sums_)); }

 private:
  std::vector<WholeError> sums_;  ///< {block}
};

}  // namespace montecarta::analysis
