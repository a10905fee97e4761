// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/moments/linearised.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace montecarta::filters {

/// Moments of the predicted detection over all particles, for the normalised innovation squared of
/// the whole filter: the mixture's innovation is the weighted mean, its covariance the mean of S
/// plus the spread of the innovations (weights before the scan). Tasks sum apart and are added in
/// order.
template <class Real>
class MixtureInnovations {
  struct Sums {
    RangeBearing<Real> value{Real(0.0), Real(0.0)};
    Symmetric2<Real> square{Real(0.0), Real(0.0), Real(0.0)};
  };

 public:
  /// `matched`: the weight of the particles that match a detection, before the scan.
  void start(std::size_t tasks, std::size_t detections, double matched = 1.0) {
    matched_.assign(detections, matched);
    sums_.assign(tasks * detections, Sums{});
  }
  double& matched_weight(std::size_t detection) { return matched_[detection]; }

  /// Where the particles of one block add their innovations.
  struct OfBlock {
    Sums* sums;
    Real weight;

    /// `matched`: the lanes that matched detection k.
    template <class Mask>
    [[gnu::always_inline]] void add(std::size_t k, const Innovation<Real>& v,
                                    const Mask& matched) const {
      const Real share = weight * as_number<Real>(matched);
      Sums& sum = sums[k];
      sum.value.range += share * v.value.range;
      sum.value.bearing += share * v.value.bearing;
      sum.square = sum.square + (share * v.S + outer(share, v.value));
    }
  };
  OfBlock of_block(std::size_t task, const Real& weight) {
    return {sums_.data() + task * matched_.size(), weight};
  }

  /// Adds to the NIS every detection, of so many components, that most of the filter takes for the
  /// same landmark.
  void add_to(ScanReport& report, std::size_t components = 2) const {
    for (std::size_t k = 0; k < matched_.size(); ++k) {
      if (matched_[k] < 0.5) continue;
      report.nis += normalised_squared(k);
      report.nis_dof += static_cast<std::uint32_t>(components);
    }
  }

 private:
  /// nu' S^-1 nu of detection k.
  double normalised_squared(std::size_t k) const {
    std::array<double, 5> total{};
    for (std::size_t at = k; at < sums_.size(); at += matched_.size()) {
      const auto& [value, square] = sums_[at];
      const std::array<const Real*, 5> parts{&value.range, &value.bearing, &square.xx, &square.xy,
                                             &square.yy};
      for (std::size_t f = 0; f < 5; ++f) {
        for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) total[f] += get(*parts[f], lane);
      }
    }
    for (double& sum : total) sum /= matched_[k];
    const auto [r, b, rr, rb, bb] = total;
    const Symmetric2<double> S{rr - r * r, rb - r * b, bb - b * b};
    return S.adjugate_form(r, b) / S.determinant();
  }

  std::vector<double> matched_;  ///< {detection}
  std::vector<Sums> sums_;       ///< {task, detection}
};

}  // namespace montecarta::filters
