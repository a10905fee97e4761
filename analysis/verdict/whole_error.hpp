// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/spread.hpp"
#include "analysis/statistics/squares_law.hpp"
#include "analysis/verdict/summed_error.hpp"

#include <cstddef>
#include <span>
#include <string>
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

/// {run}{scan, component}; NaN where there is no error.
using ErrorsOfRuns = std::vector<std::vector<double>>;

/// Errors of some runs, divided by their root mean square over these runs at every scan and in
/// every component.
class DividedErrors {
 public:
  /// `errors` must outlive it.
  DividedErrors(const ErrorsOfRuns& errors, std::size_t scans, std::size_t dimension);
  DividedErrors(ErrorsOfRuns&& errors, std::size_t scans, std::size_t dimension) = delete;

  std::size_t runs() const { return errors_.size(); }
  AspectProducts products(const Aspect& aspect) const;

 private:
  std::size_t dimension_;
  const ErrorsOfRuns& errors_;
  std::vector<double> counts_;  ///< {scan, component} of runs; 0 where they are too few
  std::vector<double> scale_;   ///< {scan, component} one over the root mean square, else NaN
};

/// The spread between runs is judged from so many runs on.
inline constexpr std::size_t kFewestRunsOfSpread = 50;

/// Errors of one run in units of the covariance that its filter reported, {scan, component}.
/// Samples that cannot be judged by component are NaN.
struct WhitenedRun {
  std::size_t dimension = 0;
  std::vector<double> whitened;      ///< L^-1 e, where the covariance is L L'
  std::vector<double> standardised;  ///< each component divided by its own deviation
};

/// Names of the components and times [s] of the scans, for the members of families.
struct ErrorNames {
  std::span<const std::string> components;
  std::span<const double> times;
};

/// Adds up the errors of the complete runs of one cell and tests them (STATISTICS 5). Memory
/// depends on the scans alone: the errors of the first runs are kept, at most 256 of them.
class WholeError {
 public:
  WholeError() = default;  ///< to be read
  WholeError(std::size_t dimension, std::size_t scans);

  /// One run, with its NEES {scan}, which is NaN where it is not judged.
  void add(const WhitenedRun& run, std::span<const double> nees);
  /// The families that apply, judged together at `level`; none of fewer than kFewestJudgedRuns.
  std::vector<FamilyTest> families(double level, const ErrorNames& names) const;
  static constexpr auto parts() {
    using Sums = WholeError;
    return std::tuple(
        settings(&Sums::dimension_, &Sums::scans_, &Sums::stretches_),
        added(&Sums::runs_, &Sums::whole_samples_, &Sums::size_, &Sums::component_, &Sums::stretch_,
              &Sums::nees_, &Sums::bias_, &Sums::correlation_),
        appended_up_to(&Sums::most_kept_runs, &Sums::whitened_, &Sums::standardised_));
  }

 private:
  struct Sum {
    double squares = 0.0, terms = 0.0;
    double terms_of_run = 0.0, squared_terms = 0.0;
    void add(double error);
    void end_run();
    double ratio() const { return squares / terms; }
    /// Number of runs with equal numbers of terms that give a mean of the same variance.
    double runs() const { return terms * terms / squared_terms; }
    static constexpr auto parts() {
      return std::tuple(added(&Sum::squares, &Sum::terms, &Sum::squared_terms));
    }
  };

  std::size_t first_scan(std::size_t stretch) const { return stretch * scans_ / stretches_; }
  std::size_t most_kept_runs() const;
  void add_squares(const WhitenedRun& run);
  void add_means(const WhitenedRun& run);
  bool are_most_samples_whole() const;
  void add_variances(const ErrorNames& names, const DividedErrors& whitened,
                     std::vector<MemberTest>& all) const;
  void add_components(const ErrorNames& names, std::vector<MemberTest>& all) const;
  void add_means(const ErrorNames& names, std::vector<MemberTest>& all) const;

  std::size_t dimension_ = 0, scans_ = 0, stretches_ = 0;
  std::size_t runs_ = 0;        ///< with errors that are judged by their components
  double whole_samples_ = 0.0;  ///< scans of runs with such errors
  Sum size_;
  std::vector<Sum> component_, stretch_;
  SummedError nees_;
  std::vector<SummaryOf> bias_, correlation_;  ///< of the means of runs
  ErrorsOfRuns whitened_, standardised_;       ///< of the first runs
};

}  // namespace montecarta::analysis
