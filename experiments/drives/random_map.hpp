// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace montecarta::experiments {

/// Draws the map of a run: every landmark displaced from where the world has it, uniformly within a
/// distance. A pure function of (study seed, run).
class RandomMap {
 public:
  /// `places` [m] in the world; `shift` [m] at most.
  RandomMap(std::vector<Eigen::Vector2d> places, double shift, std::uint64_t seed)
      : places_(std::move(places)), shift_(shift), seed_(seed) {}

  /// [m] by identity.
  std::vector<Eigen::Vector2d> operator()(std::uint64_t run) const;

 private:
  std::vector<Eigen::Vector2d> places_;
  double shift_;
  std::uint64_t seed_;
};

}  // namespace montecarta::experiments
