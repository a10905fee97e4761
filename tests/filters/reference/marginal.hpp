// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_options.hpp"
#include "tests/filters/reference/gaussian.hpp"
#include "tests/filters/reference/particle.hpp"
#include "tests/filters/reference/resampling.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace montecarta::reference {

/// Marginal and auxiliary marginal particle filter as SPEC 14 and 15 write them, in plain Eigen,
/// known association, the map by Gauss-Newton with numerical care left out: what production is held
/// to.
class Marginal {
 public:
  Marginal(const MarginalSettings& settings, const Belief& belief, std::size_t landmarks)
      : settings_(settings), belief_(belief), map_(landmarks) {
    R_ = Eigen::Vector2d(std::pow(belief.sigma_range, 2), std::pow(belief.sigma_bearing, 2))
             .asDiagonal();
    Q_ = Eigen::Vector2d(std::pow(belief.sigma_speed, 2), std::pow(belief.sigma_steer, 2))
             .asDiagonal();
    floor_ = Eigen::Vector3d(std::pow(settings.kernel_floor_xy, 2),
                             std::pow(settings.kernel_floor_xy, 2),
                             std::pow(settings.kernel_floor_heading, 2))
                 .asDiagonal();
  }

  void start(const Pose& start) {
    const Eigen::Vector3d at(start.x, start.y, start.heading);
    pose.assign(settings_.particles, at);
    mean_ = pose;
    covariance_.assign(settings_.particles, Eigen::Matrix3d::Zero());
    weight.assign(settings_.particles, 1.0 / static_cast<double>(settings_.particles));
    std::fill(map_.begin(), map_.end(), std::nullopt);
  }

  void predict(const StepContext&, const Control& control, double duration) {
    for (std::size_t j = 0; j < mean_.size(); ++j) {
      const auto step = linearised_move(as_pose(mean_[j]), control, duration, belief_.vehicle);
      const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
      const Matrix32 G = control_jacobian(step.jacobians);
      covariance_[j] = (F * covariance_[j] * F.transpose() + G * Q_ * G.transpose()).eval();
      mean_[j] = Eigen::Vector3d(step.pose.x, step.pose.y, step.pose.heading);
    }
  }

  void update(const StepContext& context, Scan scan) {
    if (scan.empty()) return;
    const std::size_t M = settings_.particles;
    std::vector<Gaussian> prior(M), proposal(M);
    std::vector<double> lambda(M);
    for (std::size_t j = 0; j < M; ++j) {
      prior[j] = proposal[j] = {mean_[j], covariance_[j] + floor_};
      double log_explained = log_likelihood(mean_[j], scan);
      if (settings_.kernel == Kernel::posterior) log_explained = refine(proposal[j], scan);
      lambda[j] = weight[j];
      if (settings_.choice == Choice::by_likelihood) lambda[j] *= std::exp(log_explained);
    }
    normalise(lambda);
    ancestor = draw_parents(Scheme::stratified, lambda, context);
    for (std::uint32_t i = 0; i < M; ++i) pose[i] = draw(context, i, proposal[ancestor[i]]);
    std::vector<double> weighed(M);
    for (std::size_t i = 0; i < M; ++i) {
      double numerator = 0.0, denominator = 0.0;
      for (std::size_t j = 0; j < M; ++j) {
        numerator += weight[j] * density(prior[j], pose[i]);
        denominator += lambda[j] * density(proposal[j], pose[i]);
      }
      weighed[i] = std::exp(log_likelihood(pose[i], scan)) * numerator / denominator;
    }
    weight = weighed;
    log_evidence = std::log(normalise(weight) / static_cast<double>(M));
    learn(scan);
    mean_ = pose;
    covariance_.assign(M, Eigen::Matrix3d::Zero());
  }

  std::vector<Eigen::Vector3d> pose;  ///< drawn
  std::vector<double> weight;
  std::vector<std::uint32_t> ancestor;
  double log_evidence = 0.0;
  const std::vector<std::optional<Landmark>>& map() const { return map_; }

 private:
  struct Gaussian {
    Eigen::Vector3d mean;
    Eigen::Matrix3d covariance;
  };

  /// R alone where the map is a parameter, Hf Lambda^-1 Hf' + R where it is recursive.
  Landmark believed(std::int32_t identity) const {
    Landmark landmark = *map_[static_cast<std::size_t>(identity)];
    if (settings_.map.mode != MapMode::recursive) landmark.covariance.setZero();
    return landmark;
  }
  bool is_known(const Detection& detection) const {
    return map_[static_cast<std::size_t>(detection.identity)].has_value();
  }

  double log_likelihood(const Eigen::Vector3d& x, Scan scan) const {
    double sum = 0.0;
    for (const Detection& detection : scan) {
      if (!is_known(detection)) continue;
      const auto seen = seen_from(x, believed(detection.identity), detection, R_);
      sum += log_gaussian<2>(seen->nu, seen->S_f);
    }
    return sum;
  }

  double refine(Gaussian& g, Scan scan) const {
    double sum = 0.0;
    for (const Detection& detection : scan) {
      if (!is_known(detection)) continue;
      const auto seen = seen_from(g.mean, believed(detection.identity), detection, R_);
      const Eigen::Matrix2d S = seen->Hx * g.covariance * seen->Hx.transpose() + seen->S_f;
      const Matrix32 K = S.llt().solve(seen->Hx * g.covariance).transpose();
      g.mean += K * seen->nu;
      g.covariance -= (K * S * K.transpose()).eval();
      sum += log_gaussian<2>(seen->nu, S);
    }
    return sum;
  }

