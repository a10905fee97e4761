// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/prior.hpp"
#include "engine/particles/resampling.hpp"
#include "engine/particles/weights.hpp"
#include "filters/moments/linearised.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Sum over the particles of weight times term(block): in every part of the population lane by lane
/// and then in lane order.
template <class Real, std::size_t N, class Terms>
std::array<double, N> weighted_sums(const StepContext& context, const Weights<Real>& weights,
                                    const Terms& terms) {
  const std::vector<Real>& w = weights.linear();
  const auto sums_of = [&](std::size_t first, std::size_t n) {
    std::array<Real, N> lanes;
    lanes.fill(Real(0.0));
    for (std::size_t b = first; b < first + n; ++b) {
      const std::array<Real, N> values = terms(b);
      const auto counts = w[b] > Real(0.0);  // values of lanes with weight 0 are ignored
      for (std::size_t k = 0; k < N; ++k) lanes[k] += select(counts, w[b] * values[k], Real(0.0));
    }
    std::array<double, N> sums{};
    for (std::size_t k = 0; k < N; ++k) {
      for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) sums[k] += get(lanes[k], lane);
    }
    return sums;
  };
  return joined_parts<Real>(context, w.size(), sums_of, [](auto& sums, const auto& part) {
    for (std::size_t k = 0; k < N; ++k) sums[k] += part[k];
  });
}

/// The pose of particle i. `pose_of(block)` gives the poses of one block.
template <class Real, class PoseOf>
Pose pose_of_particle(const PoseOf& pose_of, std::size_t i) {
  return of_lane<Real>(pose_of(i / kLanesOf<Real>), i % kLanesOf<Real>);
}

/// Weighted mean of poses, by differences from the heading of the heaviest one (EQUATIONS 19).
template <class Real, class PoseOf>
Pose weighted_mean(const StepContext& context, const Weights<Real>& weights,
                   const PoseOf& pose_of) {
  const Pose reference = pose_of_particle<Real>(pose_of, weights.heaviest());
  const auto sums = weighted_sums<Real, 3>(context, weights, [&](std::size_t b) {
    const BasicPose<Real> p = pose_of(b);
    return std::array<Real, 3>{p.x - reference.x, p.y - reference.y,
                               wrap(p.heading - reference.heading)};
  });
  return {reference.x + sums[0], reference.y + sums[1], wrap(reference.heading + sums[2])};
}

/// Mean and covariance of a mixture of Gaussians (EQUATIONS 19); `gaussian_of(block)`.
template <class Real, class GaussianOf>
PoseMoments mixture_of(const StepContext& context, const Weights<Real>& weights,
                       const GaussianOf& gaussian_of) {
  const Pose mean =
      weighted_mean<Real>(context, weights, [&](std::size_t b) { return gaussian_of(b).mean; });
  const auto C = weighted_sums<Real, 6>(context, weights, [&](std::size_t b) {
    const auto& [m, P] = gaussian_of(b);
    const Real x = m.x - mean.x, y = m.y - mean.y, h = wrap(m.heading - mean.heading);
    return std::array<Real, 6>{P.xx + x * x, P.xy + x * y, P.yy + y * y,
                               P.xh + x * h, P.yh + y * h, P.hh + h * h};
  });
  return {mean, symmetric({C[0], C[1], C[2], C[3], C[4], C[5]})};
}
template <class Real>
PoseMoments mixture_of(const StepContext& context, const Weights<Real>& weights,
                       const std::vector<PoseGaussian<Real>>& gaussians) {
  return mixture_of<Real>(context, weights, [&](std::size_t b) { return gaussians[b]; });
}
/// Mean and spread of the drawn poses.
template <class Real>
PoseMoments spread_of(const StepContext& context, const Weights<Real>& weights,
                      const std::vector<BasicPose<Real>>& poses) {
  return mixture_of<Real>(context, weights, [&](std::size_t b) {
    return PoseGaussian<Real>{poses[b], {}};
  });
}

