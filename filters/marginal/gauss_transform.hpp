// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/numbers/real.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The vector to `place` from `site`, and its squared length.
template <class Real, std::size_t D>
struct Separation {
  std::array<Real, D> way;
  Real squared{0.0};

  Separation(const std::array<Real, D>& place, const std::array<double, D>& site) {
    for (std::size_t d = 0; d < D; ++d) {
      way[d] = place[d] - Real(site[d]);
      squared += way[d] * way[d];
    }
  }
};

/// Clusters by farthest points (Gonzalez 1985): every new centre is the point farthest from those
/// before it. The radius is at most twice the least possible one.
template <std::size_t D>
class FarthestPoints {
 public:
  using Place = std::array<double, D>;

  explicit FarthestPoints(std::span<const Place> points)
      : points_(points),
        owners_(points.size(), 0),
        distances_(points.size(), std::numeric_limits<double>::infinity()) {}

  /// Adds a centre; returns false if all points are centres already.
  bool grow() {
    if (centres_.size() == points_.size()) return false;
    const auto farthest = std::max_element(distances_.begin(), distances_.end());
    add(static_cast<std::uint32_t>(farthest - distances_.begin()));
    return true;
  }
  /// Keeps only the first `count` centres.
  void shrink(std::size_t count) {
    const std::vector<std::uint32_t> kept(centres_.begin(),
                                          centres_.begin() + static_cast<std::ptrdiff_t>(count));
    centres_.clear();
    std::fill(distances_.begin(), distances_.end(), std::numeric_limits<double>::infinity());
    for (const std::uint32_t centre : kept) add(centre);
  }

  std::span<const std::uint32_t> centres() const { return centres_; }
  /// {point} index of its centre.
  std::span<const std::uint32_t> owners() const { return owners_; }
  /// Greatest distance of a point from its centre.
  double radius() const {
    return std::sqrt(*std::max_element(distances_.begin(), distances_.end()));
  }

 private:
  void add(std::uint32_t centre) {
    const auto number = static_cast<std::uint32_t>(centres_.size());
    centres_.push_back(centre);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double squared = Separation(points_[i], points_[centre]).squared;
      if (squared < distances_[i]) distances_[i] = squared, owners_[i] = number;
    }
    distances_[centre] = 0.0, owners_[centre] = number;
  }

  std::span<const Place> points_;
  std::vector<std::uint32_t> centres_;
  std::vector<std::uint32_t> owners_;
  std::vector<double> distances_;  ///< {point} squared distance to the nearest centre
};

/// Calls visit(dimension, parent, same) for every monomial of degree 1 to `order` - 1 in D
/// variables: monomial t (from 1, in the order of the calls) is monomial `parent` times variable
/// `dimension`. The power of that variable in it is that in `parent` plus one if `same`, else one.
template <std::size_t D, class Visit>
void for_each_monomial(int order, const Visit& visit) {
  std::array<std::size_t, D + 1> heads{};
  heads[D] = static_cast<std::size_t>(-1);
  std::size_t t = 1, tail = 1;
  for (int k = 1; k < order; ++k, tail = t) {
    for (std::size_t d = 0; d < D; ++d) {
      const std::size_t head = heads[d];
      heads[d] = t;
      for (std::size_t parent = head; parent < tail; ++parent, ++t)
        visit(d, parent, parent < heads[d + 1]);
    }
  }
}

/// Number of monomials of degree below `order` in D variables: binom(order - 1 + D, D).
template <std::size_t D>
std::size_t monomials_below(int order) {
  double count = 1.0;
  for (std::size_t d = 1; d <= D; ++d)
    count *= (static_cast<double>(order) - 1.0 + static_cast<double>(d)) / static_cast<double>(d);
  return static_cast<std::size_t>(std::lround(count));
}

/// Least degree for which the series of a source at distance `radius` from its centre errs by at
/// most `tolerance` at every target up to `reach` from it; nullopt beyond `most` (EQUATIONS 13).
inline std::optional<int> series_order(double radius, double reach, double tolerance, int most) {
  double factor = 1.0;  // (2 a b)^p / p!
  for (int p = 1; p <= most; ++p) {
    const double b = std::min(reach, 0.5 * (radius + std::sqrt(radius * radius + 2.0 * p)));
    factor = 1.0;
    for (int k = 1; k <= p; ++k) factor *= 2.0 * radius * b / k;
    if (factor * std::exp(-(radius - b) * (radius - b)) <= tolerance) return p;
  }
  return std::nullopt;
}

/// Improved fast Gauss transform (EQUATIONS 13; Havangi, appendix): Sum_j q_n[j] exp(-|y - x_j|^2)
/// for N sets of weights at once, with an error of at most tolerance Sum_j |q_n[j]|.
template <std::size_t D, std::size_t N>
class GaussTransform {
 public:
  using Place = std::array<double, D>;
  using Charges = std::array<double, N>;
  static constexpr int kMostOrder = 30;

