// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace montecarta::analysis {

/// Share of the error probability `alpha` that interim analyses have spent when `information`, in
/// [0, 1], of the runs are there: 2 - 2 Phi(z / sqrt(information)), which resembles the boundaries
/// of O'Brien and Fleming (Lan and DeMets 1983).
double spent(double alpha, double information);

/// Level of the interim analysis of `runs` runs, where `looks` are the increasing numbers of runs
/// of all interim analyses. Each has the error probability that is spent since the one before, so
/// that together they reject with a probability of at most 1 - level, for any dependence between
/// them. Between two looks it is the level of the next one. Without looks it is `level`.
double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs);

}  // namespace montecarta::analysis