  static double normalise(std::vector<double>& w) {
    double sum = 0.0;
    for (const double x : w) sum += x;
    for (double& x : w) x /= sum;
    return sum;
  }

  static double density(const Gaussian& g, const Eigen::Vector3d& x) {
    Eigen::Vector3d e = x - g.mean;
    e(2) = wrap(e(2));
    return std::exp(log_gaussian<3>(e, g.covariance));
  }

  static Eigen::Vector3d draw(const StepContext& context, std::uint32_t i, const Gaussian& g) {
    RngStream stream = context.stream(Draw::kernel_sample, i);
    Eigen::Vector3d eps;
    for (int k = 0; k < 3; ++k) eps(k) = stream.normal();
    Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();  // from the vehicle's frame into the map's
    ahead.topLeftCorner<2, 2>() = Eigen::Rotation2D<double>(g.mean(2)).toRotationMatrix();
    const Eigen::Matrix3d seen_ahead = ahead.transpose() * g.covariance * ahead;
    Eigen::Vector3d x = g.mean + ahead * psd_chol(seen_ahead) * eps;
    x(2) = wrap(x(2));
    return x;
  }

  Eigen::Vector3d mean_pose() const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < pose.size(); ++i) {
      Eigen::Vector3d e = pose[i] - pose[0];
      e(2) = wrap(e(2));
      mean += weight[i] * e;
    }
    return pose[0] + mean;
  }

  void learn(Scan scan) {
    std::vector<Detection> fresh;
    for (const Detection& detection : scan) {
      if (is_known(detection)) {
        learn_place(*map_[static_cast<std::size_t>(detection.identity)], detection);
      } else {
        fresh.push_back(detection);
      }
    }
    for (const Detection& detection : fresh) {
      Landmark born = new_landmark(mean_pose(), detection, R_);
      born.mean.setZero();
      for (std::size_t i = 0; i < pose.size(); ++i)
        born.mean += weight[i] * new_landmark(pose[i], detection, R_).mean;
      map_[static_cast<std::size_t>(detection.identity)] = born;
    }
  }

  /// -2 log Sum w exp(-nu' R^-1 nu / 2), or a mean of squares (SPEC 15.1).
  double objective(const Landmark& at, const Detection& detection) const {
    double likelihood = 0.0, squares = 0.0, printed = 0.0;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const auto seen = seen_from(pose[i], at, detection, R_);
      const double squared = seen->nu.dot(R_.llt().solve(seen->nu));
      likelihood += weight[i] * std::exp(-0.5 * squared);
      squares += weight[i] * squared;
      printed += squared / static_cast<double>(pose.size());
    }
    if (settings_.map.objective == MapObjective::squares) return squares;
    if (settings_.map.objective == MapObjective::squares_as_printed) return printed;
    return -2.0 * std::log(likelihood);
  }

  /// SPEC 15.3 by Newton's method with the Gauss-Newton matrix, until it rests.
  void learn_place(Landmark& landmark, const Detection& detection) const {
    const bool recursive = settings_.map.mode == MapMode::recursive;
    if (settings_.map.mode == MapMode::onestep_threshold &&
        objective(landmark, detection) <= settings_.map.threshold)
      return;
    const Eigen::Matrix2d prior =
        recursive ? Eigen::Matrix2d(landmark.covariance.llt().solve(Eigen::Matrix2d::Identity()))
                  : Eigen::Matrix2d(Eigen::Matrix2d::Zero());
    const Eigen::Vector2d before = landmark.mean;
    for (int k = 0; k < 30; ++k) {
      Eigen::Matrix2d A = prior;
      Eigen::Vector2d g = -prior * (landmark.mean - before);
      for_each_share(landmark, detection, [&](double share, const Seen& seen) {
        A += share * seen.Hf.transpose() * R_.llt().solve(seen.Hf);
        g += share * seen.Hf.transpose() * R_.llt().solve(seen.nu);
      });
      landmark.mean += A.llt().solve(g);
    }
    Eigen::Matrix2d information = prior;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const auto seen = seen_from(pose[i], landmark, detection, R_);
      information += weight[i] * seen->Hf.transpose() * R_.llt().solve(seen->Hf);
    }
    landmark.covariance = information.llt().solve(Eigen::Matrix2d::Identity());
  }

  void for_each_share(const Landmark& at, const Detection& detection,
                      const std::function<void(double, const Seen&)>& visit) const {
    const MapObjective objective = settings_.map.objective;
    double total = 0.0;
    std::vector<double> share(pose.size());
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const auto seen = seen_from(pose[i], at, detection, R_);
      share[i] = objective == MapObjective::squares_as_printed ? 1.0 : weight[i];
      if (objective == MapObjective::likelihood)
        share[i] *= std::exp(-0.5 * seen->nu.dot(R_.llt().solve(seen->nu)));
      total += share[i];
    }
    for (std::size_t i = 0; i < pose.size(); ++i)
      visit(share[i] / total, *seen_from(pose[i], at, detection, R_));
  }

  MarginalSettings settings_;
  Belief belief_;
  Eigen::Matrix2d R_, Q_;
  Eigen::Matrix3d floor_;
  std::vector<Eigen::Vector3d> mean_;
  std::vector<Eigen::Matrix3d> covariance_;
  std::vector<std::optional<Landmark>> map_;
};

}  // namespace montecarta::reference