  /// Returns false if the sources are too scattered for series to be faster than direct sums.
  /// `clusters` is their number, or 0 for the cheapest number.
  [[nodiscard]] bool build(std::span<const Place> sources, std::span<const Charges> charges,
                           double tolerance, std::size_t clusters = 0) {
    reach_ = std::sqrt(std::log(1.0 / tolerance));
    const bool is_free = clusters == 0;
    const std::size_t most = is_free ? std::max<std::size_t>(1, sources.size() / 2) : clusters;
    if (!choose(sources, tolerance, most, is_free)) return false;
    expand(sources, charges);
    return true;
  }
  std::size_t clusters() const { return centres_.size(); }
  int order() const { return order_; }

  /// The N sums at one target, or at one target per lane.
  template <class Real>
  std::array<Real, N> operator()(const std::array<Real, D>& target,
                                 std::vector<Real>& monomials) const {
    std::array<Real, N> sums;
    sums.fill(Real(0.0));
    monomials.resize(terms_);
    for (std::size_t c = 0; c < centres_.size(); ++c) {
      const Separation off(target, sites_[c]);
      const double far = reach_ + radius_;
      if (!any(off.squared <= Real(far * far))) continue;
      fill_monomials(off.way, Real(exp(-off.squared)), monomials);
      const Charges* coefficients = coefficients_.data() + c * terms_;
      for (std::size_t t = 0; t < terms_; ++t) {
        for (std::size_t n = 0; n < N; ++n) sums[n] += Real(coefficients[t][n]) * monomials[t];
      }
    }
    return sums;
  }

 private:
  /// Increases the number of clusters as long as the estimated work decreases.
  bool choose(std::span<const Place> sources, double tolerance, std::size_t most, bool is_free) {
    FarthestPoints<D> points(sources);
    double least_work = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t k = 1; k <= most && points.grow(); ++k) {
      if (!is_free && k < most) continue;
      const double radius = points.radius();
      const auto order = series_order(radius, radius + reach_, tolerance, kMostOrder);
      if (!order) continue;
      const double cells = std::pow((reach_ + 2.0 * radius) / std::max(radius, 1e-300), double(D));
      const double neighbours = std::min(static_cast<double>(k), cells);
      const double work = static_cast<double>(D * k) * (1.0 + std::log(static_cast<double>(k))) +
                          (1.0 + neighbours) * static_cast<double>(monomials_below<D>(*order));
      if (work < least_work) least_work = work, best = k, order_ = *order, radius_ = radius;
      if (best > 0 && k > 2 * best + 10) break;
    }
    if (best == 0) return false;
    points.shrink(best);
    centres_.assign(points.centres().begin(), points.centres().end());
    owners_.assign(points.owners().begin(), points.owners().end());
    radius_ = points.radius();
    return true;
  }

  void expand(std::span<const Place> sources, std::span<const Charges> charges) {
    terms_ = monomials_below<D>(order_);
    coefficients_.assign(centres_.size() * terms_, Charges{});
    sites_.clear();
    for (const std::uint32_t c : centres_) sites_.push_back(sources[c]);
    std::vector<double> monomials(terms_), constants(terms_, 1.0), powers(terms_, 0.0);
    std::size_t t = 1;
    for_each_monomial<D>(order_, [&](std::size_t, std::size_t parent, bool again) {
      powers[t] = again ? powers[parent] + 1.0 : 1.0;
      constants[t] = 2.0 * constants[parent] / powers[t];  // 2^|a| / a!, without overflow
      ++t;
    });
    for (std::size_t j = 0; j < sources.size(); ++j) {
      const Separation off(sources[j], sites_[owners_[j]]);
      fill_monomials(off.way, std::exp(-off.squared), monomials);
      for (std::size_t k = 0; k < terms_; ++k) {
        for (std::size_t n = 0; n < N; ++n)
          coefficients_[owners_[j] * terms_ + k][n] += charges[j][n] * monomials[k] * constants[k];
      }
    }
  }

  template <class Real>
  void fill_monomials(const std::array<Real, D>& x, const Real& first,
                      std::vector<Real>& monomials) const {
    monomials[0] = first;
    std::size_t t = 1;
    for_each_monomial<D>(order_, [&](std::size_t d, std::size_t parent, bool) {
      monomials[t++] = x[d] * monomials[parent];
    });
  }

  double reach_ = 0.0;   ///< r: a source farther than this from a target is neglected
  double radius_ = 0.0;  ///< r_x: greatest distance of a source from its centre
  int order_ = 1;        ///< p: degree at which the series ends
  std::size_t terms_ = 1;
  std::vector<std::uint32_t> centres_;  ///< indices of sources that are centres
  std::vector<std::uint32_t> owners_;   ///< {source} index of its centre
  std::vector<Place> sites_;            ///< positions of the centres
  std::vector<Charges> coefficients_;   ///< {centre, monomial} coefficients of the series
};

}  // namespace montecarta::filters
