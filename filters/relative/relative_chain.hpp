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

/// The layout of the state of a joint Gaussian in relative coordinates (EQUATIONS 22). Frame 0 is
/// the start. Displacement k leads from frame k to frame k + 1, and the last one from the newest
/// frame to the vehicle.
struct RelativeChain {
  /// A landmark in a frame.
  struct Point {
    Eigen::Index row;   ///< first of its two rows
    std::size_t frame;  ///< frame of its coordinates
    bool is_polar;      ///< range and bearing [m, rad]; else x and y [m]
  };
  struct ChainLandmark {
    Point first;                 ///< coordinates of the landmark at its initialisation
    std::optional<Point> again;  ///< coordinates at a second initialisation, until both are joined
  };

  Pose start;                               ///< known pose in the map frame
  std::vector<Eigen::Index> displacements;  ///< {frame} first of the rows x, y, heading [m, m, rad]
  std::vector<ChainLandmark> landmarks;     ///< landmarks in the order of initialisation

  std::size_t newest_frame() const { return displacements.size() - 1; }
};

/// The composition of two displacements, with derivatives.
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
/// (22.6)). They are exact up to the wrapping of the heading: a position is a sum of displacements,
/// each rotated by a sum of headings, and all of these are jointly Gaussian. Covariances of
/// headings must be below 700 rad^2.
class ChainMoments {
 public:
  /// Moments of the pose of the vehicle and then of `points`, for the Gaussian (`mean`, `P`).
  JointEstimate of(const RelativeChain& chain, const Eigen::VectorXd& mean,
                   const Eigen::MatrixXd& P, std::span<const RelativeChain::Point> points);

 private:
  using Complex = std::complex<double>;

  /// One rotated displacement T = exp(i psi) a, where psi and a are Gaussian. The first terms are
  /// the displacements from frame to frame, followed by that to the vehicle and by the points in
  /// their frames.
  struct Term {
    Eigen::Index row;          ///< first row of a
    bool is_polar;             ///< a is real, and the next row adds to psi
    Eigen::Index before = -1;  ///< the term at the end of which this one begins; -1: the start
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
  Eigen::Index vehicle_ = 0;    ///< index of its term
  double heading_ = 0.0;        ///< mean heading of the vehicle [rad]
  Eigen::MatrixXd by_heading_;  ///< {row, term} Cov(component, psi); last: heading
  Eigen::MatrixXd headings_;    ///< {term, term} Cov(psi, psi), with the same last row and column
  Eigen::VectorXd places_;      ///< {2 term} means of positions, then the heading
  Eigen::MatrixXd covariance_;  ///< covariance of the terms with positions and heading
};

}  // namespace montecarta::filters
