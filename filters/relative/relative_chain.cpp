// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_chain.hpp"

#include <cmath>

namespace montecarta::filters {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI(0.0, 1.0);

/// Product of finite numbers; operator* would also test for infinities and NaN.
Complex product(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

LinearisedComposition linearised_composition(const Pose& first, const Pose& second) {
  const Direction<double> d = direction_of(first.heading);
  const auto [x, y] = in_world(d, second.x, second.y);
  LinearisedComposition both;
  both.pose = {first.x + x, first.y + y, wrap(first.heading + second.heading)};
  both.by_first << 1.0, 0.0, -y, 0.0, 1.0, x, 0.0, 0.0, 1.0;
  both.by_second << d.cosine, -d.sine, 0.0, d.sine, d.cosine, 0.0, 0.0, 0.0, 1.0;
  return both;
}

LinearisedPoint linearised_point(const RelativeChain::Point& point, const Eigen::VectorXd& mean) {
  const double first = mean(point.row), second = mean(point.row + 1);
  if (!point.is_polar) return {{first, second}, Eigen::Matrix2d::Identity()};
  const Direction<double> ray = direction_of(second);
  LinearisedPoint polar;
  polar.place = {first * ray.cosine, first * ray.sine};
  polar.by_coordinates << ray.cosine, -polar.place.y, ray.sine, polar.place.x;
  return polar;
}

Pose displacement(const RelativeChain& chain, std::size_t k, const Eigen::VectorXd& mean) {
  const Eigen::Index row = chain.displacements[k];
  return {mean(row), mean(row + 1), mean(row + 2)};
}

JointEstimate ChainMoments::of(const RelativeChain& chain, const Eigen::VectorXd& mean,
                               const Eigen::MatrixXd& P,
                               std::span<const RelativeChain::Point> points) {
  terms_.clear();
  for (const Eigen::Index row : chain.displacements) terms_.push_back({row, false, size() - 1});
  vehicle_ = size() - 1;
  for (const auto& [row, frame, is_polar] : points)
    terms_.push_back({row, is_polar, static_cast<Eigen::Index>(frame) - 1});
  gather_headings(chain.start.heading, mean, P);
  gather_covariances(P);
  gather_places(chain.start);
  return estimate();
}

/// Completes the sums: covariance_ already has sums over columns, and this function sums over rows
/// as well.
JointEstimate ChainMoments::estimate() const {
  const Eigen::Index n = 1 + 2 * (size() - vehicle_);
  const auto row_of = [&](Eigen::Index i) {
    if (i == 2) return 2 * size();
    return 2 * vehicle_ + (i < 2 ? i : i - 1);
  };
  JointEstimate joint;
  joint.mean.resize(n);
  joint.covariance.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    Eigen::VectorXd column = covariance_.col(row_of(j));
    for (Eigen::Index i = 0; i < size(); ++i) {
      const Eigen::Index before = term(i).before;
      if (before >= 0) column.segment<2>(2 * i) += column.segment<2>(2 * before);
    }
    joint.mean(j) = places_(row_of(j));
    for (Eigen::Index i = j; i < n; ++i)
      joint.covariance(i, j) = joint.covariance(j, i) = column(row_of(i));
  }
  return joint;
}

/// Cov(a of term i, psi of term j); for j = size(), psi is the heading of the vehicle.
Complex ChainMoments::with_heading(Eigen::Index i, Eigen::Index j) const {
  const Term& t = term(i);
  return {by_heading_(t.row, j), t.is_polar ? 0.0 : by_heading_(t.row + 1, j)};
}

/// Computes the covariances of psi of each term, which is a sum of components of the Gaussian, with
/// all components and with the other psi.
void ChainMoments::gather_headings(double start, const Eigen::VectorXd& mean,
                                   const Eigen::MatrixXd& P) {
  const Eigen::Index n = size();
  by_heading_.setZero(P.rows(), n + 1);
  headings_.setZero(n + 1, n + 1);
  Eigen::VectorXd psi = Eigen::VectorXd::Constant(n + 1, start);
  const auto sum = [&](const auto& add_row) {
    for (Eigen::Index i = 0; i <= n; ++i) {
      const Eigen::Index before = i < n ? term(i).before : vehicle_;
      if (before >= 0) add_row(i, before, term(before).row + 2);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      if (term(i).is_polar) add_row(i, i, term(i).row + 1);
    }
  };
  sum([&](Eigen::Index i, Eigen::Index before, Eigen::Index row) {
    psi(i) = psi(before) + mean(row);
    by_heading_.col(i) = by_heading_.col(before) + P.col(row);
  });
  sum([&](Eigen::Index i, Eigen::Index before, Eigen::Index row) {
    headings_.col(i) = headings_.col(before) + by_heading_.row(row).transpose();
  });
  for (Eigen::Index i = 0; i < n; ++i) {
    Term& t = term(i);
    t.turn = std::polar(std::exp(-0.5 * headings_(i, i)), psi(i));
    t.way = Complex(mean(t.row), t.is_polar ? 0.0 : mean(t.row + 1)) + kI * with_heading(i, i);
  }
  heading_ = psi(n);
}

/// Cov(T_i, T_j), both as vectors, from the covariances of T_i with T_j and with its conjugate
/// (EQUATIONS (22.5), (22.6)); C_ij = Cov(a_i, psi_j).
Eigen::Matrix2d ChainMoments::covariance(Eigen::Index i, Eigen::Index j,
                                         const Eigen::MatrixXd& P) const {
  const Term &s = term(i), &t = term(j);
  Eigen::Matrix2d K = P.block<2, 2>(s.row, t.row);
  if (s.is_polar) K.row(1).setZero();
  if (t.is_polar) K.col(1).setZero();
  const Complex k(K(0, 0) - K(1, 1), K(0, 1) + K(1, 0));
  const Complex l(K(0, 0) + K(1, 1), K(1, 0) - K(0, 1));
  const Complex c = kI * with_heading(i, j), d = kI * with_heading(j, i);
  const double apart = std::expm1(headings_(i, j)), together = -apart / (1.0 + apart);
  const Complex more = product(c, t.way) + product(s.way + c, d) + k;
  const Complex less = l - product(c, std::conj(t.way)) - product(s.way - c, std::conj(d));
  const Complex plain =
      product(product(s.turn, t.turn), together * (product(s.way, t.way) + more) + more);
  const Complex conjugate = product(product(s.turn, std::conj(t.turn)),
                                    apart * (product(s.way, std::conj(t.way)) + less) + less);
  Eigen::Matrix2d B;
  B << plain.real() + conjugate.real(), plain.imag() - conjugate.imag(),
      plain.imag() + conjugate.imag(), conjugate.real() - plain.real();
  return 0.5 * B;
}

/// Covariances of the terms; the last row and column are those with the heading of the vehicle.
void ChainMoments::gather_covariances(const Eigen::MatrixXd& P) {
  const Eigen::Index n = size();
  covariance_.resize(2 * n + 1, 2 * n + 1);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = j; i < n; ++i) {
      const Eigen::Matrix2d B = covariance(i, j, P);
      covariance_.block<2, 2>(2 * j, 2 * i) = B.transpose();
      covariance_.block<2, 2>(2 * i, 2 * j) = B;
    }
    const Complex c = term(j).turn * (kI * headings_(j, n) * term(j).way + with_heading(j, n));
    covariance_.col(2 * n).segment<2>(2 * j) << c.real(), c.imag();
  }
  covariance_.row(2 * n) = covariance_.col(2 * n).transpose();
  covariance_(2 * n, 2 * n) = headings_(n, n);
}

/// Sums terms to positions: their means, and the columns of their covariances.
void ChainMoments::gather_places(const Pose& start) {
  const Eigen::Index n = size();
  places_.resize(2 * n + 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Complex mean = term(i).turn * term(i).way;
    places_.segment<2>(2 * i) << mean.real(), mean.imag();
    const Eigen::Index before = term(i).before;
    if (before < 0) {
      places_.segment<2>(2 * i) += place_of(start);
    } else {
      places_.segment<2>(2 * i) += places_.segment<2>(2 * before);
      covariance_.middleCols<2>(2 * i) += covariance_.middleCols<2>(2 * before);
    }
  }
  places_(2 * n) = wrap(heading_);
}

}  // namespace montecarta::filters
