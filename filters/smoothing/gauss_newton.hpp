// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/smoothing/elimination.hpp"

namespace montecarta::filters {

/// The maximum a posteriori estimate of all poses and landmarks (EQUATIONS 21), by Gauss-Newton in
/// relative coordinates. A step is halved as long as the sum of squares rises.
class GaussNewton {
 public:
  explicit GaussNewton(const BelievedSensor& sensor, Jacobians jacobians = Jacobians::latest)
      : sensor_(sensor),
        elimination_(sensor, jacobians),
        stops_at_rise_(jacobians == Jacobians::first) {}

  /// Moves `estimate` to the least sum of squares, in at most 20 steps. It ends after a step that
  /// was predicted to lower the sum by less than `tolerance`, the square of a step in standard
  /// deviations; the elimination is linearised before that step. Returns false if landmarks are not
  /// determined or the sum is NaN; the estimate is then unchanged.
  [[nodiscard]] bool solve(const FactorGraph& graph, double tolerance, GraphEstimate& estimate);
  /// Does what Elimination::marginalise_first_pose() does.
  void marginalise_first_pose(const FactorGraph& graph, const GraphEstimate& estimate,
                              GraphPrior& prior) {
    elimination_.marginalise_first_pose(graph, estimate, prior);
  }
  /// The last linearisation.
  const Elimination& elimination() const { return elimination_; }

 private:
  double squares(const FactorGraph& graph, const GraphEstimate& estimate) const;
  void move(double share, GraphEstimate& estimate) const;
  double take_step(const FactorGraph& graph, double before, GraphEstimate& estimate);

  BelievedSensor sensor_;
  Elimination elimination_;
  bool stops_at_rise_;
  GraphMinimum minimum_;
  GraphEstimate given_, tried_;  ///< scratch
};

}  // namespace montecarta::filters
