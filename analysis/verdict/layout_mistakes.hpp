// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_rows.hpp"
#include "analysis/statistics/sums.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// What a covariance may be by mistake.
enum class LayoutMistake : std::uint8_t {
  rotation_first,  ///< its components begin with the rotation
  degrees,         ///< its angles are in degrees
  radians,         ///< its angles are in rad, and those of estimates and truths in degrees
  millimetres,     ///< its lengths are in millimetres
  deviations       ///< its diagonal has standard deviations
};
inline constexpr std::size_t kLayoutMistakes = 5;

/// "rotation before position", "angles in degrees", ...
std::string name_of(LayoutMistake mistake);

/// A corrected ratio that is nearer to 1 by this factor or more is far nearer.
inline constexpr double kFarNearer = 10.0;

/// How the covariance of errors follows from the one that is stated.
struct LayoutCorrection {
  /// {component} the component whose place it has; empty if such a mistake is not possible.
  std::vector<Eigen::Index> from;
  Eigen::VectorXd scale;    ///< {component} factor of its deviation
  bool is_squared = false;  ///< whether the diagonal has deviations; covariance() does not apply

  Eigen::MatrixXd covariance(const Eigen::MatrixXd& stated) const {
    return scale.asDiagonal() * stated(from, from) * scale.asDiagonal();
  }
  /// The variance of component `i` from the elements of the stated covariance.
  double variance(const double* stated, std::size_t i) const;
};
/// The correction of a mistake for components with these units.
LayoutCorrection correction_of(LayoutMistake mistake, std::span<const std::string> units);

/// Squared errors over their variances, averaged over samples: 1 is right; NaN if a part has none.
struct PartRatios {
  double lengths, angles;  ///< ratios of the components in m, and of those in rad

  /// How far the farther one is from 1: the logarithm of a factor. A part without samples does not
  /// count; NaN if neither has any.
  double distance() const;
  bool has_same_parts(const PartRatios& other) const;
};

/// Squared errors of lengths and of angles beside their variances as stated, and as they would be
/// without each mistake.
class LayoutMistakes {
 public:
  /// Adds a run of errors whose components have these units.
  void add(const ErrorRows& errors, std::span<const std::string> units);
  /// The ratios as stated.
  PartRatios stated() const { return ratios(0); }
  PartRatios without(LayoutMistake mistake) const {
    return ratios(1 + static_cast<std::size_t>(mistake));
  }
  /// The mistake without which ratios are nearest to 1, if the farther one is far nearer and within
  /// kFarNearer, and none is farther than as stated (or than 3).
  std::optional<LayoutMistake> far_nearer() const;
  static constexpr auto parts() { return std::tuple(added(&LayoutMistakes::sums_)); }

 private:
  struct Part {
    double squares = 0.0, n = 0.0;
    static constexpr auto parts() { return std::tuple(added(&Part::squares, &Part::n)); }
  };
  PartRatios ratios(std::size_t k) const;

  /// {as stated, then without each mistake} sums over lengths, then over angles
  std::vector<std::array<Part, 2>> sums_ = std::vector<std::array<Part, 2>>(1 + kLayoutMistakes);
};

/// "If the covariances are written with rotation before position, ...", about the mistake that
/// far_nearer() finds; empty without one.
std::string in_words(const LayoutMistakes& mistakes);

}  // namespace montecarta::analysis
