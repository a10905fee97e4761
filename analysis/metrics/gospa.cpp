// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/gospa.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

constexpr Eigen::Index kUnassigned = -1;
constexpr double kUnreached = std::numeric_limits<double>::infinity();

/// Prices of rows and columns, none above what a pair costs and equal to it for every pair that is
/// assigned: as long as that holds, what is assigned is assigned as cheaply as can be.
struct Assignment {
  explicit Assignment(const Eigen::MatrixXd& costs)
      : cost(&costs),
        row_price(costs.rowwise().minCoeff()),
        column_price(Eigen::VectorXd::Zero(costs.cols())),
        column_of(static_cast<std::size_t>(costs.rows()), kUnassigned),
        row_of(static_cast<std::size_t>(costs.cols()), kUnassigned) {}

  double excess(Eigen::Index row, Eigen::Index column) const {
    return (*cost)(row, column) - row_price(row) - column_price(column);
  }
  void assign(Eigen::Index row, Eigen::Index column) {
    column_of[static_cast<std::size_t>(row)] = column;
    row_of[static_cast<std::size_t>(column)] = row;
  }
  Eigen::Index owner(Eigen::Index column) const { return row_of[static_cast<std::size_t>(column)]; }

  const Eigen::MatrixXd* cost;
  Eigen::VectorXd row_price, column_price;
  std::vector<Eigen::Index> column_of, row_of;
};

/// Every row takes its cheapest column where nobody has it.
void assign_cheapest(Assignment& assignment) {
  for (Eigen::Index row = 0; row < assignment.cost->rows(); ++row) {
    Eigen::Index column = 0;
    assignment.cost->row(row).minCoeff(&column);
    if (assignment.owner(column) == kUnassigned) assignment.assign(row, column);
  }
}

/// The cheapest ways from one row to all columns (Dijkstra), until one ends at a free column.
struct Search {
  Search(const Assignment& assignment, Eigen::Index start)
      : distance(static_cast<std::size_t>(assignment.cost->cols()), kUnreached),
        previous(distance.size(), kUnassigned),
        done(distance.size(), false) {
    Eigen::Index row = start, last = kUnassigned;
    double so_far = 0.0;
    while (row != kUnassigned) {
      relax(assignment, row, last, so_far);
      last = nearest();
      so_far = distance[static_cast<std::size_t>(last)];
      done[static_cast<std::size_t>(last)] = true;
      row = assignment.owner(last);
    }
    end = last;
    length = so_far;
  }

  void relax(const Assignment& assignment, Eigen::Index row, Eigen::Index from, double so_far) {
    for (std::size_t c = 0; c < distance.size(); ++c) {
      if (done[c]) continue;
      const double way = so_far + assignment.excess(row, static_cast<Eigen::Index>(c));
      if (way >= distance[c]) continue;
      distance[c] = way;
      previous[c] = from;
    }
  }
  Eigen::Index nearest() const {
    std::size_t best = distance.size();
    for (std::size_t c = 0; c < distance.size(); ++c) {
      if (!done[c] && (best == distance.size() || distance[c] < distance[best])) best = c;
    }
    return static_cast<Eigen::Index>(best);
  }

  std::vector<double> distance;
  std::vector<Eigen::Index> previous;  ///< column before on the way; kUnassigned: the start
  std::vector<bool> done;
  Eigen::Index end = kUnassigned;
  double length = 0.0;
};

/// Gives `start` a column by moving the rows on the cheapest way along it.
void augment(Assignment& assignment, Eigen::Index start) {
  const Search search(assignment, start);
  assignment.row_price(start) += search.length;
  for (std::size_t c = 0; c < search.done.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    if (!search.done[c] || column == search.end) continue;
    const double shorter = search.length - search.distance[c];
    assignment.column_price(column) -= shorter;
    assignment.row_price(assignment.owner(column)) += shorter;
  }
  Eigen::Index column = search.end;
  for (Eigen::Index before; column != kUnassigned; column = before) {
    before = search.previous[static_cast<std::size_t>(column)];
    assignment.assign(before == kUnassigned ? start : assignment.owner(before), column);
  }
}

using PointSpan = std::span<const Eigen::Vector2d>;

/// Squared distances, at most the cutoff's: no worse than to leave both alone.
Eigen::MatrixXd costs(PointSpan few, PointSpan many, double cutoff) {
  Eigen::MatrixXd cost(few.size(), many.size());
  for (Eigen::Index i = 0; i < cost.rows(); ++i) {
    for (Eigen::Index j = 0; j < cost.cols(); ++j) {
      const double squared =
          (few[static_cast<std::size_t>(i)] - many[static_cast<std::size_t>(j)]).squaredNorm();
      cost(i, j) = squared < cutoff * cutoff ? squared : cutoff * cutoff;  // NaN is far
    }
  }
  return cost;
}

}  // namespace

std::vector<std::size_t> cheapest_assignment(const Eigen::MatrixXd& cost) {
  expect(cost.rows() <= cost.cols() && cost.allFinite(), "costs are finite, wide as high");
  if (cost.rows() == 0) return {};
  Assignment assignment(cost);
  assign_cheapest(assignment);
  for (Eigen::Index row = 0; row < cost.rows(); ++row) {
    if (assignment.column_of[static_cast<std::size_t>(row)] == kUnassigned)
      augment(assignment, row);
  }
  return {assignment.column_of.begin(), assignment.column_of.end()};
}

Gospa gospa(PointSpan map, PointSpan truth, double cutoff) {
  const bool smaller = map.size() <= truth.size();
  const Eigen::MatrixXd cost = smaller ? costs(map, truth, cutoff) : costs(truth, map, cutoff);
  const std::vector<std::size_t> partner = cheapest_assignment(cost);
  const double far = cutoff * cutoff;
  double squares = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < partner.size(); ++i) {
    const double squared =
        cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(partner[i]));
    if (squared >= far) continue;
    squares += squared;
    pairs += 1.0;
  }
  Gospa result;
  result.localisation = std::sqrt(squares);
  result.missed = static_cast<double>(truth.size()) - pairs;
  result.spurious = static_cast<double>(map.size()) - pairs;
  result.distance = std::sqrt(squares + 0.5 * far * (result.missed + result.spurious));
  return result;
}

}  // namespace montecarta::analysis