/// Mean and covariance of the mixture of all particles' Gaussians of one landmark.
template <class Real>
LandmarkEstimate mixture_of_landmarks(const StepContext& context, const Weights<Real>& weights,
                                      const std::vector<LandmarkGaussian<Real>>& landmarks) {
  const auto first = weighted_sums<Real, 2>(context, weights, [&](std::size_t b) {
    return std::array<Real, 2>{landmarks[b].mean.x, landmarks[b].mean.y};
  });
  const Point mean{first[0], first[1]};
  const auto C = weighted_sums<Real, 3>(context, weights, [&](std::size_t b) {
    const Real x = landmarks[b].mean.x - mean.x, y = landmarks[b].mean.y - mean.y;
    const Symmetric2<Real>& P = landmarks[b].covariance;
    return std::array<Real, 3>{P.xx + x * x, P.xy + x * y, P.yy + y * y};
  });
  return {{mean.x, mean.y}, Eigen::Matrix2d{{C[0], C[1]}, {C[1], C[2]}}};
}

/// Second moments of a cloud of drawn poses. The estimate after a motion common to all particles
/// follows from them in closed form, so that between scans it costs the same for 10 and for 10,000
/// particles. The moved cloud is linear in v = (x, y, h, cos h, sin h), h the heading minus mean.
class CloudMoments {
 public:
  template <class Real>
  CloudMoments(const StepContext& context, const Weights<Real>& weights,
               const std::vector<BasicPose<Real>>& poses)
      : mean_(weighted_mean<Real>(context, weights, [&](std::size_t b) { return poses[b]; })),
        ahead_(direction_of(mean_.heading)) {
    const auto terms = [&](std::size_t b) {
      const Real x = poses[b].x - mean_.x, y = poses[b].y - mean_.y;
      const Real h = wrap(poses[b].heading - mean_.heading);
      const Direction<Real> d = direction_of(h);
      const Real c = d.cosine - 1.0, s = d.sine;
      return std::array<Real, 18>{h,     c,     s,     x * x, x * y, x * h, x * c, x * s, y * y,
                                  y * h, y * c, y * s, h * h, h * c, h * s, c * c, c * s, s * s};
    };
    const auto [h, c, s, xx, xy, xh, xc, xs, yy, yh, yc, ys, hh, hc, hs, cc, cs, ss] =
        weighted_sums<Real, 18>(context, weights, terms);
    turn_ = {1.0 + c, s};
    turn_squares_ = {1.0 + 2.0 * c + cc, s + cs, ss};
    pose_ = {xx, xy, yy, xh, yh, hh};
    // Headings more than half a turn from the mean wrap, so that their mean is not exactly zero.
    // They still count as deviations from the mean heading.
    x_ = {xc, xs}, y_ = {yc, ys}, h_ = {hc - h * c, hs - h * s};
    c_ = {cc - c * c, cs - c * s}, s_ = {cs - c * s, ss - s * s};
  }

  /// Mean and covariance after `increment` moved every particle and gave it a covariance of its
  /// own.
  PoseMoments moved_by(const MotionIncrement& increment) const;

 private:
  Pose mean_;
  Direction<double> ahead_;          ///< unit vector of the mean heading
  Direction<double> turn_;           ///< mean of (cos h, sin h)
  Symmetric2<double> turn_squares_;  ///< means of the squares and the product of cos h and sin h
  Symmetric3<double> pose_;          ///< covariance of (x, y, h)
  Point x_, y_, h_, c_, s_;          ///< covariances of each element of v with (cos h, sin h)
};

/// Moments of the predicted detection over all particles, for the normalised innovation squared
/// (NIS) of the whole filter. The innovation of the mixture is the weighted mean of the
/// innovations, and its covariance is the mean of S plus the spread of the innovations, with the
/// weights before the scan. Each task has its own sums, which are added in order.
template <class Real>
class MixtureInnovations {
  struct Sums {
    Measurement<Real> value{Real(0.0), Real(0.0)};
    Symmetric2<Real> square{Real(0.0), Real(0.0), Real(0.0)};
  };

