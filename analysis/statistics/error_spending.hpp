// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace montecarta::analysis {

/// Part of the error probability `alpha` that interim analyses have spent when a share
/// `information`, in [0, 1], of the runs has ended: 2 - 2 Phi(z / sqrt(information)), which
/// resembles the boundaries of O'Brien and Fleming (Lan and DeMets 1983).
double spent(double alpha, double information);

/// Level of the interim analysis of `runs` runs. `runs_at_analyses` are the increasing numbers of
/// runs at all interim analyses. Each analysis has the error probability that is spent since the
/// one before, so that together they reject with a probability of at most 1 - level, whatever the
/// dependence between them. For a number of runs between two analyses it is the level of the next
/// one. Without interim analyses it is `level`.
double level_of_analysis(double level, std::span<const std::uint64_t> runs_at_analyses,
                         std::uint64_t runs);

}  // namespace montecarta::analysis
