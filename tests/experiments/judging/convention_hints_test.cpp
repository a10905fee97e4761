// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/imported_estimates.hpp"
#include "analysis/metrics/nees.hpp"
#include "tests/analysis/verdict_studies.hpp"
#include "tests/experiments/judging/drawn_errors.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

using analysis::ConventionHint;
using analysis::ConventionHints;
using testing::HasSubstr;

constexpr std::uint64_t kRuns = 20, kScans = 10;

/// Errors whose covariance is right by one convention, judged by all.
ConventionHint hint_of(const StateShape& shape, ErrorConvention right, std::uint64_t study) {
  const Eigen::MatrixXd P = some_covariance(shape);
  ConventionHints hints(shape.dimension(), kScans);
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RngStream draw({study, run, 0, static_cast<std::uint32_t>(right), Draw::test});
    std::array<std::vector<double>, engine::kErrorConventions.size()> nees;
    for (std::size_t s = 0; s < kScans; ++s) {
      const Eigen::VectorXd truth = drawn_truth(shape, draw);
      const Eigen::VectorXd mean = mean_with_error(shape, right, truth, drawn_error(P, draw));
      for (std::size_t k = 0; k < nees.size(); ++k) {
        const ErrorConvention by = conventions_of(shape.kind)[k];
        EXPECT_EQ(name_of(by), engine::kErrorConventions[k].name);
        nees[k].push_back(analysis::imported_nees(error_of(shape, by, mean, truth), P).value);
      }
    }
    hints.add(nees);
  }
  const std::vector<double> times = analysis::five_a_second(kScans);
  return hints.result(times, 0.95, analysis::BandWalks(kScans), 1.1);
}

/// Of how many studies the right convention fits, and a wrong one does.
struct Fitting {
  double right = 0.0, wrong = 0.0, named = 0.0;
};

Fitting fitting_in(const StateShape& shape, ErrorConvention right, std::uint64_t studies) {
  Fitting fitting;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const ConventionHint hint = hint_of(shape, right, study);
    const std::string by_right = in_words(hint, "mine", name_of(right));
    fitting.wrong += by_right.find("Every other would") == std::string::npos ? 1.0 : 0.0;
    const ErrorConvention other =
        right == ErrorConvention::world ? ErrorConvention::body : ErrorConvention::world;
    const std::string by_other = in_words(hint, "mine", name_of(other));
    const std::string fits = by_other.substr(0, by_other.find(", but as"));
    const bool has_it = fits.find("not have been rejected") != std::string::npos &&
                        fits.find(" " + name_of(right) + " (ANEES") != std::string::npos;
    fitting.right += has_it ? 1.0 : 0.0;
    fitting.named += has_it && by_other.find("were they meant so") != std::string::npos ? 1.0 : 0.0;
  }
  return fitting;
}

// Law: the convention by which errors were drawn passes in 95 % of studies, wrong ones do not, and
// who said a wrong one hears of the right one. `MONTECARTA_STUDIES=1000` draws more studies.
TEST(ConventionHintsSlow, NameTheRightConvention) {
  const std::uint64_t studies = analysis::studies_of_a_line(60);
  const auto n = static_cast<double>(studies);
  for (const StateShape& shape : {plane_shape(), space_shape()}) {
    for (const ErrorConvention right : conventions_of(shape.kind)) {
      const Fitting found = fitting_in(shape, right, studies);
      const std::string of = name_of(shape.kind) + ", " + name_of(right);
      EXPECT_GT(found.right / n, 0.95 - 5.0 * std::sqrt(0.05 * 0.95 / n)) << of;
      EXPECT_LE(found.wrong / n, 0.02) << of;
      EXPECT_GE(found.named, found.right - 0.02 * n) << of;
      std::cout << of << ": passes in " << found.right << " of " << n << " studies, named in "
                << found.named << ", another passes in " << found.wrong << "\n";
    }
  }
}

TEST(ConventionHints, SayWhatCannotBeToldApart) {
  const ConventionHint hint = hint_of(plane_shape(), ErrorConvention::body, 1);
  EXPECT_THAT(in_words(hint, "mine", "world"),
              testing::AllOf(HasSubstr("mine: the verdict is by the error world."),
                             HasSubstr("not have been rejected as body (ANEES "),
                             HasSubstr("but as right-invariant"), HasSubstr("no verdict")));
  EXPECT_THAT(in_words(hint, "mine", "body"), HasSubstr("would have been rejected: world (ANEES "));
  const ConventionHint none{{hint.by_convention[0], hint.by_convention[0], hint.by_convention[0]}};
  EXPECT_THAT(in_words(none, "mine", "body"), HasSubstr("rejected as well: world (ANEES "));
  const ConventionHint alike{{hint.by_convention[1], hint.by_convention[1]}};
  EXPECT_THAT(in_words(alike, "mine", "body"), HasSubstr("cannot tell them apart"));
}

TEST(ConventionHints, SayNothingOfAVector) {
  EXPECT_EQ(in_words(ConventionHint{}, "mine", "world"), "");
}

}  // namespace
}  // namespace montecarta::experiments
