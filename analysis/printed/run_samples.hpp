// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/statistics/nees_bounds.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// What is measured of a metric: over runs, or one number of all runs together (n = 1, no spread).
struct Sample {
  double mean = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not measured; infinite: never
  double sd = std::numeric_limits<double>::quiet_NaN();    ///< of one run
  std::size_t n = 0;                                       ///< runs
  std::vector<double> values{};                            ///< of each run, where runs have one
};

/// A metric of a cell; nothing where `cell` is nullptr.
Sample sample_of(const CellAnalysis* cell, const std::string& metric);
/// How many times that of `unit` it is: the ratio of means, its spread from the paired runs.
Sample ratio_of(const CellAnalysis* cell, const CellAnalysis* unit, const std::string& metric);
/// Left minus right over the runs that both completed.
Sample difference_of(const CellAnalysis* left, const CellAnalysis* right,
                     const std::string& metric);

/// By which band batches are judged.
enum class BatchBand : std::uint8_t { printed, expected };

/// A metric of each batch of `runs` complete runs, in their order: the mean of a score over the
/// batch, whatever the band, or a number that all runs of a batch have together. Empty where there
/// is none.
std::vector<double> batches_of(const CellAnalysis* cell, const std::string& metric,
                               std::uint64_t runs, BatchBand band);

/// Of the mean; NaN of fewer than two runs.
Interval interval_of(const Sample& sample, double level);

/// What can be compared: names of scores, and of numbers that all runs of a cell have together.
std::vector<std::string> printed_metrics();
/// Whether every run has one of its own, so that cells can be compared run by run.
bool is_run_metric(const std::string& metric);
/// A metric as tables call it, with its unit.
std::string metric_in_words(const std::string& metric);

}  // namespace montecarta::analysis
