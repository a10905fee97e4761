// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/statistics/sampler_scale.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>

namespace montecarta::analysis {

/// Which mean and covariance of a filter are judged (STATISTICS 1).
enum class Moments {
  corrected,  ///< of a particle filter: spread of the poses that a scan drew, its NEES put on the
              ///< chi-square's scale (SamplerScale); where it drew none, the mixture
  mixture,    ///< spread of the particles plus each particle's own covariance, before sampling
  spread      ///< of the weighted drawn particles; of the Gaussian for a Kalman filter
};

/// In the order in which they lead the verdict, where they are there: a consistent filter's NEES by
/// the one that leads is chi-square, whatever the filter. Errors are those of the mixture's mean
/// where there is one.
inline constexpr std::array kMoments = {Moments::corrected, Moments::mixture, Moments::spread};

/// Which components of the pose error are judged.
enum class ErrorBlock {
  pose,      ///< x, y, heading
  position,  ///< x, y, with the position block of the covariance
  heading
};

inline constexpr std::array kErrorBlocks = {ErrorBlock::pose, ErrorBlock::position,
                                            ErrorBlock::heading};

/// Components of a block.
constexpr std::size_t dimension_of(ErrorBlock block) {
  return block == ErrorBlock::pose ? 3 : block == ErrorBlock::position ? 2 : 1;
}

/// Whether the spread at scan `s` is of poses that this scan drew. Where a filter with a mixture
/// did not draw, both have the same covariance, each particle's own included. `rows` of a particle
/// filter.
bool is_drawn(const RunRows& rows, std::size_t s);

/// How many draws the weighted particles at scan `s` are worth; all of them where no effective
/// sample size is stored.
EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s);

/// A larger NEES counts as this one, so that an error too large for a double is judged like any
/// other that its covariance does not explain, and sums over runs stay finite.
inline constexpr double kLargestNees = 1e60;

/// Normalised estimation error squared of one sample (STATISTICS 2).
struct Nees {
  static constexpr int kUnusable = -1;

  /// e' P^-1 e in the range of P; NaN if the sample is unusable or the rank is 0.
  double value;
  /// Rank of P: the degrees of freedom of the value. kUnusable if error or covariance is not finite
  /// or the covariance is not positive semidefinite.
  int rank;

  bool is_usable() const { return rank != kUnusable; }
};

/// NEES of the components [first, first + Dimension) of a pose error (x [m], y [m], heading [rad])
/// with that block of the covariance, of which the lower triangle is read. A standard deviation
/// below 1e-9 m or 1e-10 rad counts as 0.
template <int Dimension>
Nees nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, int first = 0);

/// NEES of an imported estimate: `error` {d} with `covariance` {d, d}, which is also unusable if it
/// is not symmetric (to 1e-6 of the standard deviations).
Nees imported_nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// Writes the error in units of its covariance (STATISTICS 5): L^-1 e with P = L L', and each
/// component divided by its own deviation, cut to 1e30 deviations. Components whose deviation is at
/// most `least_deviation` are known exactly and NaN; all are NaN if the rest of P is singular, or
/// anything is not finite. Returns the number of components that are not NaN.
std::size_t whiten(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                   const Eigen::VectorXd& least_deviation, std::span<double> whitened_error,
                   std::span<double> standardised);

/// The same of a pose, whose components count as exact as in nees().
std::size_t whiten_pose(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                        std::span<double> whitened_error, std::span<double> standardised);

/// Puts the NEES of a covariance of lower rank on the scale of `dimension` components: it becomes
/// the value that is as probable under the chi-square law of `dimension` degrees of freedom. What a
/// consistent filter exceeds once in a million samples grows in proportion from there on. The value
/// itself if the rank is full, NaN if nothing can be judged.
double on_full_scale(const Nees& sample, std::size_t dimension);

/// What the NEES of `dimension` components is on the average if a filter is perfect but its
/// covariance is the spread, with 1 / particles, of so many independent draws (Hotelling;
/// STATISTICS 4): d (M + 1) / (M - d - 2), infinite where there are too few. Weights and common
/// ancestors make it larger.
double ideal_spread_nees(std::size_t dimension, std::size_t particles);

extern template Nees nees<1>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<2>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<3>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);

}  // namespace montecarta::analysis
