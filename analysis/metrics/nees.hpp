// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>

namespace montecarta::analysis {

/// A covariance counts as singular below this floor (STATISTICS 2), standard deviations [m, m,
/// rad].
inline const Eigen::Vector3d kNeesFloor{1e-4, 1e-4, 1e-5};

/// Normalised estimation error squared of one sample.
struct Nees {
  double value = 0.0;    ///< e' P^-1 e; NaN where error or covariance is not finite
  bool floored = false;  ///< P was singular: the floor was added
};

/// NEES of the components [first, first + Dimension) of a pose error (x [m], y [m], heading [rad])
/// with that block of the covariance, of which the lower triangle is read. Singular means: a
/// variance below 1e-10 of the floor's, or a pivot of the correlation matrix below 1e-12 (a thin
/// but correct covariance after few noisy steps has 1e-6). The floor answers both (STATISTICS 2).
template <int Dimension>
Nees nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, int first = 0);

/// NEES of an imported estimate, of which nothing is repaired: `error` {d} with `covariance` {d,
/// d}. NaN where the covariance is not symmetric (to 1e-6 of the deviations) or not positive
/// definite (a variance not above 0, a pivot of the correlation matrix not above 1e-12).
double strict_nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// What the NEES of `dimension` components is on the average if a filter is perfect but its
/// covariance is the spread, with 1 / particles, of so many independent draws (Hotelling;
/// STATISTICS 4): d (M + 1) / (M - d - 2), infinite where there are too few. Weights and common
/// ancestors make it larger.
double ideal_spread_nees(std::size_t dimension, std::size_t particles);

extern template Nees nees<1>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<2>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<3>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);

}  // namespace montecarta::analysis
