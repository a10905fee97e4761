// SPDX-License-Identifier: BSD-3-Clause
#include "filters/relative/relative_gaussian.hpp"

#include "filters/joint/map_moments.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace montecarta::filters {
namespace {

using ChainPoint = RelativeChain::Point;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Sorts newest frames first and, within a frame, in a fixed order, so that sums are reproducible.
void sort_parts(LinearisedPairs& pairs) {
  using Part = LinearisedPairs::Part;
  std::ranges::sort(pairs.parts, [](const Part& a, const Part& b) {
    return std::tie(b.frame, a.pair, a.row) < std::tie(a.frame, b.pair, b.row);
  });
}

/// Position of a landmark in the frame of the vehicle; adds its derivatives, times `sign`.
Eigen::Vector2d add_place(const ChainPoint& point, const Eigen::VectorXd& mean,
                          const VehicleInFrames& vehicle, Eigen::Index pair, double sign,
                          LinearisedPairs& pairs) {
  const LinearisedPoint at = linearised_point(point, mean);
  const LinearisedDetection seen =
      PositionSensor::linearised(vehicle.in(point.frame), at.place).value();
  pairs.parts.push_back({pair, point.frame, point.row, sign * seen.by_pose,
                         sign * seen.by_landmark * at.by_coordinates});
  return seen.value;
}

}  // namespace

void RelativeGaussian::start(const Pose& start) {
  chain_.start = start;
  chain_.displacements.assign(1, 0);
  chain_.landmarks.clear();
  rows_ = 3;
  mean_ = Eigen::VectorXd::Zero(kPack);
  P_ = Eigen::MatrixXd::Zero(kPack, kPack);
}

void RelativeGaussian::move(const MotionIncrement& motion) {
  const PoseGaussian<double> moved = motion.from(Pose{mean_(0), mean_(1), mean_(2)});
  const double x = mean_(1) - moved.mean.y, y = moved.mean.x - mean_(0);
  mean_.head<3>() << moved.mean.x, moved.mean.y, moved.mean.heading;
  P_.col(0) += x * P_.col(2);
  P_.col(1) += y * P_.col(2);
  P_.row(0) += x * P_.row(2);
  P_.row(1) += y * P_.row(2);
  P_.topLeftCorner<3, 3>() += symmetric(moved.covariance);
  P_.topRows<3>() = P_.leftCols<3>().transpose().eval();
  P_(0, 1) = P_(1, 0);
}

/// Drops the frame without landmarks that costs least. Dropping a frame costs half the variance of
/// the heading before it times the length of the displacement after it.
bool RelativeGaussian::drop_empty_frame() {
  std::vector<char>& is_empty = scratch_.is_empty;
  is_empty.assign(chain_.displacements.size(), true);
  for (const auto& [first, again] : chain_.landmarks) {
    is_empty[first.frame] = false;
    if (again) is_empty[again->frame] = false;
  }
  std::size_t straightest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 1; k < is_empty.size(); ++k) {
    const Eigen::Index before = chain_.displacements[k - 1] + 2;
    const Pose way = displacement(chain_, k, mean_);
    const double bend = 0.5 * P_(before, before) * length(way.x, way.y);
    if (!is_empty[k] || bend >= least) continue;
    least = bend;
    straightest = k;
  }
  if (straightest > 0) drop_frame(straightest);
  return straightest > 0;
}

/// Drops a frame. The displacements to and from it become one, in the rows of the second.
void RelativeGaussian::drop_frame(std::size_t frame) {
  const Eigen::Index from = chain_.displacements[frame - 1], to = chain_.displacements[frame];
  const auto both = linearised_composition(displacement(chain_, frame - 1, mean_),
                                           displacement(chain_, frame, mean_));
  const Columns columns = P_.middleCols<3>(from).lazyProduct(both.by_first.transpose()) +
                          P_.middleCols<3>(to).lazyProduct(both.by_second.transpose());
  const Eigen::Matrix3d own =
      both.by_first * columns.middleRows<3>(from) + both.by_second * columns.middleRows<3>(to);
  mean_.segment<3>(to) << both.pose.x, both.pose.y, both.pose.heading;
  P_.middleCols<3>(to) = columns;
  P_.middleRows<3>(to) = columns.transpose();
  P_.block<3, 3>(to, to) = own.selfadjointView<Eigen::Lower>();
  chain_.displacements.erase(chain_.displacements.begin() + static_cast<std::ptrdiff_t>(frame) - 1);
  for (auto& [first, again] : chain_.landmarks) {
    if (first.frame >= frame) --first.frame;
    if (again && again->frame >= frame) --again->frame;
  }
  scratch_.is_kept.assign(static_cast<std::size_t>(rows_), true);
  std::fill_n(scratch_.is_kept.begin() + from, 3, false);
  keep_rows();
}

bool RelativeGaussian::is_at_newest_frame() const {
  return mean_.head<3>().isZero(0.0) && P_.topLeftCorner<3, 3>().isZero(0.0);
}

