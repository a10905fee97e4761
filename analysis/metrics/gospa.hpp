// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// The cheapest way to give every row a column of its own: which one, row by row. `cost` is finite,
/// with no more rows than columns. Shortest augmenting paths (Jonker and Volgenant 1987), at most
/// cubic; quadratic where most rows have a cheapest column to themselves, as a good map has.
std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost);

/// A landmark farther than this [m] from where it is believed to be counts as missed and spurious.
inline constexpr double kGospaCutoff = 5.0;

/// How far a map is from the truth, whoever is who (Rahmathullah, Garcia-Fernandez, Svensson 2017;
/// alpha = 2, p = 2): distance^2 = localisation^2 + cutoff^2 / 2 (missed + spurious).
struct Gospa {
  double distance = 0.0;      ///< [m]
  double localisation = 0.0;  ///< [m] root of the sum of squared errors of the pairs
  double missed = 0.0;        ///< [1] true landmarks without a partner
  double spurious = 0.0;      ///< [1] landmarks of the map without a partner
};

/// Pairs `map` [m] and `truth` [m] at the least distance. A point that is not finite has no
/// partner.
Gospa gospa(std::span<const Eigen::Vector2d> map, std::span<const Eigen::Vector2d> truth,
            double cutoff = kGospaCutoff);

}  // namespace montecarta::analysis
