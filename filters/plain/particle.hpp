// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/plain/association.hpp"
#include "filters/plain/gaussian.hpp"
#include "filters/plain/landmark.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace montecarta::filters::plain {

/// One particle of the FastSLAM family (EQUATIONS 4), with its own map and associations.
struct Particle {
  Vector<3> pose = Vector<3>::Zero();          ///< drawn at the last scan and moved since
  Matrix<3> covariance = Matrix<3>::Zero();    ///< accumulated since the last draw
  Matrix<3> factor = Matrix<3>::Zero();        ///< its root, only if the filter keeps square roots
  Vector<3> refined_pose = Vector<3>::Zero();  ///< proposal of the last scan, before the draw
  Matrix<3> refined_covariance = Matrix<3>::Zero();
  double log_weight = 0.0;
  double log_weight_of_fix = 0.0;  ///< share of the fix of this scan
  std::uint32_t ancestor = 0;      ///< its index one scan ago
  Map map;
  std::vector<Pairing> pairings;  ///< one for each detection of the scan
};

/// Weights of particles or kernels, which have a log_weight.
template <class Weighted>
std::vector<double> weights_of(const std::vector<Weighted>& particles) {
  std::vector<double> weights;
  for (const Weighted& p : particles) weights.push_back(std::exp(p.log_weight));
  return weights;
}

/// Effective sample size (EQUATIONS (18.1)).
template <class Weighted>
double effective_size(const std::vector<Weighted>& particles) {
  const std::vector<double> w = weights_of(particles);
  return 1.0 / std::inner_product(w.begin(), w.end(), w.begin(), 0.0);
}

/// The logarithm of the sum of exp(x).
inline double log_sum_exp(const std::vector<double>& logarithms) {
  const double peak = *std::ranges::max_element(logarithms);
  double sum = 0.0;
  for (const double x : logarithms) sum += std::exp(x - peak);
  return peak + std::log(sum);
}

/// Divides the weights by their sum and returns its logarithm (EQUATIONS (4.2)).
template <class Weighted>
double normalise(std::vector<Weighted>& particles) {
  std::vector<double> log_weights;
  for (const Weighted& p : particles) log_weights.push_back(p.log_weight);
  const double log_sum = log_sum_exp(log_weights);
  if (!std::isfinite(log_sum))
    throw std::runtime_error("the log-likelihood of the scan is not finite");
  for (Weighted& p : particles) p.log_weight -= log_sum;
  return log_sum;
}

template <class Weighted>
const Weighted& heaviest(const std::vector<Weighted>& particles) {
  return *std::ranges::max_element(particles, {}, &Weighted::log_weight);
}

/// Mean and covariance of sum_i w_i N(mean(i), covariance(i)), with headings as differences from
/// that of the heaviest one (EQUATIONS 19).
template <class Weighted, class Mean, class Covariance>
PoseMoments mixture_moments(const std::vector<Weighted>& particles, const Mean& mean,
                            const Covariance& covariance) {
  const Pose reference = as_pose(mean(heaviest(particles)));
  Vector<3> shift = Vector<3>::Zero();
  for (const Weighted& p : particles)
    shift += std::exp(p.log_weight) * boxminus(as_pose(mean(p)), reference);
  PoseMoments moments{as_pose(to_vector(reference) + shift)};
  for (const Weighted& p : particles) {
    const Vector<3> e = boxminus(as_pose(mean(p)), moments.mean);
    moments.covariance += std::exp(p.log_weight) * (covariance(p) + e * e.transpose());
  }
  return moments;
}

/// Mean and spread of the poses, with the covariance that particles have until they are drawn.
inline PoseMoments spread_of(const std::vector<Particle>& particles) {
  return mixture_moments(
      particles, [](const Particle& p) { return p.pose; },
      [](const Particle& p) { return p.covariance; });
}

/// The innovation of one detection for the mixture of all particles that use it: the weighted mean
/// of theirs, with their spread added to its covariance. Weights are those before the scan.
class MixtureInnovation {
 public:
  void add(double weight, const Innovation& v) {
    weight_ += weight;
    sum_ += weight * v.nu;
    squares_ += weight * (v.S + v.nu * v.nu.transpose());
  }
  /// Adds the NIS of a detection that particles with at least half of the weight use.
  void add_to(ScanReport& report) const {
    if (weight_ < 0.5) return;
    const Vector<2> mean = sum_ / weight_;
    report.nis += squared_distance(mean, squares_ / weight_ - mean * mean.transpose());
    report.nis_dof += 2;
  }

 private:
  double weight_ = 0.0;
  Vector<2> sum_ = Vector<2>::Zero();
  Matrix<2> squares_ = Matrix<2>::Zero();
};

/// The estimate of one landmark, which is in the same slot of the map of each particle.
inline LandmarkEstimate mixture_of_landmarks(const std::vector<Particle>& particles,
                                             std::size_t slot) {
  LandmarkEstimate mixture{Vector<2>::Zero(), Matrix<2>::Zero()};
  for (const Particle& p : particles) mixture.mean += std::exp(p.log_weight) * p.map[slot].mean;
  for (const Particle& p : particles) {
    const Vector<2> e = p.map[slot].mean - mixture.mean;
    mixture.covariance += std::exp(p.log_weight) * (p.map[slot].covariance + e * e.transpose());
  }
  return mixture;
}

/// Association errors and size of the map, averaged over the weighted particles. To be called
/// before the landmarks of the scan are initialised.
inline AssociationCounts mean_counts(const std::vector<Particle>& particles, Scan scan) {
  AssociationCounts mean;
  for (const Particle& p : particles) {
    add(association_counts(scan, p.pairings, identities_of(p.map)), std::exp(p.log_weight), mean);
  }
  return mean;
}

/// Writes particle i to the requested columns.
inline void write_particle(const ParticleColumns& columns, std::size_t i, const Vector<3>& pose,
                           double log_weight, std::uint32_t ancestor) {
  if (!columns.pose.empty()) std::copy_n(pose.data(), 3, columns.pose.data() + 3 * i);
  if (!columns.log_weight.empty()) columns.log_weight[i] = log_weight;
  if (!columns.ancestor.empty()) columns.ancestor[i] = ancestor;
}

}  // namespace montecarta::filters::plain
