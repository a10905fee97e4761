// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

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
  explicit Genealogy(std::size_t particles) : identity_(particles) {
    std::iota(identity_.begin(), identity_.end(), 0U);
  }

  void clear() {
    parents_.clear();
    forgotten_ = 0;
  }
  /// Number of resamplings so far.
  std::uint32_t generation() const {
    return forgotten_ + static_cast<std::uint32_t>(parents_.size() / identity_.size());
  }
  void add(std::span<const std::uint32_t> parents) {
    parents_.insert(parents_.end(), parents.begin(), parents.end());
  }
  /// Returns whether so much is stored that all data should be copied and forget() called.
  bool is_long() const {
    return parents_.size() >= kMostNumbers || parents_.size() / identity_.size() >= kLongest;
  }
  void forget() {
    forgotten_ = generation();
    parents_.clear();
  }

  /// The index in generation `since` of the ancestor of a present particle.
  std::uint32_t trace(std::uint32_t since, std::uint32_t particle) const {
    for (std::size_t g = generation() - forgotten_; g-- > since - forgotten_;) {
      particle = parents_[g * identity_.size() + particle];
    }
    return particle;
  }

  /// Writes source[i], the index in generation `since` of the ancestor of present particle i;
  /// `since` must not be before the last forget().
  void trace(std::uint32_t since, std::span<std::uint32_t> source) const {
    std::copy(identity_.begin(), identity_.end(), source.begin());
    for (std::size_t g = generation() - forgotten_; g-- > since - forgotten_;) {
      const std::uint32_t* parents = parents_.data() + g * identity_.size();
      for (std::uint32_t& index : source) index = parents[index];
    }
  }

 private:
  static constexpr std::size_t kLongest = 256;           // generations
  static constexpr std::size_t kMostNumbers = 1U << 22;  // 16 MiB
  std::vector<std::uint32_t> identity_;
  std::vector<std::uint32_t> parents_;  // one generation after the other
  std::uint32_t forgotten_ = 0;
};

}  // namespace montecarta::engine
