// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace montecarta::analysis {

/// Share of the error probability `alpha` that interim analyses have spent when `information`, in
/// [0, 1], of the runs are there: 2 - 2 Phi(z / sqrt(information)), which resembles the boundaries
/// of O'Brien and Fleming (Lan and DeMets 1983).
double spent(double alpha, double information);

/// Level of the interim analysis of `runs` runs, where `looks` are the numbers of runs at which a
/// study is analysed, increasing: what is spent since the look before is its own error probability,
/// so that all looks together reject with 1 - level at most, whatever they have to do with each
/// other. Between two looks it is that of the next one. `level` itself without looks.
double level_of_look(double level, std::span<const std::uint64_t> looks, std::uint64_t runs);

}  // namespace montecarta::analysis
