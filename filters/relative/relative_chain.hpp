// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/models/ackermann.hpp"

#include <Eigen/Core>

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The layout of the state of a joint Gaussian that knows places relative to each other only
/// (EQUATIONS 22). Frame 0 is the start; displacement k leads from frame k to frame k + 1, the last
/// one from the newest frame to the vehicle.
struct RelativeChain {
  /// A landmark in a frame.
  struct Point {
    Eigen::Index row;   ///< of its two coordinates
    std::size_t frame;  ///< that they are in
    bool is_polar;      ///< range and bearing [m, rad]; else x and y [m]
  };
  struct Landmark {
    Point first;                 ///< where it was initialised
    std::optional<Point> again;  ///< initialised a second time, not joined with the first yet
  };

  Pose start;                               ///< in the map frame, known
  std::vector<Eigen::Index> displacements;  ///< {frame} first of the rows x, y, heading [m, m, rad]
  std::vector<Landmark> landmarks;          ///< in the order of initialisation

  std::size_t newest_frame() const { return displacements.size() - 1; }
};

/// A displacement followed by another, with derivatives.
struct LinearisedComposition {
  Pose pose;
  Eigen::Matrix3d by_first, by_second;
};
LinearisedComposition linearised_composition(const Pose& first, const Pose& second);

/// A point in its frame [m], with its derivative by its two coordinates.
struct LinearisedPoint {
  Point place;
  Eigen::Matrix2d by_coordinates;
};
LinearisedPoint linearised_point(const RelativeChain::Point& point, const Eigen::VectorXd& mean);

/// Displacement k of the chain.
Pose displacement(const RelativeChain& chain, std::size_t k, const Eigen::VectorXd& mean);

/// Mean and covariance in the map frame of a Gaussian over a relative chain (EQUATIONS (22.5),
/// (22.6)). Exact, the heading unwrapped: a place is a sum of displacements, each turned by a sum
/// of headings, and all of these are Gaussian together. Covariances of headings are below 700
/// rad^2.
class ChainMoments {
 public:
  /// Of the vehicle's pose and then of `points`, of the Gaussian (`mean`, `P`).
  JointEstimate of(const RelativeChain& chain, const Eigen::VectorXd& mean,
                   const Eigen::MatrixXd& P, std::span<const RelativeChain::Point> points);

 private:
  using Complex = std::complex<double>;

  /// One turned displacement T = exp(i psi) a of a place, psi and a Gaussian. Terms 0, 1, ... are
  /// the displacements from frame to frame, that to the vehicle last, then the points in their
  /// frames.
  struct Term {
    Eigen::Index row;          ///< of a
    bool is_polar;             ///< a is real, and the next row adds to psi
    Eigen::Index before = -1;  ///< the term whose place this one begins at; -1: the start
    Complex turn = {};         ///< E exp(i psi)
    Complex way = {};          ///< E T / turn = E a + i Cov(a, psi)
  };

  Eigen::Index size() const { return static_cast<Eigen::Index>(terms_.size()); }
  Term& term(Eigen::Index i) { return terms_[static_cast<std::size_t>(i)]; }
  const Term& term(Eigen::Index i) const { return terms_[static_cast<std::size_t>(i)]; }
  Complex with_heading(Eigen::Index i, Eigen::Index j) const;
  void gather_headings(double start, const Eigen::VectorXd& mean, const Eigen::MatrixXd& P);
  Eigen::Matrix2d covariance(Eigen::Index i, Eigen::Index j, const Eigen::MatrixXd& P) const;
  void gather_covariances(const Eigen::MatrixXd& P);
  void gather_places(const Pose& start);
  JointEstimate estimate() const;

  std::vector<Term> terms_;
  Eigen::Index vehicle_ = 0;    ///< its term
  double heading_ = 0.0;        ///< mean of the vehicle's [rad]
  Eigen::MatrixXd by_heading_;  ///< {row, term} Cov(component, psi); behind the terms: heading
  Eigen::MatrixXd headings_;    ///< {term, term} Cov(psi, psi), likewise
  Eigen::VectorXd places_;      ///< {2 term} means, then the heading
  Eigen::MatrixXd covariance_;  ///< of the terms with the places, likewise
};

}  // namespace montecarta::filters
