// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"
#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// What a sensor's noise is believed to be: variances of the components of its detections, named
/// after those of range [m^2] and bearing [rad^2]; 1 of a component that it does not have.
struct SensorNoise {
  double range;
  double bearing;

  static SensorNoise of(const Belief& belief) {
    const Eigen::Vector2d sigma = deviations_of(belief.sensor, belief);
    return {sigma(0) * sigma(0), sigma(1) * sigma(1)};
  }
};

/// What a scan does to the weights of one block.
template <class Real>
struct Weighing {
  Real log_weight;  ///< log of the factor
  Real faults;      ///< numerical faults met on the way
};

/// The product of densities N(innovation; S) of one particle's detections, with one logarithm for
/// many.
template <class Real>
class Evidence {
 public:
  /// One detection: `squared` = innovation' S^-1 innovation, `determinant` = det S; (0, 1) =
  /// nothing seen.
  /// `used` of the `matched` lanes (1 or 0) could be used.
  [[gnu::always_inline]] void add(const Real& squared, const Real& determinant, const Real& used,
                                  const Real& matched) {
    squared_ += squared;
    determinant_ *= determinant;
    count_ += used;
    left_out_ += matched - used;
    if (++since_logarithm_ == kBetweenLogarithms) take_logarithm();
  }
  /// Detections that matched a landmark too near to be used.
  const Real& left_out() const { return left_out_; }
  /// Log of the product.
  Real log_density() const {
    return -0.5 * (squared_ + log_determinant_ + log(determinant_)) - kLogTwoPi * count_;
  }

 private:
  static constexpr int kBetweenLogarithms = 16;  // determinants down to 1e-19 stay in range
  static constexpr double kLogTwoPi = 1.8378770664093454836;

  void take_logarithm() {
    log_determinant_ += log(determinant_);
    determinant_ = Real(1.0);
    since_logarithm_ = 0;
  }

  Real squared_{0.0}, determinant_{1.0}, log_determinant_{0.0}, count_{0.0}, left_out_{0.0};
  int since_logarithm_ = 0;
};

/// In place of an Evidence where nobody weighs by it.
template <class Real>
struct Unweighed {
  [[gnu::always_inline]] void add(const Real&, const Real&, const Real&, const Real&) const {}
};

}  // namespace montecarta::filters
