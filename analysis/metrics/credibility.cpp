// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/credibility.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostScans = 100, kMostSamples = 2'000'000;
constexpr std::size_t kFewestRuns = 10;

}  // namespace

CredibilitySamples::CredibilitySamples(std::size_t scans) {
  const std::size_t every = std::max<std::size_t>(1, (scans + kMostScans - 1) / kMostScans);
  for (std::size_t s = every - 1; s < scans; s += every) kept_.push_back({s, {}});
}

void CredibilitySamples::add(std::span<const Eigen::Vector3d> errors,
                             std::span<const double> nees) {
  if (samples_ > kMostSamples && kept_.size() > 1) keep_every_second();
  for (KeptScan& kept : kept_) {
    const double value = nees[kept.scan];
    if (!errors[kept.scan].allFinite() || !std::isfinite(value) || !(value > 0.0)) continue;
    kept.runs.push_back({errors[kept.scan], value});
    ++samples_;
  }
}

void CredibilitySamples::keep_every_second() {
  samples_ = 0;
  for (std::size_t k = 0; 2 * k + 1 < kept_.size(); ++k) {
    kept_[k] = std::move(kept_[2 * k + 1]);
    samples_ += kept_[k].runs.size();
  }
  kept_.resize(kept_.size() / 2);
}

Credibility CredibilitySamples::result() const {
  double absolute = 0.0, sum = 0.0, n = 0.0;
  for (const auto& [scan, runs] : kept_) {
    if (runs.size() < kFewestRuns) continue;
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    for (const Sample& one : runs) squares += one.error * one.error.transpose();
    const Eigen::LLT<Eigen::Matrix3d> S(squares / static_cast<double>(runs.size()));
    if (S.info() != Eigen::Success) continue;
    for (const Sample& one : runs) {
      const double right = one.error.dot(S.solve(one.error));
      const double decibel = 10.0 * std::log10(one.nees / right);
      absolute += std::abs(decibel);
      sum += decibel;
      n += 1.0;
    }
  }
  return {absolute / n, sum / n};
}

}  // namespace montecarta::analysis
