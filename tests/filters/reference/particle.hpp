// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/pose.hpp"
#include "engine/core/slam_filter.hpp"
#include "engine/numbers/angle.hpp"
#include "filters/association/pairing.hpp"
#include "filters/factory.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "tests/filters/reference/fast_slams.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

/// What every reference is made of. References are to be read beside the papers, so they divide by
/// two-by-two matrices as those write it, K = P H' S^-1; nowhere else does anything invert.
namespace montecarta::filters::reference {

/// log N(v; S), the density (0.1) of EQUATIONS, by the Cholesky factor of S, which takes its place
/// column by column. Eigen's own takes the compiler seconds a size.
template <int N>
double log_gaussian(const Eigen::Matrix<double, N, 1>& v, Eigen::Matrix<double, N, N> S) {
  Eigen::Matrix<double, N, 1> white = v;
  double log_det = 0.0, squared = 0.0;
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    const double pivot = std::sqrt(S(j, j));
    white(j) /= pivot;
    squared += white(j) * white(j);
    log_det += 2.0 * std::log(pivot);
    for (Eigen::Index i = j + 1; i < v.size(); ++i) {
      S(i, j) /= pivot;
      white(i) -= S(i, j) * white(j);
      for (Eigen::Index k = j + 1; k <= i; ++k) S(i, k) -= S(i, j) * S(k, j);
    }
  }
  return -0.5 * (squared + log_det + static_cast<double>(v.size()) * std::log(kTwoPi));
}

/// Lower Cholesky factor that allows zero pivots: a pivot <= 1e-18 (1 + |P_jj|) gives a zero column
/// (EQUATIONS, Notation).
template <int N>
Eigen::Matrix<double, N, N> psd_chol(const Eigen::Matrix<double, N, N>& P) {
  Eigen::Matrix<double, N, N> L = Eigen::Matrix<double, N, N>::Zero();
  for (int j = 0; j < N; ++j) {
    const double pivot = P(j, j) - L.row(j).squaredNorm();
    if (pivot <= 1e-18 * (1.0 + std::abs(P(j, j)))) continue;
    L(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < N; ++i) L(i, j) = (P(i, j) - L.row(i).dot(L.row(j))) / L(j, j);
  }
  return L;
}

/// The square root of P that is lower triangular in the coordinates y = T x, T orthogonal.
template <int N>
Eigen::Matrix<double, N, N> chol_in(const Eigen::Matrix<double, N, N>& T,
                                    const Eigen::Matrix<double, N, N>& P) {
  return T.transpose() * psd_chol<N>(T * P * T.transpose());
}

struct Landmark {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
  Eigen::Matrix2d factor = Eigen::Matrix2d::Zero();  ///< where the filter keeps square roots
};

/// One particle of the FastSLAM family (EQUATIONS 4), with its own map and its own opinion on the
/// scan.
struct Particle {
  Eigen::Vector3d pose = Eigen::Vector3d::Zero();        ///< x_i; drawn after a scan
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< P_i, accumulated since the last draw
  Eigen::Matrix3d factor = Eigen::Matrix3d::Zero();      ///< where the filter keeps square roots
  Eigen::Vector3d refined_pose =
      Eigen::Vector3d::Zero();  ///< proposal of the last scan, before drawing
  Eigen::Matrix3d refined_covariance = Eigen::Matrix3d::Zero();
  double log_weight = 0.0;
  std::uint32_t ancestor = 0;                ///< index one scan ago
  std::vector<std::optional<Landmark>> map;  ///< by identity where known, else by initialisation
  std::vector<Pairing> pairings;             ///< one per detection
};

inline Pose as_pose(const Eigen::Vector3d& x) { return {x(0), x(1), x(2)}; }
inline Eigen::Vector3d to_vector(const Pose& pose) { return {pose.x, pose.y, pose.heading}; }

/// A landmark seen from a pose: everything EQUATIONS 6 derives from h.
struct Seen {
  Matrix23 Hx;
  Eigen::Matrix2d Hf;
  Eigen::Matrix2d S_f;  ///< Hf Sigma Hf' + R
  Eigen::Vector2d nu;   ///< innovation, bearing wrapped
};

/// Nothing where the landmark is too near (EQUATIONS 2).
inline std::optional<Seen> seen_from(const Eigen::Vector3d& pose, const Landmark& landmark,
                                     const Detection& detection, const Eigen::Matrix2d& R) {
  const auto at = linearised_observation(as_pose(pose), Point{landmark.mean(0), landmark.mean(1)});
  if (too_near(at.observation)) return std::nullopt;
  const Eigen::Matrix2d Hf = landmark_jacobian(at);
  return Seen{pose_jacobian(at), Hf, Hf * landmark.covariance * Hf.transpose() + R,
              to_vector(residual(observation_of(detection), at.observation))};
}

/// Feature EKF at an exactly known pose, Joseph form (EQUATIONS 4).
inline void update_landmark(Landmark& landmark, const Seen& seen, const Eigen::Matrix2d& R) {
  const Eigen::Matrix2d K = landmark.covariance * seen.Hf.transpose() * seen.S_f.inverse();
  const Eigen::Matrix2d I_KH = Eigen::Matrix2d::Identity() - K * seen.Hf;
  landmark.mean += K * seen.nu;
  landmark.covariance =
      (I_KH * landmark.covariance * I_KH.transpose() + K * R * K.transpose()).eval();
}

/// mu = g(x, z), Sigma = Gz R Gz' (EQUATIONS 4).
inline Landmark new_landmark(const Eigen::Vector3d& pose, const Detection& detection,
                             const Eigen::Matrix2d& R) {
  const auto placed = linearised_place(as_pose(pose), observation_of(detection));
  const Eigen::Matrix2d Gz = observation_jacobian(placed);
  return {.mean = to_vector(placed.point), .covariance = Gz * R * Gz.transpose()};
}

