// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/chain_moments.hpp"

#include <cmath>
#include <complex>
#include <vector>

namespace montecarta::filters {
namespace {

using Complex = std::complex<double>;
constexpr Complex kI(0.0, 1.0);

/// Of finite numbers: operator* looks for others.
Complex product(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// One turned displacement T = exp(i psi) a of a place, psi and a Gaussian. Terms 0, 1, ... are the
/// displacements from frame to frame, that to the vehicle last, then the points in their frames.
struct Term {
  Eigen::Index row;          ///< of a
  bool is_polar;             ///< a is real, and the next row adds to psi
  Eigen::Index before = -1;  ///< the term whose place this one begins at; -1: the start
  Complex turn = {};         ///< E exp(i psi)
  Complex way = {};          ///< E T / turn = E a + i Cov(a, psi)
};

class Terms {
 public:
  Terms(const RelativeChain& chain, const Eigen::VectorXd& mean, const Eigen::MatrixXd& P,
        std::span<const RelativeChain::Point> points)
      : mean_(mean), P_(P) {
    for (const Eigen::Index row : chain.displacements) add({row, false, size() - 1});
    vehicle_ = size() - 1;
    for (const auto& [row, frame, is_polar] : points)
      add({row, is_polar, static_cast<Eigen::Index>(frame) - 1});
    gather_headings(chain.start.heading);
    gather_covariances();
    gather_places(chain.start);
  }

  JointEstimate estimate() const {
    std::vector<Eigen::Index> rows{2 * vehicle_, 2 * vehicle_ + 1, 2 * size()};
    for (Eigen::Index i = 2 * vehicle_ + 2; i < 2 * size(); ++i) rows.push_back(i);
    Eigen::MatrixXd columns = covariance_(Eigen::all, rows);
    for (auto column : columns.colwise()) {
      for (Eigen::Index i = 0; i < size(); ++i) {
        const Eigen::Index before = term(i).before;
        if (before >= 0) column.segment<2>(2 * i) += column.segment<2>(2 * before);
      }
    }
    const Eigen::MatrixXd P = columns(rows, Eigen::all);
    return {places_(rows), P.selfadjointView<Eigen::Lower>()};
  }

 private:
  Eigen::Index size() const { return static_cast<Eigen::Index>(terms_.size()); }
  Term& term(Eigen::Index i) { return terms_[static_cast<std::size_t>(i)]; }
  const Term& term(Eigen::Index i) const { return terms_[static_cast<std::size_t>(i)]; }
  void add(const Term& term) { terms_.push_back(term); }

  /// Cov(a of term i, psi of term j), and that of the vehicle's heading for j = size().
  Complex with_heading(Eigen::Index i, Eigen::Index j) const {
    const Term& t = term(i);
    return {by_heading_(t.row, j), t.is_polar ? 0.0 : by_heading_(t.row + 1, j)};
  }

  /// psi of each term is a sum of components of the Gaussian: covariances with all components, and
  /// with each other.
  void gather_headings(double start) {
    const Eigen::Index n = size();
    by_heading_.setZero(P_.rows(), n + 1);
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
      psi(i) = psi(before) + mean_(row);
      by_heading_.col(i) = by_heading_.col(before) + P_.col(row);
    });
    sum([&](Eigen::Index i, Eigen::Index before, Eigen::Index row) {
      headings_.col(i) = headings_.col(before) + by_heading_.row(row).transpose();
    });
    for (Eigen::Index i = 0; i < n; ++i) {
      Term& t = term(i);
      t.turn = std::polar(std::exp(-0.5 * headings_(i, i)), psi(i));
      t.way = Complex(mean_(t.row), t.is_polar ? 0.0 : mean_(t.row + 1)) + kI * with_heading(i, i);
    }
    heading_ = psi(n);
  }

  /// Cov(T_i, T_j), both as vectors. With C_ij = Cov(a_i, psi_j), of the product and of that with
  /// the conjugate.
  Eigen::Matrix2d covariance(Eigen::Index i, Eigen::Index j) const {
    const Term &s = term(i), &t = term(j);
    Eigen::Matrix2d K = P_.block<2, 2>(s.row, t.row);
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

  /// Of the terms, and in the last row and column with the vehicle's heading.
  void gather_covariances() {
    const Eigen::Index n = size();
    covariance_.resize(2 * n + 1, 2 * n + 1);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = j; i < n; ++i) {
        const Eigen::Matrix2d B = covariance(i, j);
        covariance_.block<2, 2>(2 * j, 2 * i) = B.transpose();
        covariance_.block<2, 2>(2 * i, 2 * j) = B;
      }
      const Complex c = term(j).turn * (kI * headings_(j, n) * term(j).way + with_heading(j, n));
      covariance_.col(2 * n).segment<2>(2 * j) << c.real(), c.imag();
    }
    covariance_.row(2 * n) = covariance_.col(2 * n).transpose();
    covariance_(2 * n, 2 * n) = headings_(n, n);
  }

  /// From terms to places, which are sums of them: means, and columns of covariances.
  void gather_places(const Pose& start) {
    const Eigen::Index n = size();
    places_.resize(2 * n + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Complex mean = term(i).turn * term(i).way;
      places_.segment<2>(2 * i) << mean.real(), mean.imag();
      const Eigen::Index before = term(i).before;
      if (before < 0) {
        places_.segment<2>(2 * i) += Eigen::Vector2d(start.x, start.y);
      } else {
        places_.segment<2>(2 * i) += places_.segment<2>(2 * before);
        covariance_.middleCols<2>(2 * i) += covariance_.middleCols<2>(2 * before);
      }
    }
    places_(2 * n) = wrap(heading_);
  }

  const Eigen::VectorXd& mean_;
  const Eigen::MatrixXd& P_;
  std::vector<Term> terms_;
  Eigen::Index vehicle_ = 0;
  double heading_ = 0.0;
  Eigen::MatrixXd by_heading_;  ///< {row, term} Cov(component, psi); behind the terms: heading
  Eigen::MatrixXd headings_;    ///< {term, term} Cov(psi, psi), likewise
  Eigen::VectorXd places_;      ///< {2 term}, then the heading
  Eigen::MatrixXd covariance_;  ///< of the terms with the places, likewise
};

}  // namespace

JointEstimate chain_moments(const RelativeChain& chain, const Eigen::VectorXd& mean,
                            const Eigen::MatrixXd& P,
                            std::span<const RelativeChain::Point> points) {
  return Terms(chain, mean, P, points).estimate();
}

}  // namespace montecarta::filters
