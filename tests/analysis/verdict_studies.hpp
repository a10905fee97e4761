// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/nees_accumulator.hpp"
#include "engine/random/stream.hpp"
#include "tests/analysis/synthetic_runs.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <vector>

namespace montecarta::analysis {

/// Whether a whole table of rates is asked for, instead of a sample of its lines.
inline bool is_table_wanted() { return std::getenv("MONTECARTA_STUDIES") != nullptr; }

inline constexpr const char* kHowToGetTheTable = "of the whole table: set MONTECARTA_STUDIES=4000";

/// How many studies a line is simulated from: `usual`, or what MONTECARTA_STUDIES says.
inline std::uint64_t studies_of_a_line(std::uint64_t usual) {
  const char* const text = std::getenv("MONTECARTA_STUDIES");
  return text == nullptr ? usual : std::stoull(text);
}

/// Studies of a filter whose errors are Gaussian, of so many components, with `ratio` times the
/// covariance that it reports; scans go together by `memory` (1: the same error at all scans).
struct GaussianLaw {
  std::size_t dimension = 3;
  double memory = 0.0;
  double ratio = 1.0;
};

/// NEES {scan} of one run; the same numbers whatever the ratio.
inline std::vector<double> draw_nees(const GaussianLaw& law, std::uint64_t study, std::uint64_t run,
                                     std::size_t scans) {
  RngStream draw({.seed = study, .run = run, .purpose = Draw::test});
  std::array<double, 6> state{};
  for (std::size_t c = 0; c < law.dimension; ++c) state[c] = draw.normal();
  const double rest = std::sqrt(1.0 - law.memory * law.memory);
  std::vector<double> nees;
  for (std::size_t s = 0; s < scans; ++s) {
    double sum = 0.0;
    for (std::size_t c = 0; c < law.dimension; ++c) {
      if (law.memory < 1.0) state[c] = law.memory * state[c] + rest * draw.normal();
      sum += state[c] * state[c];
    }
    nees.push_back(law.ratio * sum);
  }
  return nees;
}

/// Shares of studies.
struct VerdictRates {
  double above = 0.0;    ///< the test against "right" is left upwards
  double below = 0.0;    ///< or downwards only
  double covered = 0.0;  ///< Consistency::ratio holds the ratio
  double stays = 0.0;    ///< some end of the run is outside the band for all scans
  std::map<Verdict, double> answers;

  double rejected() const { return above + below; }
  double answer(Verdict verdict) const {
    const auto found = answers.find(verdict);
    return found == answers.end() ? 0.0 : found->second;
  }
};

/// Whether the test rejects, whatever the margin.
inline bool is_above(const Consistency& found) {
  return found.above_from || found.mean > found.average_bounds.upper;
}
inline bool is_below(const Consistency& found) {
  return found.below_from || found.mean < found.average_bounds.lower;
}

inline VerdictRates verdict_rates(const GaussianLaw& law, std::uint64_t runs, std::size_t scans,
                                  std::uint64_t studies) {
  const std::vector<double> times = scan_times(scans, 0.2);
  const BandWalks walks(scans);
  const double one = 1.0 / static_cast<double>(studies);
  VerdictRates rates;
  for (std::uint64_t study = 0; study < studies; ++study) {
    NeesAccumulator sums(ErrorBlock::pose, Moments::spread, scans, law.dimension);
    for (std::uint64_t run = 0; run < runs; ++run) sums.add(draw_nees(law, study, run, scans));
    const Consistency found = sums.result(times, 0.95, walks).consistency;
    if (is_above(found)) {
      rates.above += one;
    } else if (is_below(found)) {
      rates.below += one;
    }
    const bool holds = found.ratio.lower <= law.ratio && law.ratio <= found.ratio.upper;
    rates.covered += holds ? one : 0.0;
    rates.stays += found.stays_above_from || found.stays_below_from ? one : 0.0;
    rates.answers[found.verdict] += one;
  }
  return rates;
}

}  // namespace montecarta::analysis
