// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/stream.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

namespace montecarta::experiments {
namespace {

using testing::HasSubstr;

/// How many files with how many rows.
struct Size {
  int runs = 60, scans = 32;
};

/// Error and variance of one component at one scan, from a standard normal number.
struct Sample {
  double error, variance;
};

/// Estimates of a heading-free pose whose true value is 0, judged by the program.
class GateOfEstimates : public Program {
 protected:
  Called gate(const std::function<Sample(int run, double normal)>& sample,
              const std::vector<std::string>& more = {}, const Size& size = {}) const {
    RngStream draw({17, 0, 0, 0, Draw::test});
    std::vector<std::string> words = {"judge"};
    for (int run = 0; run < size.runs; ++run) {
      std::ostringstream text;
      text << "time_s,a_m,cov_0_0\n";
      for (int scan = 1; scan <= size.scans; ++scan) {
        const auto [error, variance] = sample(run, draw.normal());
        text << scan << ',' << error << ',' << variance << '\n';
      }
      words.push_back("e_" + std::to_string(1000 + run) + ".csv");
      write(words.back(), text.str());
    }
    std::string truth = "time_s,a_m\n";
    for (int scan = 1; scan <= size.scans; ++scan) truth += std::to_string(scan) + ",0\n";
    write("truth.csv", truth);
    words.insert(words.end(),
                 {"--truth", "truth.csv", "--error", "world", "-o", "mine.h5", "--force"});
    const Called judged = call(words);
    EXPECT_EQ(judged.code, 0) << judged.err;
    EXPECT_EQ(call({"analyze", "mine.h5"}).code, 0);
    words = {"gate", "mine.h5", "--within", "1.5"};
    words.insert(words.end(), more.begin(), more.end());
    return call(words);
  }
};

TEST_F(GateOfEstimates, LetsARightCovariancePass) {
  const Called called = gate([](int, double n) { return Sample{n, 1.0}; });
  EXPECT_EQ(called.code, 0) << called.out << called.err;
}

// An error whose square a double cannot hold is no invalid covariance.
TEST_F(GateOfEstimates, StopsDivergenceBeyondTheRangeOfDoubles) {
  const Called called = gate(
      [](int run, double n) {
        return Sample{run < 58 ? 1e200 : n, 1.0};
      },
      {"--invalid", "9"});
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("optimistic"));
}

TEST_F(GateOfEstimates, StopsNegativeVariances) {
  const auto negative = [](int run, double n) { return Sample{n, run < 56 ? -1.0 : 1.0}; };
  const Called called = gate(negative);
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("1792 of 1920 samples are unusable"));
  EXPECT_NE(gate(negative, {"--invalid", "1792", "--failed", "56"}).code, 4);
}

TEST_F(GateOfEstimates, StopsAVarianceOfZeroWhereTheErrorIsLarge) {
  const Called called = gate([](int, double n) {
    return Sample{n, std::abs(n) > 1.2 ? 0.0 : 0.46};
  });
  EXPECT_EQ(called.code, 4) << called.out << called.err;
  EXPECT_THAT(called.out, HasSubstr("optimistic"));
}

// Few runs, or runs that hardly differ, leave no double for the tails that the verdict asks for.
TEST_F(GateOfEstimates, AnswersWhereRunsAreFewOrAlike) {
  double of_run = 0.0;
  const auto constant_in_a_run = [&, last = -1](int run, double n) mutable {
    if (run != last) of_run = n;
    last = run;
    return Sample{of_run, 1.0};
  };
  const auto identical = [](int, double) { return Sample{1.0, 1.0}; };
  const auto zero = [](int, double) { return Sample{0.0, 1.0}; };
  const auto right = [](int, double n) { return Sample{n, 1.0}; };
  for (const Size& size :
       {Size{1, 1}, Size{2, 1}, Size{3, 1}, Size{3, 8}, Size{4, 2}, Size{20, 1}}) {
    for (const auto& sample : std::vector<std::function<Sample(int, double)>>{
             constant_in_a_run, identical, zero, right}) {
      const Called called = gate(sample, {}, size);
      EXPECT_TRUE(called.code == 0 || called.code == 4 || called.code == 5)
          << size.runs << " runs of " << size.scans << ": " << called.err;
    }
  }
}

}  // namespace
}  // namespace montecarta::experiments
