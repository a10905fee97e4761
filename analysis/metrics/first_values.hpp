// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/score.hpp"
#include "engine/records/result_file.hpp"
#include "engine/threads/parallel.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// A score of each complete run among the first `runs` that a file holds of a cell, in their order;
/// the file may be unfinished. The same for any number of threads.
std::vector<double> first_values(const ResultFile& file, const StoredCell& cell, const Score& score,
                                 std::size_t runs, const Parallel& parallel);

/// Half the width of the interval in which the mean over infinitely many runs lies with probability
/// `level`, by Student's t; infinite of fewer than two values, NaN where one is.
double half_width(const std::vector<double>& values, double level);

/// Whether that is below `wanted`, and the values are such that it can be believed: values with a
/// heavy tail look precise as long as none of the tail was drawn, and stopping then would make the
/// mean too small.
bool is_precise(const std::vector<double>& values, double level, double wanted);

}  // namespace montecarta::analysis
