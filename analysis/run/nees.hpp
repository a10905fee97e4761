// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/sampler_scale.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <string>

namespace montecarta::analysis {

/// The mean and covariance of a filter that are judged (STATISTICS 1).
enum class Moments {
  /// Spread of the poses that a scan of a particle filter drew, with the NEES on the chi-square's
  /// scale (SamplerScale); the mixture at scans that drew none.
  corrected,
  mixture,  ///< spread of the particles plus each particle's own covariance, before sampling
  spread    ///< spread of the weighted drawn particles; the Gaussian of a Kalman filter
};

/// All moments in the order of precedence: the first that is stored leads the verdict. The NEES of
/// a consistent filter by the leading moments is chi-square for every filter. Errors are those of
/// the mixture's mean if a mixture is stored.
inline constexpr std::array kMoments = {Moments::corrected, Moments::mixture, Moments::spread};

/// The components of the pose error that are judged.
enum class ErrorBlock {
  pose,      ///< x, y, heading
  position,  ///< x, y, with the position block of the covariance
  heading
};

inline constexpr std::array kErrorBlocks = {ErrorBlock::pose, ErrorBlock::position,
                                            ErrorBlock::heading};

std::string name_of(ErrorBlock block);
std::string name_of(Moments moments);

/// Number of components of a block.
constexpr std::size_t dimension_of(ErrorBlock block) {
  return block == ErrorBlock::pose ? 3 : block == ErrorBlock::position ? 2 : 1;
}

/// Returns whether a particle filter drew poses before row `row` of its moments, which the spread
/// then describes. If a filter with a mixture did not draw, spread and mixture have the same
/// covariance.
bool is_drawn(const MomentRows& spread, const MomentRows& mixture, std::size_t row);
/// The same at scan `s`.
inline bool is_drawn(const RunRows& rows, std::size_t s) {
  return is_drawn(rows.spread, rows.mixture, s);
}

/// Number of draws that the weighted particles at scan `s` are worth; all of them if no effective
/// sample size is stored.
EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s);

/// The largest NEES: a larger one is replaced by it, so that an error too large for a double is
/// judged like any other large error, and sums over runs stay finite.
inline constexpr double kLargestNees = 1e60;

/// Normalised estimation error squared of one sample (STATISTICS 2).
struct Nees {
  static constexpr int kUnusable = -1, kMissing = -2;

  /// e' P^-1 e in the range of P, without components that are known exactly; NaN if the sample is
  /// unusable or the rank is 0.
  double value;
  /// Rank of P: the degrees of freedom of the value. kUnusable if error or covariance is not finite
  /// or the covariance is not positive semidefinite; kMissing if there is no estimate.
  int rank;

  bool is_usable() const { return rank >= 0; }
};

/// NEES of the components [first, first + Dimension) of a pose error (x [m], y [m], heading [rad])
/// with that block of the covariance, of which the lower triangle is read. A standard deviation
/// below 1e-9 m or 1e-10 rad counts as 0.
template <int Dimension>
Nees nees(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, int first = 0);

/// {kErrorBlocks} NEES of a pose error, from one factorisation.
std::array<Nees, kErrorBlocks.size()> pose_nees(const Eigen::Vector3d& error,
                                                const Eigen::Matrix3d& covariance);

/// NEES of an imported estimate with `error` {d} and `covariance` {d, d}. The sample is also
/// unusable if the covariance is not symmetric (to 1e-6 of the standard deviations).
Nees imported_nees(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// Writes the error in units of its covariance (STATISTICS 5): L^-1 e with P = L L', and each
/// component divided by its own deviation, cut to 1e30 deviations. Components with a deviation of
/// at most `least_deviation` are known exactly and become NaN. If the rest of P is singular, all of
/// L^-1 e becomes NaN. Returns the number of components of L^-1 e that are not NaN.
std::size_t whiten(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                   const Eigen::VectorXd& least_deviation, std::span<double> whitened_error,
                   std::span<double> standardised);

/// Raises `largest` {component} to the errors of components with a deviation of at most
/// `least_deviation`, except errors of at most `rounding`, which rounding explains.
void add_errors_of_exact(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance,
                         const Eigen::VectorXd& least_deviation, std::span<double> largest,
                         double rounding = kDoubleRounding);

/// Poses with deviations up to these [m, m, rad] are known exactly.
const Eigen::Vector3d& least_pose_deviation();

/// A pose error in units of its covariance P, as whiten() computes it.
struct WhitenedPose {
  Eigen::Vector3d whitened, standardised;
  std::size_t rank = 0;       ///< number of components of `whitened` that are not NaN
  double determinant = kNaN;  ///< determinant of P; NaN if P is singular
};

/// Fills `pose`. The same components count as exact as in nees().
void whiten_pose(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                 WhitenedPose& pose);

/// -log N(error; 0, P); NaN if P is singular or unusable.
double negative_log_density(const WhitenedPose& pose);

/// Converts the NEES of a covariance of lower rank to the scale of `dimension` components: the
/// value of equal probability under the chi-square law of `dimension` degrees of freedom. Beyond
/// the value that a consistent filter exceeds once in a million samples, the scale is linear. A
/// NEES of full rank is returned unchanged; NaN if the sample cannot be judged.
double on_full_scale(const Nees& sample, std::size_t dimension);

/// Expected NEES of `dimension` components for a perfect filter whose covariance is the spread,
/// with 1 / particles, of this number of independent draws (Hotelling; STATISTICS 4): d (M + 1) /
/// (M - d - 2), infinite for too few draws. Weights and common ancestors make it larger.
double ideal_spread_nees(std::size_t dimension, std::size_t particles);

extern template Nees nees<1>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<2>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);
extern template Nees nees<3>(const Eigen::Vector3d&, const Eigen::Matrix3d&, int);

}  // namespace montecarta::analysis
