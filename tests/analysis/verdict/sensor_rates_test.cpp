// SPDX-License-Identifier: BSD-3-Clause
// How often a right filter has any finding in the innovations of its sensors (STATISTICS 9): in at
// most 5 % of studies, whatever the number of sensors is. `MONTECARTA_STUDIES=2000
// build/analysis_tests --gtest_filter='*SlowSensors*'` prints the whole table.
#include "analysis/verdict/innovations.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/analysis/verdict_studies.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// White innovations of some sensors, which `judge --innovations` judges together.
struct SensorLine {
  std::size_t sensors, runs, scans, dimension;
  bool has_components = true;  ///< whether the innovations are known, and not their NIS alone
  double seen = 1.0;           ///< share of scans with an innovation
  bool is_sample = false;      ///< tested without the whole table
};

/// What was found in the innovations of one sensor.
struct SensorFindings {
  bool is_not_white = false, is_off = false;
};

class SensorStudy {
 public:
  SensorStudy(const SensorLine& line, std::uint64_t number)
      : line_(line),
        level_(1.0 - 0.05 / static_cast<double>(2 * line.sensors)),
        innovations_(line.scans, line.has_components ? line.dimension : 0),
        errors_(line.dimension, line.scans) {
    for (std::uint64_t run = 0; run < line.runs; ++run) add_run(number, run);
  }

  SensorFindings findings() const {
    const Innovations found = innovations_.result(scan_times(line_.scans), level_, kUsualMargin);
    const bool is_white = found.whiteness() == Whiteness::white;
    const bool is_off =
        line_.has_components ? is_rejected(verdict(is_white)) : is_rejected(found.verdict);
    return {found.whiteness() == Whiteness::not_white, is_off};
  }

 private:
  /// The verdict on the components, which of a few white runs is by their own law.
  Verdict verdict(bool is_white) const {
    const std::vector<std::string> names = letters(line_.dimension);
    const std::vector<double> times = scan_times(line_.scans);
    auto white = errors_.white_families(level_, {names, times});
    if (is_white && !white.empty()) {
      return judge(std::move(white), level_, kUsualMargin, line_.runs);
    }
    return verdict_of(errors_, line_.dimension, line_.scans, line_.runs, kUsualMargin, level_);
  }
  void add_run(std::uint64_t number, std::uint64_t run) {
    const std::size_t d = line_.dimension;
    WhitenedRun errors = drawn_run({.dimension = d}, number, run, line_.scans);
    std::vector<double> nis = nees_of(errors);
    std::vector<std::uint32_t> dof(line_.scans, static_cast<std::uint32_t>(d));
    RngStream draw({number, run, 0, 1, Draw::test});
    for (std::size_t s = 0; s < line_.scans; ++s) {
      if (draw.uniform() < line_.seen) continue;
      nis[s] = kNaN;
      dof[s] = 0;
      for (std::size_t k = s * d; k < (s + 1) * d; ++k)
        errors.whitened[k] = errors.standardised[k] = kNaN;
    }
    const std::vector<double> times = scan_times(line_.scans);
    if (!line_.has_components) return innovations_.add(run, times, nis, dof);
    innovations_.add(run, times, nis, dof, errors.standardised);
    errors_.add(errors, nis);
  }

  SensorLine line_;
  double level_;
  InnovationSums innovations_;
  WholeError errors_;
};

TEST(SlowSensors, OfARightFilterHaveAFindingInAtMostFivePercent) {
  const std::uint64_t studies = studies_of_a_line(200);
  std::printf("sensors  runs  scans  components  seen  not white [%%]  off [%%]  any [%%]\n");
  std::vector<SensorLine> lines = {{1, 1, 50, 2},
                                   {1, 1, 200, 1},
                                   {1, 2, 200, 1, true, 1.0, true},
                                   {1, 5, 50, 3},
                                   {1, 9, 100, 1},
                                   {1, 10, 100, 1},
                                   {1, 20, 50, 2},
                                   {1, 200, 50, 1},
                                   {3, 1, 200, 1},
                                   {3, 1, 200, 2},
                                   {3, 2, 200, 1},
                                   {3, 5, 50, 2, true, 0.6},
                                   {3, 20, 50, 1},
                                   {3, 20, 50, 2, true, 1.0, true},
                                   {3, 200, 20, 1},
                                   {1, 1, 200, 1, false},
                                   {1, 20, 50, 1, false, 1.0, true},
                                   {3, 1, 200, 1, false},
                                   {3, 5, 100, 2, false},
                                   {3, 20, 50, 1, false},
                                   {3, 20, 50, 2, false, 0.6}};
  lines = tested_lines(std::move(lines), [](const SensorLine& line) { return line.is_sample; });
  for (const SensorLine& line : lines) {
    double not_white = 0.0, off = 0.0, any = 0.0;
    for (std::uint64_t study = 0; study < studies; ++study) {
      bool has_any = false;
      for (std::uint64_t sensor = 0; sensor < line.sensors; ++sensor) {
        const auto found = SensorStudy(line, 1 + study * line.sensors + sensor).findings();
        not_white += found.is_not_white ? 1.0 : 0.0;
        off += found.is_off ? 1.0 : 0.0;
        has_any = has_any || found.is_not_white || found.is_off;
      }
      any += has_any ? 1.0 : 0.0;
    }
    const auto n = static_cast<double>(studies), of_sensors = n * static_cast<double>(line.sensors);
    std::printf("%7zu  %4zu  %5zu  %zu%-9s  %.1f  %.2f  %.2f  %.1f\n", line.sensors, line.runs,
                line.scans, line.dimension, line.has_components ? "" : ", NIS", line.seen,
                100.0 * not_white / of_sensors, 100.0 * off / of_sensors, 100.0 * any / n);
    std::fflush(stdout);
    EXPECT_LT(any / n, 0.05 + share_errors(0.05, studies));
  }
}

}  // namespace
}  // namespace montecarta::analysis
