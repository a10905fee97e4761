// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/verdict/verdict.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// Rows of innovations that passed a limit of their NIS.
struct GatedRows {
  double count = 0.0;
  double components = 0.0;  ///< number of components of each row
  double limit = 0.0;       ///< largest NIS

  static constexpr double kLeastLimit = 1e-3, kMostLimit = 1e6, kMostComponents = 1e4;
  /// Whether the factor of such rows can be found: all numbers are within the limits above.
  bool is_usable() const;
};

/// The size of innovations behind a gate (STATISTICS (9.4)). Their NIS is put on the scale of a
/// chi-square variable (9.3), so that its ratio is 1 if the covariance is right; another ratio is
/// nearer to 1 than the factor by which the covariance is too small, which is found here.
class GateScale {
 public:
  /// The factor is found to a thousandth up to this one, which stands for all larger ones.
  static constexpr double kMostFactor = 128.0;

  explicit GateScale(const std::vector<GatedRows>& rows);

  /// The expected ratio on the scale of (9.3) if the covariance is too small by this factor.
  double shown(double factor) const;
  /// The factor by which a covariance is too small if the expectation of this ratio is shown.
  double factor_of(double ratio) const;
  /// factor_of() both ends; the upper one is infinite beyond kMostFactor.
  Interval factor_of(const Interval& ratio) const;
  /// Puts estimates and intervals of ratios in place of those on the scale of (9.3). p-values stay.
  void put_factors(std::vector<FamilyTest>& families) const;

 private:
  std::vector<GatedRows> rows_;
  /// {step} logarithms of the shown ratio, increasing, for factors that grow by equal steps.
  std::vector<double> log_shown_;
};

/// The scale from the setting `gate_limits` of a cell, "2714 rows of 2 up to 9"; nullopt if the
/// text is empty or damaged.
std::optional<GateScale> gate_scale_of(const std::string& limits);

}  // namespace montecarta::analysis
