// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/run_metrics.hpp"

#include "analysis/metrics/nees.hpp"
#include "engine/errors.hpp"
#include "engine/runs/pose.hpp"

namespace montecarta {
namespace {

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Pose pose_of(const std::vector<double>& rows, std::size_t s) {
  return {rows[3 * s], rows[3 * s + 1], rows[3 * s + 2]};
}

void measure_nees(const std::vector<double>& truth, const MomentRows& moments, NeesRows& rows) {
  const std::size_t scans = truth.empty() ? 0 : moments.covariance.size() / 9;
  for (auto& value : rows.value) value.resize(scans);
  for (auto& floored : rows.floored) floored.resize(scans);
  for (std::size_t s = 0; s < scans; ++s) {
    const Eigen::Vector3d error = boxminus(pose_of(truth, s), pose_of(moments.mean, s));
    const Eigen::Matrix3d P = Eigen::Map<const RowMajor3>(moments.covariance.data() + 9 * s);
    const std::array<Nees, 3> blocks = {nees<3>(error, P), nees<2>(error, P), nees<1>(error, P, 2)};
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      rows.value[b][s] = blocks[b].value;
      rows.floored[b][s] = blocks[b].floored ? 1 : 0;
    }
  }
}

}  // namespace

void RunMetrics::measure_errors(const RunRows& rows, std::size_t scans) {
  const std::vector<double>& mean =
      rows.mixture.mean.empty() ? rows.spread.mean : rows.mixture.mean;
  squared_position_.clear();
  squared_heading_.clear();
  if (rows.truth.empty()) return;
  expect(rows.truth.size() == 3 * scans && mean.size() == 3 * scans, "poses are {scan, 3}");
  squared_position_.resize(scans);
  squared_heading_.resize(scans);
  for (std::size_t s = 0; s < scans; ++s) {
    const Eigen::Vector3d error = boxminus(pose_of(rows.truth, s), pose_of(mean, s));
    squared_position_[s] = error(0) * error(0) + error(1) * error(1);
    squared_heading_[s] = error(2) * error(2);
  }
}

void RunMetrics::measure(const RunRows& rows, std::size_t particles,
                         std::span<const double> times) {
  measure_errors(rows, times.size());
  measure_nees(rows.truth, rows.spread, spread_);
  measure_nees(rows.truth, rows.mixture, mixture_);
  diversity_ = rows.ancestor.empty() ? nullptr : &counter_.count(rows.ancestor, particles, times);
}

}  // namespace montecarta