/// Moments of sum_i w_i N(mean(i), covariance(i)), headings as differences from the heaviest
/// particle (EQUATIONS 19). `Weighed`: whatever has a log_weight.
template <class Weighed, class Mean, class Covariance>
PoseMoments mixture_moments(const std::vector<Weighed>& particles, const Mean& mean,
                            const Covariance& covariance) {
  const auto heaviest = std::max_element(
      particles.begin(), particles.end(),
      [](const Weighed& a, const Weighed& b) { return a.log_weight < b.log_weight; });
  const Pose reference = as_pose(mean(*heaviest));
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  for (const Weighed& p : particles) {
    shift += std::exp(p.log_weight) * boxminus(as_pose(mean(p)), reference);
  }
  PoseMoments moments;
  moments.mean = {reference.x + shift(0), reference.y + shift(1),
                  wrap(reference.heading + shift(2))};
  for (const Weighed& p : particles) {
    const Eigen::Vector3d e = boxminus(as_pose(mean(p)), moments.mean);
    moments.covariance += std::exp(p.log_weight) * (covariance(p) + e * e.transpose());
  }
  return moments;
}

/// Parents of the next generation: particle m descends from the first whose cumulated weight
/// exceeds u_m = (m + U) / M, one U for all (systematic) or one each (stratified) (EQUATIONS 18).
inline std::vector<std::uint32_t> draw_parents(Scheme scheme, const std::vector<double>& weights,
                                               const StepContext& context) {
  std::vector<std::uint32_t> parents(weights.size());
  std::size_t parent = 0;
  double cumulated = weights[0];
  for (std::uint32_t m = 0; m < parents.size(); ++m) {
    const std::uint32_t index = scheme == Scheme::systematic ? 0 : m;
    const double U = context.stream(Draw::resampling, index).uniform();
    const double u = (m + U) / static_cast<double>(weights.size());
    while (cumulated <= u && parent + 1 < weights.size()) cumulated += weights[++parent];
    parents[m] = static_cast<std::uint32_t>(parent);
  }
  return parents;
}

/// A map: by identity where association is known, else by initialisation.
using Landmarks = std::vector<std::optional<Landmark>>;

/// What each detection is, where the simulator tells; a fresh one with the place it will have.
inline std::vector<Pairing> pair_by_identity(Scan scan, const Landmarks& map) {
  std::vector<Pairing> pairings;
  for (const Detection& detection : scan) {
    const auto place = static_cast<std::uint32_t>(detection.identity);
    if (detection.identity == Detection::kClutter) {
      pairings.push_back({});
    } else {
      pairings.push_back({map[place] ? PairingKind::matched : PairingKind::fresh, place, 0.0});
    }
  }
  return pairings;
}

/// Individual-compatibility nearest neighbour (EQUATIONS 17), literally: a map as it looks from a
/// pose of covariance P.
struct NearestNeighbour {
  AssociationSettings settings;
  Eigen::Matrix2d R;
  Eigen::Vector3d pose;
  Eigen::Matrix3d P;  ///< zero where the pose is drawn already

  /// What each detection is.
  std::vector<Pairing> pair(Scan scan, const Landmarks& map) const {
    std::vector<Pairing> pairings;
    for (const Detection& detection : scan) pairings.push_back(nearest(detection, map));
    for (std::uint32_t j = 0; j < map.size(); ++j) keep_one(j, pairings);
    return pairings;
  }

 private:
  Pairing nearest(const Detection& detection, const Landmarks& map) const {
    double least_D2 = std::numeric_limits<double>::infinity();
    Pairing best{.cost = std::numeric_limits<double>::infinity()};
    for (std::uint32_t j = 0; j < map.size(); ++j) {
      const auto seen = seen_from(pose, *map[j], detection, R);
      if (!seen) continue;
      const Eigen::Matrix2d S_z = seen->Hx * P * seen->Hx.transpose() + seen->S_f;
      const double D2 = seen->nu.dot(S_z.inverse() * seen->nu);
      const double ND = D2 + std::log(S_z.determinant());
      least_D2 = std::min(least_D2, D2);
      if (D2 < settings.gate && ND < best.cost) best = {PairingKind::matched, j, ND};
    }
    if (best.kind == PairingKind::matched) return best;
    return {.kind = least_D2 > settings.new_gate ? PairingKind::fresh : PairingKind::ignored};
  }

  /// Of all detections that picked landmark j the one with the least ND keeps it.
  static void keep_one(std::uint32_t j, std::vector<Pairing>& pairings) {
    const auto picked_it = [j](const Pairing& one) {
      return one.kind == PairingKind::matched && one.landmark == j;
    };
    Pairing* winner = nullptr;
    for (Pairing& one : pairings) {
      if (picked_it(one) && (winner == nullptr || one.cost < winner->cost)) winner = &one;
    }
    for (Pairing& one : pairings) {
      if (picked_it(one) && &one != winner) one.kind = PairingKind::ignored;
    }
  }
};

/// log p0 (EQUATIONS 17): log N at D^2 = the gate with S = diag(2 sigma_r^2, 2 sigma_b^2).
inline double log_unmatched(const AssociationSettings& settings, const Belief& belief) {
  const double det_S_ref =
      2.0 * std::pow(belief.sigma_range, 2) * 2.0 * std::pow(belief.sigma_bearing, 2);
  return -0.5 * settings.gate - std::log(kTwoPi) - 0.5 * std::log(det_S_ref) +
         settings.log_new_density_offset;
}

}  // namespace montecarta::filters::reference