void RelativeGaussian::add_frame() {
  const Eigen::Index row = add_rows(3);
  mean_.segment<3>(row) = mean_.head<3>();
  mean_.head<3>().setZero();
  P_.middleCols<3>(row) = P_.leftCols<3>();
  P_.middleRows<3>(row) = P_.topRows<3>();
  P_.block<3, 3>(row, row) = P_.topLeftCorner<3, 3>();
  P_.leftCols<3>().setZero();
  P_.topRows<3>().setZero();
  chain_.displacements.back() = row;
  chain_.displacements.push_back(0);
}

void RelativeGaussian::add_landmark(const Eigen::Vector2d& observed) {
  chain_.landmarks.push_back({add_point(observed), std::nullopt});
}

void RelativeGaussian::add_duplicate(const Seen& seen) {
  chain_.landmarks[seen.landmark].again = add_point(seen.observed);
}

/// Adds a point in the newest frame. Range and bearing from that frame are its coordinates and
/// therefore exactly Gaussian.
ChainPoint RelativeGaussian::add_point(const Eigen::Vector2d& observed) {
  const bool is_polar = is_at_newest_frame() && sensor_.is_polar();
  const Eigen::Index row = add_rows(2);
  const ChainPoint point{row, chain_.newest_frame(), is_polar};
  if (is_polar) {
    mean_.segment<2>(row) = observed;
    P_.block<2, 2>(row, row) = sensor_.variances().asDiagonal();
    return point;
  }
  const auto place = sensor_.placed(Pose{mean_(0), mean_(1), mean_(2)}, observed);
  const Matrix23& G = place.by_pose;
  const Eigen::Matrix2d& Gz = place.by_detection;
  mean_.segment<2>(row) = place.point;
  P_.middleCols<2>(row) = P_.leftCols<3>().lazyProduct(G.transpose());
  P_.middleRows<2>(row) = P_.middleCols<2>(row).transpose();
  P_.block<2, 2>(row, row) = G * P_.topLeftCorner<3, 3>() * G.transpose() +
                             Gz * sensor_.variances().asDiagonal() * Gz.transpose();
  P_(row, row + 1) = P_(row + 1, row);
  return point;
}

const ChainPoint& RelativeGaussian::point(std::size_t landmark) const {
  const auto& [first, again] = chain_.landmarks[landmark];
  return again ? *again : first;
}

bool RelativeGaussian::has_duplicates() const {
  return std::ranges::any_of(chain_.landmarks,
                             [](const auto& landmark) { return landmark.again.has_value(); });
}

void RelativeGaussian::bends(std::vector<double>& bends) const {
  bends.resize(chain_.displacements.size());
  Eigen::VectorXd with_heading = Eigen::VectorXd::Zero(mean_.size());
  double variance = 0.0, farthest = 0.0;
  Pose vehicle{};
  for (std::size_t k = bends.size(); k-- > 0;) {
    const Eigen::Index row = chain_.displacements[k] + 2;
    variance += P_(row, row) + 2.0 * with_heading(row);
    with_heading += P_.col(row);
    vehicle = composed(displacement(chain_, k, mean_), vehicle);
    farthest = std::max(farthest, length(vehicle.x, vehicle.y));
    bends[k] = 0.5 * variance * farthest;
  }
}

Eigen::Index RelativeGaussian::add_rows(Eigen::Index count) {
  const Eigen::Index first = std::exchange(rows_, rows_ + count);
  const Eigen::Index room = (rows_ + kPack - 1) / kPack * kPack;
  if (room > mean_.size()) {
    mean_.conservativeResizeLike(Eigen::VectorXd::Zero(room));
    P_.conservativeResizeLike(Eigen::MatrixXd::Zero(room, room));
  }
  return first;
}

/// Keeps the rows that are marked in scratch_.is_kept.
void RelativeGaussian::keep_rows() {
  std::vector<Eigen::Index>&kept = scratch_.kept, &now = scratch_.now;
  kept.clear();
  now.clear();
  for (Eigen::Index row = 0; row < rows_; ++row) {
    now.push_back(static_cast<Eigen::Index>(kept.size()));
    if (scratch_.is_kept[static_cast<std::size_t>(row)]) kept.push_back(row);
  }
  rows_ = static_cast<Eigen::Index>(kept.size());
  const Eigen::Index room = (rows_ + kPack - 1) / kPack * kPack;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(room);
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(room, room);
  mean.head(rows_) = mean_(kept);
  P.topLeftCorner(rows_, rows_) = P_(kept, kept);
  mean_.swap(mean);
  P_.swap(P);
  for (Eigen::Index& row : chain_.displacements) row = now[static_cast<std::size_t>(row)];
  for (auto& [first, again] : chain_.landmarks) {
    first.row = now[static_cast<std::size_t>(first.row)];
    if (again) again->row = now[static_cast<std::size_t>(again->row)];
  }
}

