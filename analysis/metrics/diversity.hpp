// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/lineages.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Age of the ancestors in Diversity::lag [s] (STATISTICS 14).
inline constexpr double kDiversityLag = 10.0;

/// Distinct ancestors of the particles of every scan of one run.
struct Diversity {
  std::vector<std::uint32_t> last_resampling;  ///< parents in the last resampling before the scan
  std::vector<std::uint32_t> lag;              ///< ancestors kDiversityLag earlier, or at the start
  std::vector<std::uint32_t> root;             ///< ancestors at the start; never grows
};

/// Counts ancestors along a genealogy. Keeps its memory from run to run.
class DiversityCounter {
 public:
  /// `ancestor` {scan, particle}: index, among the particles one scan ago, of the parent. `times`
  /// [s] of the scans.
  const Diversity& count(std::span<const std::uint32_t> ancestor, std::size_t particles,
                         std::span<const double> times);

 private:
  using Row = std::span<const std::uint32_t>;
  /// Parents of all particles of scan `s`.
  Row parents(std::size_t s) const { return ancestor_.subspan(s * particles_, particles_); }
  void count_last_resampling();
  void count_lag(std::span<const double> times);
  void count_root();
  /// Number of ancestors that the particles of scan `s` had before scan `first`.
  std::uint32_t ancestors_before(std::size_t first, std::size_t s);

  Row ancestor_;
  std::size_t particles_ = 0;
  Diversity result_;
  std::vector<std::size_t> resampled_;   ///< find_resamplings()
  AncestorSet set_;                      ///< being walked back
  std::vector<std::uint32_t> root_;      ///< {particle} ancestor at the start
  std::vector<std::uint32_t> previous_;  ///< root_ one resampling earlier
};

}  // namespace montecarta::analysis
