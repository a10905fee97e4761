// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/text_table.hpp"
#include "analysis/printed/batch_spread.hpp"

#include <string>
#include <vector>

namespace montecarta::analysis {

/// Farther off than this factor, a printed number is not reproduced.
inline constexpr double kReproducedWithin = 2.0;
/// Cells are alike where their difference is less than this share of their mean.
inline constexpr double kAlikeWithin = 0.1;

/// A printed number and ours.
struct ComparedValue {
  double measured = 0.0;  ///< mean over runs, or one number of all runs; infinite: never
  Interval interval;      ///< of the mean, at the study's level; NaN where runs have no value each
  std::string verdict;    ///< "agrees", "differs: ...", "not reproduced: ...", "another world:
                          ///< ...", "not measured"
  BatchSpread batches = {};      ///< of the paper's size, by the band that it printed, if any
  BatchSpread by_expected = {};  ///< likewise by the band of so many runs; of no score
};

/// A claim and our paired difference, left minus right.
struct ComparedClaim {
  double difference = 0.0;
  Interval interval;     ///< of the mean difference over runs that both cells completed
  std::size_t runs = 0;  ///< of them
  std::string verdict;   ///< "holds", "contradicted", "undecided", "not measured"; by batches in
                         ///< how many of them
};

/// A printed number agrees where it lies where the mean of as many runs as the paper's would lie,
/// with probability `level`, given the scatter of ours, or rounds to the printed digits. A single
/// run's number must also lie among our runs, whose scatter may be lopsided. A number that all runs
/// have together agrees where it lies among those of batches of as many runs, by the paper's band;
/// exit times depend on the number of runs. Where the study's baseline does not reproduce in the
/// same metric, no other cell is compared: that is another world.
ComparedValue compare(const StudyAnalysis& study, const PrintedValue& value);
/// A claim holds where the whole interval of the paired difference is on its side; of a number that
/// all runs have together, where all batches are.
ComparedClaim compare(const StudyAnalysis& study, const PrintedClaim& claim);

/// One row a printed number, one row a claim; without rows where there is none.
TextTable printed_value_table(const StudyAnalysis& study);
TextTable printed_claim_table(const StudyAnalysis& study);
/// How to read them.
std::vector<std::string> printed_notes(const StudyAnalysis& study);

}  // namespace montecarta::analysis