 public:
  /// `matched` is the total weight, before the scan, of the particles that match a detection.
  void start(const StepContext& context, std::size_t tasks, std::size_t detections,
             double matched = 1.0) {
    matched_.assign(detections, matched);
    squared_.resize(detections);
    sums_.resize(tasks * detections);
    context.parallel_for(tasks, [&](std::size_t task) {
      std::ranges::fill(std::span(sums_).subspan(task * detections, detections), Sums{});
    });
  }
  double& matched_weight(std::size_t detection) { return matched_[detection]; }

  /// The sums to which the particles of one block add their innovations.
  struct OfBlock {
    Sums* sums;
    Real weight;

    /// `matched` is the mask of the lanes that matched detection k.
    template <class Mask>
    [[gnu::always_inline]] void add(std::size_t k, const Innovation<Real>& v,
                                    const Mask& matched) const {
      const Real share = weight * as_number<Real>(matched);
      Sums& sum = sums[k];
      sum.value.first += share * v.value.first;
      sum.value.second += share * v.value.second;
      sum.square = sum.square + (share * v.S + outer(share, v.value));
    }
  };
  OfBlock of_block(std::size_t task, const Real& weight) {
    return {sums_.data() + task * matched_.size(), weight};
  }

  /// Adds to the NIS every detection, of `components` numbers, that particles with at least half of
  /// the weight have matched. One whose covariance is not positive definite is left out, and counts
  /// as a numerical fault.
  void add_to(const StepContext& context, ScanReport& report, std::size_t components = 2) {
    context.parallel_for(matched_.size(),
                         [&](std::size_t k) { squared_[k] = normalised_squared(k); });
    for (std::size_t k = 0; k < matched_.size(); ++k) {
      if (matched_[k] < 0.5) continue;
      if (!(squared_[k] >= 0.0 && squared_[k] <= std::numeric_limits<double>::max())) {
        ++report.numerical_faults;
        continue;
      }
      report.nis += squared_[k];
      report.nis_dof += static_cast<std::uint32_t>(components);
    }
  }

