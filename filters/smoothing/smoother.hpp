// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/setup/filter_kind.hpp"
#include "filters/smoothing/elimination.hpp"

namespace montecarta::filters {

/// The maximum a posteriori estimate of all poses and landmarks (EQUATIONS 21), by Gauss-Newton in
/// relative coordinates. A step is halved as long as the sum of squares rises.
class GaussNewton {
 public:
  explicit GaussNewton(const BelievedSensor& sensor) : sensor_(sensor), elimination_(sensor) {}

  /// Moves `estimate` to the least sum of squares, in at most 20 steps. It ends after a step that
  /// was predicted to lower the sum by less than `tolerance`, the square of a step in standard
  /// deviations; the elimination is linearised before that step. Returns false if landmarks are not
  /// determined or the sum is NaN; the estimate is then unchanged.
  [[nodiscard]] bool solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate);
  /// The last linearisation.
  const Elimination& elimination() const { return elimination_; }

 private:
  double squares(const FactorGraph& graph, const GraphEstimate& estimate) const;
  void move(double share, GraphEstimate& estimate) const;
  double take_step(const FactorGraph& graph, double before, GraphEstimate& estimate);

  BelievedSensor sensor_;
  Elimination elimination_;
  GraphMinimum minimum_;
  GraphEstimate given_, tried_;  ///< scratch
};

FilterKind smoother_kind();

}  // namespace montecarta::filters
