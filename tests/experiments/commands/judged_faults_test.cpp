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

constexpr int kRuns = 60, kScans = 32;

/// Error and variance of one component at one scan, from a standard normal number.
struct Sample {
  double error, variance;
};

/// Estimates of a heading-free pose whose true value is 0, judged by the program.
class GateOfEstimates : public Program {
 protected:
  Called gate(const std::function<Sample(int run, double normal)>& sample,
              const std::vector<std::string>& more = {}) const {
    RngStream draw({17, 0, 0, 0, Draw::test});
    std::vector<std::string> words = {"judge"};
    for (int run = 0; run < kRuns; ++run) {
      std::ostringstream text;
      text << "time_s,a_m,cov_0_0\n";
      for (int scan = 1; scan <= kScans; ++scan) {
        const auto [error, variance] = sample(run, draw.normal());
        text << scan << ',' << error << ',' << variance << '\n';
      }
      words.push_back("e_" + std::to_string(1000 + run) + ".csv");
      write(words.back(), text.str());
    }
    std::string truth = "time_s,a_m\n";
    for (int scan = 1; scan <= kScans; ++scan) truth += std::to_string(scan) + ",0\n";
    write("truth.csv", truth);
    words.insert(words.end(),
                 {"--truth", "truth.csv", "--error", "world", "-o", "mine.h5", "--force"});
    const Called judged = call(words);
    EXPECT_EQ(judged.code, 0) << judged.err;
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

}  // namespace
}  // namespace montecarta::experiments
