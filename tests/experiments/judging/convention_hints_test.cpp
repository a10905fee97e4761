// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/convention_hints.hpp"

#include "tests/experiments/judging/drawn_errors.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

constexpr std::uint64_t kStudies = 300, kRuns = 20, kScans = 10;

/// Errors whose covariance is right by one convention, judged by all.
ConventionHint hint_of(const StateShape& shape, ErrorConvention right, std::uint64_t study) {
  const Eigen::MatrixXd P = some_covariance(shape);
  StateRows rows{shape, {}, {}, {}};
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

/// In how many studies what is said of the right convention is that it fits, judged by another.
struct Named {
  std::uint64_t right = 0, wrong = 0;
};

Named named_in_studies(const StateShape& shape, ErrorConvention right) {
  Named named;
  for (std::uint64_t study = 0; study < kStudies; ++study) {
    const ConventionHint hint = hint_of(shape, right, study);
    for (const ErrorConvention said : conventions_of(shape.kind)) {
      if (said == right) continue;
      const std::string words = in_words(hint, said);
      const std::string fits = words.substr(0, words.find(", not as"));
      const bool has_it = fits.find("as " + name_of(right) + " (ANEES") != std::string::npos;
      const bool is_blamed = words.find("cannot tell") == std::string::npos;
      named.right += has_it && is_blamed ? 1 : 0;
      named.wrong += is_blamed ? 0 : 1;
    }
  }
  return named;
}

// Law: the convention by which errors were drawn is named in 95 % of studies, and the wrong one
// that was said is not found to fit.
TEST(ConventionHintsSlow, NameTheRightConvention) {
  for (const StateShape& shape : {plane_shape(), space_shape()}) {
    for (const ErrorConvention right : conventions_of(shape.kind)) {
      const Named named = named_in_studies(shape, right);
      const double share = static_cast<double>(named.right) / (2.0 * kStudies);
      const double slack = 5.0 * std::sqrt(0.05 * 0.95 / kStudies);
      EXPECT_GT(share, 0.95 - slack) << name_of(shape.kind) << " " << name_of(right);
      EXPECT_LE(named.wrong, kStudies / 50) << name_of(shape.kind) << " " << name_of(right);
      RecordProperty("named_" + name_of(shape.kind) + "_" + name_of(right), std::to_string(share));
    }
  }
}

TEST(ConventionHints, SayWhatCannotBeToldApart) {
  const ConventionHint hint = hint_of(plane_shape(), ErrorConvention::body, 1);
  EXPECT_THAT(in_words(hint, ErrorConvention::world),
              testing::AllOf(HasSubstr("mine: the verdict is by the error world."),
                             HasSubstr("consistent as body (ANEES "),
                             HasSubstr("not as right-invariant"), HasSubstr("no verdict")));
  EXPECT_THAT(in_words(hint, ErrorConvention::body), HasSubstr("By no other"));
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
