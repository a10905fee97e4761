// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"

#include <cstdint>
#include <span>

namespace montecarta::engine {

/// The method by which parents are drawn (EQUATIONS 18). All methods are unbiased: particle j has N
/// w_j children on average.
enum class Resampling { systematic, stratified, residual, multinomial };

/// Draws the parent of every new particle: parents[i] in [0, weights.size()), non-decreasing except
/// for residual resampling. `weights` must sum to one, and there are as many parents as weights.
void draw_parents(Resampling scheme, std::span<const double> weights, const StepContext& context,
                  std::span<std::uint32_t> parents);

}  // namespace montecarta::engine