RelativeOutcome RelativeGaussian::see(std::span<const Seen> scan, int iterations) {
  std::size_t oldest = chain_.newest_frame();
  for (const Seen& seen : scan) oldest = std::min(oldest, point(seen.landmark).frame);
  VehicleInFrames& now = scratch_.conditioning.vehicle;
  now.linearise(chain_, mean_, oldest);
  std::vector<Seen>& used = scratch_.used;
  used.clear();
  for (const Seen& seen : scan) {
    const ChainPoint& p = point(seen.landmark);
    const LinearisedPoint at = linearised_point(p, mean_);
    if (sensor_.linearised(now.in(p.frame), at.place)) used.push_back(seen);
  }
  if (used.empty()) return {};
  const RelativeMeasurement measurement{
      .oldest_frame = oldest,
      .linearise = [&](const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                       LinearisedPairs& pairs) { return linearise(used, mean, vehicle, pairs); },
      .variances = sensor_.variances().replicate(static_cast<Eigen::Index>(used.size()), 1)};
  return condition(chain_, measurement, iterations, scratch_.conditioning, mean_, P_);
}

bool RelativeGaussian::linearise(std::span<const Seen> scan, const Eigen::VectorXd& mean,
                                 const VehicleInFrames& vehicle, LinearisedPairs& pairs) const {
  pairs.parts.clear();
  pairs.residual.resize(2 * static_cast<Eigen::Index>(scan.size()));
  Eigen::Index pair = 0;
  for (const Seen& seen : scan) {
    const ChainPoint& p = point(seen.landmark);
    const LinearisedPoint at = linearised_point(p, mean);
    const auto expected = sensor_.linearised(vehicle.in(p.frame), at.place);
    if (!expected) return false;
    pairs.residual.segment<2>(2 * pair) = sensor_.residual(seen.observed, expected->value);
    pairs.parts.push_back(
        {pair++, p.frame, p.row, expected->by_pose, expected->by_landmark * at.by_coordinates});
  }
  sort_parts(pairs);
  return true;
}

bool RelativeGaussian::condition_on_equality(int iterations) {
  auto& twice = scratch_.twice;
  twice.clear();
  std::size_t oldest = chain_.newest_frame();
  for (const auto& [first, again] : chain_.landmarks) {
    if (!again) continue;
    twice.emplace_back(first, *again);
    oldest = std::min(oldest, first.frame);
  }
  const auto linearise = [&](const Eigen::VectorXd& mean, const VehicleInFrames& vehicle,
                             LinearisedPairs& pairs) {
    pairs.parts.clear();
    pairs.residual.resize(2 * static_cast<Eigen::Index>(twice.size()));
    Eigen::Index pair = 0;
    for (const auto& [first, again] : twice) {
      const Eigen::Vector2d then = add_place(first, mean, vehicle, pair, 1.0, pairs);
      const Eigen::Vector2d now = add_place(again, mean, vehicle, pair, -1.0, pairs);
      pairs.residual.segment<2>(2 * pair++) = now - then;
    }
    sort_parts(pairs);
    return true;
  };
  const RelativeMeasurement measurement{
      .oldest_frame = oldest, .linearise = linearise, .variances = {}};
  return !condition(chain_, measurement, iterations, scratch_.conditioning, mean_, P_).is_faulty;
}

bool RelativeGaussian::merge_duplicates(int iterations) {
  const bool are_equal = condition_on_equality(iterations);
  scratch_.is_kept.assign(static_cast<std::size_t>(rows_), true);
  for (auto& [first, again] : chain_.landmarks) {
    if (!again) continue;
    if (!are_equal) std::swap(first, *again);
    std::fill_n(scratch_.is_kept.begin() + again->row, 2, false);
    again.reset();
  }
  keep_rows();
  return are_equal;
}

void RelativeGaussian::expect_all(const Expect& expect) const {
  VehicleGaussian vehicle{.with_all = Columns::Zero(P_.rows(), 3)};
  for (std::size_t k = chain_.displacements.size(); k-- > 0;) {
    vehicle.become_that_in_frame(k, chain_, mean_, P_);
    for (std::size_t l = 0; l < chain_.landmarks.size(); ++l) {
      if (point(l).frame == k) expect_one(l, vehicle, expect);
    }
  }
}

void RelativeGaussian::expect_one(std::size_t landmark, const VehicleGaussian& vehicle,
                                  const Expect& expect) const {
  const ChainPoint& p = point(landmark);
  const LinearisedPoint at = linearised_point(p, mean_);
  const auto seen = sensor_.linearised(vehicle.pose, at.place);
  if (!seen) return;
  const Matrix23& Hx = seen->by_pose;
  const Eigen::Matrix2d Hl = seen->by_landmark * at.by_coordinates;
  const Eigen::Matrix2d mixed = Hl * vehicle.with_all.middleRows<2>(p.row) * Hx.transpose();
  Eigen::Matrix2d S = Hx * vehicle.covariance * Hx.transpose() + mixed + mixed.transpose() +
                      Hl * P_.block<2, 2>(p.row, p.row) * Hl.transpose();
  S.diagonal() += sensor_.variances();
  expect(landmark, seen->value, S);
}

}  // namespace montecarta::filters
