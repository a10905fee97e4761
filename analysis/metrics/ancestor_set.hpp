// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Ancestors of all particles of a scan, each once, while a genealogy is walked back. Keeps its
/// memory from walk to walk.
class AncestorSet {
 public:
  /// All of `particles` themselves.
  void start(std::size_t particles) {
    stamp_.resize(std::max(stamp_.size(), particles));
    members_.resize(particles);
    std::iota(members_.begin(), members_.end(), 0u);
  }
  /// `indices` below the number of particles of the last start(), each once.
  void assign(std::span<const std::uint32_t> indices) {
    members_.assign(indices.begin(), indices.end());
    make_distinct();
  }
  /// From children to their parents, {particle}.
  void step_back(std::span<const std::uint32_t> parents) {
    for (std::uint32_t& member : members_) member = parents[member];
    make_distinct();
  }
  std::size_t size() const { return members_.size(); }

 private:
  void make_distinct() {
    ++now_;
    std::size_t kept = 0;
    for (const std::uint32_t member : members_) {
      if (stamp_[member] == now_) continue;
      stamp_[member] = now_;
      members_[kept++] = member;
    }
    members_.resize(kept);
  }

  std::vector<std::uint32_t> members_;
  std::vector<std::uint64_t> stamp_;  ///< {index} in which set it was last seen
  std::uint64_t now_ = 0;             ///< stamp of the set being made
};

}  // namespace montecarta::analysis
