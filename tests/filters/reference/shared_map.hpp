// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_options.hpp"
#include "tests/filters/reference/evolution.hpp"
#include "tests/filters/reference/particle.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace montecarta::filters::reference {

/// Poses and their weights, which sum to one.
struct WeighedPoses {
  std::vector<Eigen::Vector3d> pose;
  std::vector<double> weight;
};

/// How a landmark of the one map learns from a detection made from all poses, as EQUATIONS 14
/// writes it, in plain Eigen: by evolution, or by Gauss-Newton with numerical care left out.
class SharedMapLearning {
 public:
  SharedMapLearning(const MapSettings& settings, const Belief& belief)
      : settings_(settings), belief_(belief) {
    R_ = Eigen::Vector2d(std::pow(belief.sigma_range, 2), std::pow(belief.sigma_bearing, 2))
             .asDiagonal();
    evolution_.base = static_cast<Base>(settings.evolution.base);
    evolution_.scale = settings.evolution.scale;
    evolution_.crossover = settings.evolution.crossover;
    evolution_.generations = settings.evolution.generations;
    if (settings.mode == MapMode::onestep_threshold) evolution_.good_enough = -settings.threshold;
  }

  /// theta = Sum w g(s, z), Lambda as seen from the mean pose.
  Landmark initialised(const WeighedPoses& cloud, const Pose& mean,
                       const Detection& detection) const {
    Landmark landmark = new_landmark({mean.x, mean.y, mean.heading}, detection, R_);
    landmark.mean.setZero();
    for (std::size_t i = 0; i < cloud.pose.size(); ++i)
      landmark.mean += cloud.weight[i] * new_landmark(cloud.pose[i], detection, R_).mean;
    return landmark;
  }

  /// `heading`: candidates are scattered ahead of it and to its left.
  void learn(const StreamIdentity& chance, double heading, const WeighedPoses& cloud,
             const Detection& detection, Landmark& landmark) {
    Known known{landmark.mean, Eigen::Matrix2d::Zero()};
    if (settings_.mode == MapMode::recursive) known.information = landmark.covariance.inverse();
    if (settings_.mode == MapMode::onestep_threshold &&
        objective(landmark.mean, cloud, detection) <= settings_.threshold) {
      ++left_alone_;
      return;
    }
    landmark.mean = settings_.solver == MapSolver::de
                        ? evolved_place(chance, heading, cloud, detection, known)
                        : gauss_newton_place(cloud, detection, known);
    Eigen::Matrix2d information = known.information;
    for (std::size_t i = 0; i < cloud.pose.size(); ++i) {
      const Eigen::Matrix2d Hf = seen_from(cloud.pose[i], landmark, detection, R_)->Hf;
      information += cloud.weight[i] * Hf.transpose() * R_.inverse() * Hf;
    }
    landmark.covariance = information.inverse();
  }

  const Evolution<2>& evolution() const { return evolution_; }
  /// Landmarks in the dead zone of EQUATIONS 14, so far.
  std::size_t left_alone() const { return left_alone_; }

 private:
  /// What is known before the detection: theta and Lambda.
  struct Known {
    Eigen::Vector2d mean;
    Eigen::Matrix2d information;
  };

  /// nu' R^-1 nu.
  double squared(const Eigen::Vector3d& pose, const Eigen::Vector2d& place,
                 const Detection& detection) const {
    const Eigen::Vector2d nu =
        to_vector(residual(observation_of(detection),
                           predicted_observation(as_pose(pose), Point{place(0), place(1)})));
    return nu.dot(R_.inverse() * nu);
  }

  /// -2 log Sum w exp(-nu' R^-1 nu / 2), or a mean of squares (EQUATIONS 14).
  double objective(const Eigen::Vector2d& place, const WeighedPoses& cloud,
                   const Detection& detection) const {
    double mean = 0.0, printed = 0.0;
    std::vector<double> log_terms;
    for (std::size_t i = 0; i < cloud.pose.size(); ++i) {
      const double one = squared(cloud.pose[i], place, detection);
      log_terms.push_back(std::log(cloud.weight[i]) - 0.5 * one);
      mean += cloud.weight[i] * one;
      printed += one / static_cast<double>(cloud.pose.size());
    }
    if (settings_.objective == MapObjective::squares) return mean;
    if (settings_.objective == MapObjective::squares_as_printed) return printed;
    const double peak = *std::max_element(log_terms.begin(), log_terms.end());
    double sum = 0.0;
    for (const double term : log_terms) sum += std::exp(term - peak);
    return -2.0 * (peak + std::log(sum));
  }

  /// EQUATIONS 14.
  Eigen::Vector2d evolved_place(const StreamIdentity& chance, double heading,
                                const WeighedPoses& cloud, const Detection& detection,
                                const Known& known) {
    const double half = 3.0 * std::max(belief_.sigma_range, detection[0] * belief_.sigma_bearing);
    std::vector<Eigen::Vector2d> population(settings_.population, Eigen::Vector2d::Zero());
    for (std::uint32_t k = 1; k < population.size(); ++k) {
      RngStream draw(chance, k);
      for (int axis = 0; axis < 2; ++axis)
        population[k](axis) = half * (2.0 * draw.uniform() - 1.0);
    }
    const Eigen::Matrix2d ahead = Eigen::Rotation2D<double>(heading).toRotationMatrix();
    evolution_.half.setConstant(half);
    const Eigen::Vector2d best =
        evolution_.best_of(population, chance, static_cast<std::uint32_t>(population.size()),
                           [&](std::size_t, const Eigen::Vector2d& offset) {
                             const Eigen::Vector2d way = ahead * offset;
                             return -(objective(known.mean + way, cloud, detection) +
                                      way.dot(known.information * way));
                           });
    return known.mean + ahead * best;
  }

  /// EQUATIONS 14 by Newton's method with the Gauss-Newton matrix, until it rests.
  Eigen::Vector2d gauss_newton_place(const WeighedPoses& cloud, const Detection& detection,
                                     const Known& known) const {
    Landmark at{.mean = known.mean, .covariance = Eigen::Matrix2d::Zero()};
    for (int k = 0; k < 30; ++k) {
      Eigen::Matrix2d A = known.information;
      Eigen::Vector2d g = -known.information * (at.mean - known.mean);
      for_each_share(at, cloud, detection, [&](double share, const Seen& seen) {
        A += share * seen.Hf.transpose() * R_.inverse() * seen.Hf;
        g += share * seen.Hf.transpose() * R_.inverse() * seen.nu;
      });
      at.mean += A.inverse() * g;
    }
    return at.mean;
  }

  void for_each_share(const Landmark& at, const WeighedPoses& cloud, const Detection& detection,
                      const std::function<void(double, const Seen&)>& visit) const {
    double total = 0.0;
    std::vector<double> share = cloud.weight;
    for (std::size_t i = 0; i < share.size(); ++i) {
      if (settings_.objective == MapObjective::squares_as_printed) share[i] = 1.0;
      if (settings_.objective == MapObjective::likelihood)
        share[i] *= std::exp(-0.5 * squared(cloud.pose[i], at.mean, detection));
      total += share[i];
    }
    for (std::size_t i = 0; i < share.size(); ++i)
      visit(share[i] / total, *seen_from(cloud.pose[i], at, detection, R_));
  }

  MapSettings settings_;
  Belief belief_;
  Eigen::Matrix2d R_;
  Evolution<2> evolution_;
  std::size_t left_alone_ = 0;
};

}  // namespace montecarta::filters::reference
