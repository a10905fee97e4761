// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The distinct ancestors of all particles of a scan, while a genealogy is walked back. The object
/// keeps its memory from walk to walk.
class AncestorSet {
 public:
  /// Makes all particles the members.
  void start(std::size_t particles) {
    stamp_.resize(std::max(stamp_.size(), particles));
    members_.resize(particles);
    std::iota(members_.begin(), members_.end(), 0u);
  }
  /// Makes `indices` the members: each once, and below the number of particles of the last start().
  void assign(std::span<const std::uint32_t> indices) {
    start(indices.size());
    step_back(indices);
  }
  /// Replaces all members by their parents, {particle}. There is no branch that the processor would
  /// have to predict.
  void step_back(std::span<const std::uint32_t> parents) {
    ++now_;
    std::size_t kept = 0;
    for (const std::uint32_t child : members_) {
      const std::uint32_t parent = parents[child];
      members_[kept] = parent;
      kept += stamp_[parent] != now_ ? 1 : 0;
      stamp_[parent] = now_;
    }
    members_.resize(kept);
  }
  std::size_t size() const { return members_.size(); }

 private:
  std::vector<std::uint32_t> members_;
  std::vector<std::uint64_t> stamp_;  ///< {index} number of the last set that had this member
  std::uint64_t now_ = 0;             ///< stamp of the set that is being made
};

/// Fills `resampled` {scan} with 1 + the latest scan, up to this one, in which a particle had
/// another parent than itself; 0 if there is none. `ancestor` {scan, particle}. Throws RunError if
/// a parent does not exist.
void find_resamplings(std::span<const std::uint32_t> ancestor, std::size_t particles,
                      std::vector<std::size_t>& resampled);

/// Ages [s] at which distinct ancestors are counted.
inline constexpr std::array kLineageLags = {1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};

/// The ancestry of one run, seen from up to 32 of its scans.
struct Lineages {
  /// {lag} number of distinct ancestors of that age, mean over the scans that are late enough; NaN
  /// if there are none.
  std::array<double, kLineageLags.size()> ancestors{};
  /// [s] age of the youngest common ancestor of all particles, mean over the scans that have one.
  double coalescence = 0.0;
  /// Share of the scans at which all particles have one common ancestor.
  double coalesced_share = 0.0;
  /// [m^2] Variance of the estimated position that comes from the small number of particles, mean
  /// over scans; NaN if particles are not stored. It is estimated from the differences between
  /// families, the descendants of one ancestor kDiversityLag ago (Lee and Whiteley 2018, eq. (8),
  /// with the fixed lag of Olsson and Douc 2019).
  double monte_carlo_variance = 0.0;
  /// [m^2] mean squared position error at the same scans.
  double squared_error = 0.0;
};

/// Follows a genealogy back from several scans. The object keeps its memory from run to run.
class LineageWalker {
 public:
  /// Walks back through the ancestors in `rows`. `resampled` {scan} is that of find_resamplings();
  /// `squared_position` {scan} [m^2] may be empty; `times` [s] of the scans.
  Lineages walk(const RunRows& rows, std::span<const std::size_t> resampled,
                std::span<const double> times, std::span<const double> squared_position);

 private:
  struct Sums;
  void walk_from(std::size_t s, const RunRows& rows, std::span<const std::size_t> resampled,
                 std::span<const double> times, Sums& sums);
  double family_variance(const RunRows& rows, std::size_t s);

  AncestorSet set_;
  /// {particle of the first scan of the walk} ancestor at the present scan.
  std::vector<std::uint32_t> ancestor_;
  std::vector<double> families_;  ///< {ancestor, 2} weighted deviation of its descendants
};

/// [s] Age of the ancestors in Diversity::lag (STATISTICS 14).
inline constexpr double kDiversityLag = 10.0;

/// Numbers of distinct ancestors of the particles of one run at every scan.
struct Diversity {
  /// {scan} number of parents in the last resampling before the scan.
  std::vector<std::uint32_t> last_resampling;
  /// {scan} number of ancestors kDiversityLag earlier, or at the start if that is later.
  std::vector<std::uint32_t> lag;
  std::vector<std::uint32_t> root;  ///< {scan} number of ancestors at the start, which never grows
};

/// Counts ancestors along a genealogy. The object keeps its memory from run to run.
class DiversityCounter {
 public:
  /// Counts the ancestors of one run. `ancestor` {scan, particle} is the index of the parent among
  /// the particles one scan ago; `times` [s] of the scans.
  const Diversity& count(std::span<const std::uint32_t> ancestor, std::size_t particles,
                         std::span<const double> times);
  /// {scan} result of find_resamplings() for the run that was counted last.
  std::span<const std::size_t> resampled() const { return resampled_; }

 private:
  /// A resampling, and the number of ancestors before it.
  struct ResamplingStep {
    std::size_t scan;
    std::uint32_t ancestors;
  };
  using Row = std::span<const std::uint32_t>;
  /// Parents of all particles of scan `s`.
  Row parents(std::size_t s) const { return ancestor_.subspan(s * particles_, particles_); }
  void count_back(std::span<const double> times);
  void count_root();
  /// Fills `path_` with the resamplings from scan `s`, at which there is one, back to scan `first`.
  void walk_back(std::size_t first, std::size_t s);

  Row ancestor_;
  std::size_t particles_ = 0;
  Diversity result_;
  std::vector<std::size_t> resampled_;  ///< {scan} result of find_resamplings()
  AncestorSet set_;                     ///< ancestors during the walk back
  std::vector<ResamplingStep> path_;    ///< resamplings back from the last one, the latest first
  std::vector<std::uint32_t> root_;     ///< {particle} ancestor at the start
  /// {particle} ancestor at the start, as it was one resampling earlier.
  std::vector<std::uint32_t> previous_;
};

}  // namespace montecarta::analysis