 private:
  /// nu' S^-1 nu of detection k.
  double normalised_squared(std::size_t k) const {
    std::array<double, 5> total{};
    for (std::size_t at = k; at < sums_.size(); at += matched_.size()) {
      const auto& [value, square] = sums_[at];
      const std::array<const Real*, 5> parts{&value.first, &value.second, &square.xx, &square.xy,
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

  std::vector<double> matched_;  ///< {detection} weight of the particles that match it
  std::vector<double> squared_;  ///< {detection} normalised squared innovation
  std::vector<Sums> sums_;       ///< {task, detection} sums over the particles of a task
};

/// The number of particles, and how and when they are resampled (EQUATIONS 18).
struct PopulationSettings {
  std::size_t particles = 100;
  Resampling resampling = Resampling::systematic;
  double resample_below = 0.5;  ///< resample if the ESS is less than this share of the particles
};

/// The options `particles`, `resampling` and `resample_below`, and then `others`, in the order of
/// the documentation.
std::vector<Parameter> population_options(
    std::initializer_list<std::vector<Parameter>> others = {});
/// Reads the options of population_options().
PopulationSettings population_settings(const FilterOptions& options);

/// The part that is common to all filters with particles: weights, ancestors, resampling and the
/// report of a scan. Between a scan and the next step the particles have the weights of that scan
/// and are not yet resampled. Estimates and records show that state.
template <class Real>
class Population {
 public:
  explicit Population(const PopulationSettings& settings)
      : settings_(settings),
        weights_(settings.particles),
        parents_(blocks() * kLanesOf<Real>),
        ancestors_(parents_.size()),
        faults_(blocks(), Real(0.0)) {}

  std::size_t particles() const { return settings_.particles; }
  std::size_t blocks() const { return blocks_for<Real>(settings_.particles); }
  Weights<Real>& weights() { return weights_; }
  const Weights<Real>& weights() const { return weights_; }
  ScanReport& report() { return report_; }
  const ScanReport& report() const { return report_; }
  /// {particle} index of each particle one scan ago.
  std::span<const std::uint32_t> ancestors() const { return ancestors_; }

  void start() {
    weights_.make_equal();
    forget_ancestors();
    report_ = {};
    is_after_scan_ = false;
  }
  void begin_scan() {
    is_after_scan_ = true;
    report_ = {.ess = weights_.effective()};
  }
  bool is_after_scan() const { return is_after_scan_; }

  void weigh(std::size_t block, const Weighing<Real>& weighing) {
    weights_.multiply(block, weighing.log_weight);
    faults_[block] = weighing.faults;
  }
  /// Normalises the weights; to be called after weigh() of every block.
  void normalise(const StepContext& context) {
    report_.log_likelihood = weights_.normalise(context);
    report_.ess = weights_.effective();
    std::ranges::fill(scalars(faults_).subspan(settings_.particles), 0.0);
    const double faults = sum_of_parts<Real>(context, blocks(), [&](auto first, auto n) {
      Real sum(0.0);
      for (std::size_t b = first; b < first + n; ++b) sum += faults_[b];
      return sum_of_lanes(sum);
    });
    report_.numerical_faults += static_cast<std::uint32_t>(faults);
  }

  /// Draws the parents for the pending resampling if the weights have degenerated.
  void decide_on_resampling(const StepContext& context) {
    report_.resampled =
        weights_.effective() < settings_.resample_below * static_cast<double>(settings_.particles);
    if (!report_.resampled) return;
    draw_parents(settings_.resampling, weights_.linear_scalars(), context,
                 std::span(parents_).first(settings_.particles));
    std::fill(parents_.begin() + static_cast<std::ptrdiff_t>(settings_.particles), parents_.end(),
              0U);
  }
  /// Applies the pending resampling before the next step; returns whether it resampled.
  bool resample(const StepContext& context) {
    if (!std::exchange(is_after_scan_, false)) return false;
    if (!report_.resampled) {
      forget_ancestors();
      return false;
    }
    std::swap(ancestors_, parents_);
    weights_.make_equal(context);
    return true;
  }

  /// Draws the ancestors at once, by the given weights (EQUATIONS 12). Marginal filters use this,
  /// since they resample before they weigh.
  void draw_ancestors(const StepContext& context, std::span<const double> weights) {
    report_.resampled = true;
    draw_parents(settings_.resampling, weights, context,
                 std::span(ancestors_).first(settings_.particles));
  }
  /// Makes every particle its own ancestor.
  void forget_ancestors() { std::iota(ancestors_.begin(), ancestors_.end(), 0U); }

  /// Writes the requested columns of the particles. `pose_of(i)` is the pose of particle i.
  template <class PoseOf>
  void write_columns(const ParticleColumns& columns, const PoseOf& pose_of) const {
    for (std::size_t i = 0; i < columns.pose.size() / 3; ++i) {
      const Pose pose = pose_of(i);
      columns.pose[3 * i] = pose.x;
      columns.pose[3 * i + 1] = pose.y;
      columns.pose[3 * i + 2] = pose.heading;
    }
    std::copy_n(weights_.log_scalars().begin(), columns.log_weight.size(),
                columns.log_weight.begin());
    std::copy_n(ancestors_.begin(), columns.ancestor.size(), columns.ancestor.begin());
  }

 private:
  PopulationSettings settings_;
  Weights<Real> weights_;
  std::vector<std::uint32_t> parents_;  ///< parents of the pending resampling
  std::vector<std::uint32_t> ancestors_;
  std::vector<Real> faults_;  ///< {block} numerical faults of its particles in this scan
  ScanReport report_;
  bool is_after_scan_ = false;
};

/// {block} Places all particles at the start, or draws them from its Gaussian (EQUATIONS 23).
template <class Real>
void draw_start(const StepContext& context, const PoseMoments& start,
                std::vector<BasicPose<Real>>& poses) {
  const Pose& mean = start.mean;
  std::ranges::fill(poses, BasicPose<Real>{mean.x, mean.y, mean.heading});
  if (start.covariance.isZero(0.0)) return;
  const PoseFactor<Real> factor(
      PoseGaussian<Real>{poses.front(), in_every_lane<Real>(symmetric_of(start.covariance))});
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const auto first = static_cast<std::uint32_t>(b * kLanesOf<Real>);
    poses[b] = draw_from(factor, context.identity(Draw::start_sample, first));
  }
}

}  // namespace montecarta::filters
