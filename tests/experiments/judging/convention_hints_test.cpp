// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/convention_hints.hpp"

#include "tests/analysis/verdict_studies.hpp"
#include "tests/experiments/judging/drawn_errors.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iostream>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kRuns = 20, kScans = 10;

/// Errors whose covariance is right by one convention, judged by all.
ConventionHint hint_of(const StateShape& shape, ErrorConvention right, std::uint64_t study) {
  const Eigen::MatrixXd P = some_covariance(shape);
  StateRows rows{shape, {}, {}, {}, {}, {}};
  for (std::size_t s = 0; s < kScans; ++s) rows.time.push_back(static_cast<double>(s));
  rows.covariance.assign(kScans, P);
  ConventionHints hints("mine", shape, rows.time);
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    RngStream draw({study, run, 0, static_cast<std::uint32_t>(right), Draw::test});
    std::vector<Eigen::VectorXd> truths;
    rows.state.clear();
    for (std::size_t s = 0; s < kScans; ++s) {
      truths.push_back(drawn_truth(shape, draw));
      rows.state.push_back(mean_with_error(shape, right, truths.back(), drawn_error(P, draw)));
    }
    hints.add(rows, truths);
  }
  return hints.result(0.95, 1.1);
}

/// Of how many studies the right convention fits, and a wrong one does.
struct Fitting {
  double right = 0.0, wrong = 0.0, named = 0.0;
};

Fitting fitting_in(const StateShape& shape, ErrorConvention right, std::uint64_t studies) {
  Fitting fitting;
  for (std::uint64_t study = 0; study < studies; ++study) {
    const ConventionHint hint = hint_of(shape, right, study);
    const std::string by_right = in_words(hint, right);
    fitting.wrong += by_right.find("Every other would") == std::string::npos ? 1.0 : 0.0;
    const ErrorConvention other =
        right == ErrorConvention::world ? ErrorConvention::body : ErrorConvention::world;
    const std::string by_other = in_words(hint, other);
    const std::string fits = by_other.substr(0, by_other.find(", not as"));
    const bool has_it = fits.find("as " + name_of(right) + " (ANEES") != std::string::npos;
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
  EXPECT_THAT(in_words(hint, ErrorConvention::world),
              testing::AllOf(HasSubstr("mine: the verdict is by the error world."),
                             HasSubstr("not have been rejected as body (ANEES "),
                             HasSubstr("but as right-invariant"), HasSubstr("no verdict")));
  EXPECT_THAT(in_words(hint, ErrorConvention::body), HasSubstr("Every other would"));
  ConventionHint alike{"mine", {hint.by_convention[1], hint.by_convention[1]}};
  alike.by_convention[0].convention = ErrorConvention::world;
  EXPECT_THAT(in_words(alike, ErrorConvention::body), HasSubstr("cannot tell them apart"));
}

TEST(ConventionHints, SayNothingOfAVector) {
  const StateShape shape{StateKind::vector, {"b_m"}, {"b"}, {"m"}};
  const std::vector<double> times = {0.0, 1.0};
  EXPECT_EQ(
      in_words(ConventionHints("mine", shape, times).result(0.95, 1.1), ErrorConvention::world),
      "");
}

}  // namespace
}  // namespace montecarta::experiments
