// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/squares_law.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// A range of scans and of components; ends lie behind the last one.
struct Aspect {
  std::size_t first_scan, end_scan;
  std::size_t first_component, end_component;
};

/// Statistics of an aspect by the products of the errors of different runs (STATISTICS 5).
struct AspectProducts {
  explicit AspectProducts(std::size_t runs) : products(runs), terms_of_run(runs) {}

  /// Adds an aspect that has no error in common with this one.
  void add(const AspectProducts& other);
  /// Mean number of errors of a run.
  double terms() const;
  /// Share of its errors that a run has in common with another one.
  double share() const { return common_terms / terms(); }
  Traces traces() const;
  /// Variance of the scales of single runs: the part of the variance of sums of squares between
  /// runs that the products of different runs do not explain; 0 if there are no such scales. Its
  /// standard error follows from the pseudo-values of the jackknife.
  Summary variance_of_scales() const;

  RunProducts products;
  std::vector<double> terms_of_run;
  double common_terms = 0.0;  ///< errors that two runs have in common, on the average
  /// Sum over scans of the root of the errors at a scan: its square is the second trace of errors
  /// that never change, since errors of different components are independent.
  double constant_root = 0.0;
};

/// Errors of some runs, divided by their root mean square over these runs at every scan and in
/// every component.
class DividedErrors {
 public:
  /// `errors` {run, scan, component}, NaN where there is none.
  DividedErrors(std::vector<double> errors, std::size_t scans, std::size_t dimension);

  std::size_t runs() const { return errors_.size() / counts_.size(); }
  AspectProducts products(const Aspect& aspect) const;

 private:
  std::size_t dimension_;
  std::vector<double> errors_;  ///< {run, scan, component}, 0 where there is none
  std::vector<char> is_there_;  ///< {run, scan, component}
  std::vector<double> counts_;  ///< {scan, component} of runs; 0 where they are too few
};

}  // namespace montecarta::analysis
