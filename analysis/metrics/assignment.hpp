// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace montecarta::analysis {

/// The cheapest way to give every row a column of its own: which one, row by row. `cost` is finite,
/// with no more rows than columns. Shortest augmenting paths (Jonker and Volgenant 1987), at most
/// cubic; quadratic where most rows have a cheapest column to themselves, as a good map has.
std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost);

}  // namespace montecarta::analysis
