// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/blocks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace montecarta::engine {

/// The ancestors of particles since earlier resamplings. Data of particles need not be copied at
/// every resampling but only when they are used again ("lazy" copying).
class Genealogy {
 public:
  /// Takes the number of particles including dead lanes, each of which is its own parent.
  explicit Genealogy(std::size_t particles) : particles_(particles) {}

  void clear() {
    kept_ = 0;
    forgotten_ = 0;
  }
  /// Number of resamplings so far.
  std::uint32_t generation() const { return forgotten_ + static_cast<std::uint32_t>(kept_); }
  void add(const StepContext& context, std::span<const std::uint32_t> parents) {
    if (kept_ == parents_.size()) parents_.emplace_back(particles_);
    const std::span<std::uint32_t> kept = parents_[kept_++];
    BlockTasks<double>(particles_).run_together(context, [&](std::size_t first, std::size_t n) {
      std::ranges::copy(parents.subspan(first, n), kept.subspan(first, n).begin());
    });
  }
  /// Returns whether so much is stored that all data should be copied and forget() called.
  bool is_long() const { return kept_ * particles_ >= kMostNumbers || kept_ >= kLongest; }
  void forget() {
    forgotten_ = generation();
    kept_ = 0;
  }

  /// The index in generation `since` of the ancestor of a present particle.
  std::uint32_t trace(std::uint32_t since, std::uint32_t particle) const {
    trace(since, particle, std::span(&particle, 1));
    return particle;
  }
  /// Writes the indices in generation `since` of the ancestors of the present particles from
  /// `first` on; `since` must not be before the last forget().
  void trace(std::uint32_t since, std::size_t first, std::span<std::uint32_t> ancestors) const {
    std::iota(ancestors.begin(), ancestors.end(), static_cast<std::uint32_t>(first));
    for (std::size_t g = kept_; g-- > since - forgotten_;) {
      const std::uint32_t* parents = parents_[g].data();
      for (std::uint32_t& index : ancestors) index = parents[index];
    }
  }

 private:
  static constexpr std::size_t kLongest = 256;  // largest number of generations that are kept
  static constexpr std::size_t kMostNumbers = 1U << 22;  // largest number of indices, 16 MiB
  std::size_t particles_;
  // {generation} parents of all particles. The memory is reused after forget().
  std::vector<UntouchedColumn<std::uint32_t>> parents_;
  std::size_t kept_ = 0;  // number of generations that are kept
  std::uint32_t forgotten_ = 0;
};

}  // namespace montecarta::engine
