// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_options.hpp"
#include "filters/plain/evolution.hpp"
#include "filters/plain/particle.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters::plain {

/// Poses with weights that sum to one.
struct WeightedPoses {
  std::vector<Vector<3>> pose;
  std::vector<double> weight;
};

/// The update of a landmark of the shared map by one detection that is made from all poses
/// (EQUATIONS 14; Havangi et al. 2013, (19) to (31)).
class MapLearning {
 public:
  MapLearning(const MapSettings& settings, const Belief& belief)
      : settings_(settings), belief_(belief), R_(observation_noise(belief)) {
    evolution_.settings = settings.evolution;
    if (settings.mode == MapMode::onestep_threshold)
      evolution_.settings.good_enough = -settings.threshold;
  }

  /// A new landmark (EQUATIONS (14.1)): the mean of g(s, z), with Lambda at the mean pose.
  Landmark initialised(const WeightedPoses& cloud, const Pose& mean, const Detection& z) const {
    Landmark landmark = new_landmark(to_vector(mean), z, R_);
    landmark.mean.setZero();
    for (std::size_t i = 0; i < cloud.pose.size(); ++i)
      landmark.mean += cloud.weight[i] * new_landmark(cloud.pose[i], z, R_).mean;
    return landmark;
  }

  /// Moves a landmark to the minimum of EQUATIONS (14.2), unless it is known exactly. `chance`
  /// selects the random numbers of evolution; its candidates are scattered along and across
  /// `heading`.
  void learn(const StreamIdentity& chance, double heading, const WeightedPoses& cloud,
             const Detection& z, Landmark& landmark) {
    if (landmark.covariance.isZero(0.0)) return;
    Known known{landmark.mean, Matrix<2>::Zero()};
    if (settings_.mode == MapMode::recursive) known.information = inverse_of(landmark.covariance);
    if (settings_.mode == MapMode::onestep_threshold &&
        objective(landmark.mean, cloud, z) <= settings_.threshold) {
      ++left_alone_;
      return;
    }
    landmark.mean = settings_.solver == MapSolver::de ? evolved(chance, heading, cloud, z, known)
                                                      : descended(cloud, z, known);
    const Normal normal = normal_equations(landmark.mean, cloud, z, cloud.weight);
    if (normal.A(0, 0) > 0.0) landmark.covariance = inverse_of(known.information + normal.A);
  }

  const Evolution<2>& evolution() const { return evolution_; }
  /// Number of detections that were in the dead zone of EQUATIONS 14.
  std::size_t left_alone() const { return left_alone_; }

 private:
  /// The landmark before the detection: theta and Lambda.
  struct Known {
    Vector<2> mean;
    Matrix<2> information;
    double squared_distance(const Vector<2>& place) const {
      return (place - mean).dot(information * (place - mean));
    }
  };
  /// Sums over the poses: A = Hf' R^-1 Hf, g = Hf' R^-1 nu.
  struct Normal {
    Matrix<2> A = Matrix<2>::Zero();
    Vector<2> g = Vector<2>::Zero();
  };

  static Matrix<2> inverse_of(const Matrix<2>& P) { return P.llt().solve(Matrix<2>::Identity()); }

  /// {pose} nu' R^-1 nu of a landmark at `place`.
  std::vector<double> squares(const Vector<2>& place, const WeightedPoses& cloud,
                              const Detection& z) const {
    std::vector<double> squares;
    for (const Vector<3>& pose : cloud.pose) {
      const auto h = predicted_observation(as_pose(pose), Point{place(0), place(1)});
      squares.push_back(squared_distance(difference(z, filters::to_vector(h)), R_));
    }
    return squares;
  }

  /// {pose} log(w) - nu' R^-1 nu / 2, the terms of Havangi (27).
  std::vector<double> log_terms(const Vector<2>& place, const WeightedPoses& cloud,
                                const Detection& z) const {
    std::vector<double> terms = squares(place, cloud, z);
    for (std::size_t i = 0; i < terms.size(); ++i)
      terms[i] = std::log(cloud.weight[i]) - 0.5 * terms[i];
    return terms;
  }

