// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_setup.hpp"

namespace montecarta::filters {

/// The believed variances of the components of a Measurement [m^2] or [rad^2]. The variance of a
/// component that the sensor does not have is 1.
struct SensorNoise {
  double first;
  double second;

  static SensorNoise of(const Belief& belief) {
    const Eigen::Vector2d sigma = deviations_of(belief.sensor, belief);
    return {sigma(0) * sigma(0), sigma(1) * sigma(1)};
  }
};

/// The effect of a scan on the weights of one block.
template <class Real>
struct Weighing {
  Real log_weight;  ///< log of the factor of the weight
  Real faults;      ///< numerical faults of this scan
};

/// The product of the densities N(innovation; S) of one particle's detections. Up to 16
/// determinants share one logarithm.
template <class Real>
class Evidence {
 public:
  /// Adds one detection: `squared` is innovation' S^-1 innovation, `determinant` is det S; (0, 1)
  /// adds nothing. `matched` is 1 in the lanes that matched the detection and `used` is 1 in those
  /// of them that could use it, else 0.
  [[gnu::always_inline]] void add(const Real& squared, const Real& determinant, const Real& used,
                                  const Real& matched) {
    squared_ += squared;
    determinant_ *= determinant;
    count_ += used;
    left_out_ += matched - used;
    if (++since_logarithm_ == kBetweenLogarithms) take_logarithm();
  }
  /// Number of detections that matched a landmark too near to be used.
  const Real& left_out() const { return left_out_; }
  /// Logarithm of the product.
  Real log_density() const {
    return -0.5 * (squared_ + log_determinant_ + log(determinant_)) - kLogTwoPi * count_;
  }

 private:
  static constexpr int kBetweenLogarithms = 16;  // determinants down to 1e-19 do not underflow
  static constexpr double kLogTwoPi = 1.8378770664093454836;

  void take_logarithm() {
    log_determinant_ += log(determinant_);
    determinant_ = Real(1.0);
    since_logarithm_ = 0;
  }

  Real squared_{0.0}, determinant_{1.0}, log_determinant_{0.0}, count_{0.0}, left_out_{0.0};
  int since_logarithm_ = 0;
};

/// Is used in the place of an Evidence that is not needed.
template <class Real>
struct Unweighed {
  [[gnu::always_inline]] void add(const Real&, const Real&, const Real&, const Real&) const {}
};

}  // namespace montecarta::filters
