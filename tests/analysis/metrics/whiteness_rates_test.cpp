// SPDX-License-Identifier: BSD-3-Clause
// How often the innovations of an exact Kalman filter are called not white (STATISTICS 9): at most
// 5 %, for few long runs and for many short ones. `MONTECARTA_STUDIES=2000 build/analysis_tests
// --gtest_filter='*SlowWhiteness*'` prints the whole table.
#include "analysis/metrics/innovations.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace montecarta::analysis {
namespace {

struct WhiteStudy {
  std::size_t scans, runs;
  std::uint32_t dof;
};

bool is_called_white(const WhiteStudy& study, std::uint64_t seed) {
  InnovationSums sums(study.scans);
  const std::vector<std::uint32_t> dof(study.scans, study.dof);
  for (std::uint64_t run = 0; run < study.runs; ++run) {
    RngStream draw({seed, run, 0, 0, Draw::test});
    std::vector<double> nis(study.scans);
    for (double& sum : nis) {
      for (std::uint32_t k = 0; k < study.dof; ++k) sum += std::pow(draw.normal(), 2);
    }
    sums.add(nis, dof);
  }
  return sums.result(0.95).is_white();
}

// The squares of one degree of freedom have heavy tails; of a single run 7 % are called not white.
TEST(SlowWhiteness, OfARightFilterIsRejectedAtItsLevel) {
  const std::uint64_t studies = studies_of_a_line(100);
  std::printf("scans  runs  components  not white [%%]\n");
  for (const WhiteStudy& study :
       {WhiteStudy{20, 1, 2}, WhiteStudy{20, 20, 1}, WhiteStudy{20, 20, 2}, WhiteStudy{20, 200, 1},
        WhiteStudy{20, 200, 2}, WhiteStudy{100, 1, 2}, WhiteStudy{100, 20, 1},
        WhiteStudy{100, 20, 2}, WhiteStudy{100, 200, 1}, WhiteStudy{100, 200, 2},
        WhiteStudy{100, 200, 10}, WhiteStudy{1000, 1, 2}, WhiteStudy{1000, 20, 1},
        WhiteStudy{1000, 20, 2}, WhiteStudy{1000, 200, 2}}) {
    if (!is_table_wanted() && study.scans * study.runs > 20'000) continue;
    double rejected = 0.0;
    for (std::uint64_t k = 0; k < studies; ++k) rejected += is_called_white(study, 1 + k) ? 0 : 1;
    const double rate = rejected / static_cast<double>(studies);
    const double error = std::sqrt(0.05 * 0.95 / static_cast<double>(studies));
    std::printf("%5zu  %4zu  %10u  %.1f +- %.1f\n", study.scans, study.runs, study.dof,
                100.0 * rate, 100.0 * error);
    EXPECT_LT(rate, 0.06 + 3.0 * error);
  }
}

}  // namespace
}  // namespace montecarta::analysis