  /// c of EQUATIONS (14.2), by `map_objective`.
  double objective(const Vector<2>& place, const WeightedPoses& cloud, const Detection& z) const {
    if (settings_.objective == MapObjective::likelihood)
      return -2.0 * log_sum_exp(log_terms(place, cloud, z));
    const std::vector<double> all = squares(place, cloud, z), share = even_or_weight(cloud);
    double mean = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) mean += share[i] * all[i];
    return mean;
  }
  /// The factors of the squares: weights, or 1 / M as Havangi (29) prints it.
  std::vector<double> even_or_weight(const WeightedPoses& cloud) const {
    if (settings_.objective == MapObjective::squares) return cloud.weight;
    return std::vector(cloud.weight.size(), 1.0 / static_cast<double>(cloud.weight.size()));
  }

  Normal normal_equations(const Vector<2>& place, const WeightedPoses& cloud, const Detection& z,
                          const std::vector<double>& share) const {
    const Landmark at{.mean = place, .covariance = Matrix<2>::Zero()};
    Normal sum;
    for (std::size_t i = 0; i < share.size(); ++i) {
      const auto v = innovation_at(cloud.pose[i], at, z, R_);
      if (!v) continue;
      const Matrix<2> gradient = gain<2, 2>(v->Hf.transpose(), R_);
      sum.A += share[i] * gradient * v->Hf;
      sum.g += share[i] * gradient * v->nu;
    }
    return sum;
  }

  /// The minimum by Gauss-Newton, from the old place on as long as J falls. Every pose counts by
  /// how well it explains the detection.
  Vector<2> descended(const WeightedPoses& cloud, const Detection& z, const Known& known) const {
    Vector<2> place = known.mean;
    const auto J = [&](const Vector<2>& at) {
      return objective(at, cloud, z) + known.squared_distance(at);
    };
    for (int k = 0; k < 30; ++k) {
      std::vector<double> share;
      if (settings_.objective == MapObjective::likelihood) {
        share = log_terms(place, cloud, z);
        const double log_sum = log_sum_exp(share);
        for (double& one : share) one = std::exp(one - log_sum);
      } else {
        share = even_or_weight(cloud);
      }
      const auto [A, g] = normal_equations(place, cloud, z, share);
      const Vector<2> step =
          (known.information + A).llt().solve(g - known.information * (place - known.mean));
      const bool falls = J(place + step) < J(place);
      if (!falls && !(step.norm() < 1e-6)) break;
      place += step;
      if (step.norm() < 1e-12) break;
    }
    return place;
  }

  /// The minimum by differential evolution: the first candidate is the old place, the others are
  /// uniform within three standard deviations of the sensor.
  Vector<2> evolved(const StreamIdentity& chance, double heading, const WeightedPoses& cloud,
                    const Detection& z, const Known& known) {
    const double half = 3.0 * std::max(belief_.sigma_range, z[0] * belief_.sigma_bearing);
    std::vector<Vector<2>> population(settings_.population, Vector<2>::Zero());
    for (std::uint32_t k = 1; k < population.size(); ++k) {
      RngStream draw(chance, k);
      for (double& one : population[k]) one = half * (2.0 * draw.uniform() - 1.0);
    }
    const Matrix<2> ahead = Eigen::Rotation2D<double>(heading).toRotationMatrix();
    const auto place_of = [&](const Vector<2>& offset) -> Vector<2> {
      return known.mean + ahead * offset;
    };
    evolution_.half.setConstant(half);
    return place_of(
        evolution_.best_of(population, chance, static_cast<std::uint32_t>(population.size()),
                           [&](std::size_t, const Vector<2>& offset) {
                             const Vector<2> place = place_of(offset);
                             return -objective(place, cloud, z) - known.squared_distance(place);
                           }));
  }

  MapSettings settings_;
  Belief belief_;
  Matrix<2> R_;
  Evolution<2> evolution_;
  std::size_t left_alone_ = 0;
};

}  // namespace montecarta::filters::plain
