// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "filters/relative/relative_chain.hpp"

#include <Eigen/Core>

#include <complex>
#include <span>
#include <vector>

namespace montecarta::filters {

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
