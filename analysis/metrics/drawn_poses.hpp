// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/statistics/sampler_scale.hpp"

#include <cstddef>

namespace montecarta::analysis {

/// Whether the spread at scan `s` is of poses that this scan drew. Where a filter with a mixture
/// did not draw, both have the same covariance, each particle's own included. `rows` of a particle
/// filter.
bool is_drawn(const RunRows& rows, std::size_t s);

/// How many draws the weighted particles at scan `s` are worth; all of them where no effective
/// sample size is stored.
EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s);

}  // namespace montecarta::analysis
