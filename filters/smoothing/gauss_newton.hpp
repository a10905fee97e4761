// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/smoothing/elimination.hpp"

namespace montecarta::filters {

/// The maximum a posteriori estimate of all poses and landmarks (EQUATIONS 21), by Gauss and Newton
/// in relative coordinates. A step is halved while the sum of squares rises.
class GaussNewton {
 public:
  explicit GaussNewton(const SensorNoise& noise) : noise_(noise), elimination_(noise) {}

  /// Moves `estimate` to the least sum of squares: the last step, from where the elimination was
  /// linearised, is one expected to lower it by less than `tolerance`, the square of a step in
  /// standard deviations, or the 20th. False where the landmarks are not determined or a number is
  /// none; then the estimate is what it was.
  [[nodiscard]] bool solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate);
  /// Of the last linearisation; see Elimination.
  const Elimination& elimination() const { return elimination_; }

 private:
  double squares(const FactorGraph& graph, const GraphEstimate& estimate) const;
  void move(double share, GraphEstimate& estimate) const;
  double take_step(const FactorGraph& graph, double before, GraphEstimate& estimate);

  SensorNoise noise_;
  Elimination elimination_;
  GraphMinimum minimum_;
  GraphEstimate given_, tried_;  ///< scratch
};

}  // namespace montecarta::filters
