// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/compressed_gaussian.hpp"

#include "filters/joint/products.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace montecarta::filters {
namespace {

/// Length, relative to the longest column, below which a residual is dropped: it is rounding.
constexpr double kLeftOut = 1e-14;

/// Index and squared norm of the longest column.
std::pair<Eigen::Index, double> longest_of(const Eigen::MatrixXd& columns) {
  std::pair<Eigen::Index, double> longest{0, 0.0};
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double squared = dot(columns.col(j), columns.col(j));
    if (squared > longest.second) longest = {j, squared};
  }
  return longest;
}

/// Makes the next `Width` vectors from column `longest`, and subtracts their share from every
/// column.
template <int Width>
void take_out(Eigen::Index longest, double squared, Eigen::MatrixXd& columns,
              Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Width>> vectors,
              Eigen::Ref<Eigen::MatrixXd> coefficients) {
  vectors.col(0) = columns.col(longest) / std::sqrt(squared);
  if constexpr (Width == 2) {
    vectors.col(1) = vectors.col(0);
    apply(quarter_turn(), vectors.col(1).reshaped(2, columns.rows() / 2));
  }
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    Eigen::Matrix<double, Width, 1> share;
    for (int q = 0; q < Width; ++q) share(q) = dot(vectors.col(q), columns.col(j));
    coefficients.col(j) = share;
    add_combination(vectors, -share, columns.col(j));
  }
}

/// Largest map without far landmarks. In smaller ones, expanding costs more than is saved.
constexpr std::size_t kSmallMap = 100;

/// Number of landmarks around the vehicle that are near. A detection costs the square of this
/// number, but with more near landmarks it takes longer until a far one is observed.
constexpr std::size_t kNear = 30;
/// Loss by compression [detections of the whole map] after which all landmarks become near, and the
/// number of detections for which they stay so.
constexpr double kGreatestBalance = 150.0;
constexpr std::size_t kDetectionsUncompressed = 5000;

}  // namespace

/// Orthonormalises the columns by Gram-Schmidt. The longest residual is always taken next.
void Basis::span(Eigen::MatrixXd& columns, Retraction retraction) {
  const Eigen::Index width = retraction == Retraction::right_invariant ? 2 : 1;
  const Eigen::Index most = std::min(width * columns.cols(), columns.rows());
  if (vectors_.rows() != columns.rows() || vectors_.cols() <= most) {
    vectors_.resize(columns.rows(), most + 1);
  }
  coefficients_.resize(most + 1, columns.cols());
  double least_squared = 0.0;
  for (size_ = 0; size_ < most; size_ += width) {
    const auto [longest, squared] = longest_of(columns);
    if (size_ == 0) least_squared = kLeftOut * kLeftOut * squared;
    if (!(squared > least_squared)) break;
    auto shares = coefficients_.middleRows(size_, width);
    if (width == 2) {
      take_out<2>(longest, squared, columns, vectors_.middleCols<2>(size_), shares);
    } else {
      take_out<1>(longest, squared, columns, vectors_.col(size_), shares);
    }
  }
  if (size_ % 2 == 0) return;
  vectors_.col(size_).setZero();
  coefficients_.row(size_++).setZero();
}

CompressedGaussian::CompressedGaussian(const Belief& belief, Retraction retraction,
                                       std::size_t room)
    : near_(belief, retraction, std::min(room, kSmallMap)),
      retraction_(retraction),
      most_near_(kSmallMap) {}

void CompressedGaussian::start(const Pose& start, const Eigen::Matrix3d& covariance) {
  near_.start(start, covariance);
  make_all_near();
  point_of_.clear();
  balance_ = 0.0;
  is_suspended_ = false;
}

void CompressedGaussian::replace(const PoseMoments& pose, const MapMoments& map) {
  near_.replace_map(landmarks());
  near_.replace(pose, map);
  std::iota(point_of_.begin(), point_of_.end(), 0U);
  make_all_near();
}

/// Forgets far landmarks and their stand-ins.
void CompressedGaussian::make_all_near() {
  whole_.clear(std::min(rows(), whole_.room()));
  basis_.clear();
  stand_ins_ = 0;
  most_near_ = kSmallMap;
  updates_ = 0;
}

void CompressedGaussian::centre_on_pose() {
  if (std::ranges::find(point_of_, kFar) != point_of_.end()) replace(pose(), map());
  near_.centre_on_pose();
}

Eigen::Vector2d CompressedGaussian::mean_of(std::size_t slot) const {
  if (is_near(slot)) return near_.map().mean.segment<2>(row_of(point_of_[slot]));
  const Eigen::Index row = row_of(slot);
  return whole_.mean.segment<2>(row) + basis_.vectors().middleRows<2>(row) * coefficients_of_mean();
}

PointMoments CompressedGaussian::far_point(std::size_t slot) const {
  const Eigen::Index row = row_of(slot);
  const auto W = basis_.vectors().middleRows<2>(row);
  Columns2 YW(basis_.size(), 2);
  for (Eigen::Index j = 0; j < 2; ++j) {
    YW.col(j).noalias() = coefficients_of_covariance() * W.row(j).transpose();
  }
  PointMoments point{.mean = mean_of(slot),
                     .cross = W * coefficients_of_cross(),
                     .covariance = whole_.covariance.block<2, 2>(row, row) + W * YW};
  point.covariance(0, 1) = point.covariance(1, 0);
  return point;
}

PointMoments CompressedGaussian::point(std::size_t slot) const {
  return is_near(slot) ? near_.point(point_of_[slot]) : far_point(slot);
}

LandmarkEstimate CompressedGaussian::landmark(std::size_t slot) const {
  const PointMoments moments = point(slot);
  return {moments.mean, moments.covariance};
}

MapMoments CompressedGaussian::map() const {
  MapMoments map = whole_;
  map.make_room(rows());
  expand_into(map);
  return map;
}

JointEstimate CompressedGaussian::joint() const {
  const MapMoments whole = map();
  const Eigen::Index n = row_of(landmarks());
  JointEstimate joint{Eigen::VectorXd(3 + n), Eigen::MatrixXd(3 + n, 3 + n)};
  joint.mean << pose().mean.x, pose().mean.y, pose().mean.heading, whole.mean.head(n);
  joint.covariance.topLeftCorner<3, 3>() = pose().covariance;
  joint.covariance.bottomLeftCorner(n, 3) = whole.cross.topRows(n);
  joint.covariance.topRightCorner(3, n) = whole.cross.topRows(n).transpose();
  joint.covariance.bottomRightCorner(n, n) =
      whole.covariance.topLeftCorner(n, n).selfadjointView<Eigen::Lower>();
  return joint;
}

CompressedGaussian::Drift CompressedGaussian::drift() const {
  const Eigen::MatrixXd Y = coefficients_of_covariance();
  return {coefficients_of_mean().norm(), std::sqrt(dot(Y.reshaped(), Y.reshaped()))};
}

/// Considers the range only: v^2 / S of the range is at most D^2, and the standard deviation of a
/// difference is at most the sum of both.
bool CompressedGaussian::is_out_of_reach(std::size_t slot, const Drift& drift, double range,
                                         double sigmas) const {
  if (is_near(slot)) return false;
  const auto& [share, variance] = far_[slot];
  const double distance = (whole_.mean.segment<2>(row_of(slot)) - place_of(pose().mean)).norm();
  const double spread = std::sqrt(variance + share * share * drift.variance) +
                        std::sqrt(pose().covariance.topLeftCorner<2, 2>().trace());
  const Belief& belief = near_.belief();
  const double noise = length_deviation(belief.sensor, belief, range);
  return distance - share * drift.mean - range > sigmas * (spread + noise);
}

JointGaussian::ObservationStatus CompressedGaussian::predict_observation(
    std::size_t slot, ExpectedObservation& expected,
    const std::optional<ObservationPoint>& at) const {
  return near_.predict_observation(point(slot), expected, at);
}

void CompressedGaussian::append(const Eigen::Vector2d& detection, const Eigen::Vector2d& behind) {
  point_of_.push_back(static_cast<std::uint32_t>(near_.landmarks()));
  near_.append(detection, behind);
}

void CompressedGaussian::use_near_slots(NewPoint& point) const {
  for (NewPoint::Part& part : point.by_points) {
    assert(is_near(part.slot));
    part.slot = point_of_[part.slot];
  }
}

void CompressedGaussian::append(NewPoint point) {
  use_near_slots(point);
  point_of_.push_back(static_cast<std::uint32_t>(near_.landmarks()));
  near_.append(point);
}

void CompressedGaussian::replace(std::size_t slot, NewPoint point) {
  assert(is_near(slot));
  use_near_slots(point);
  near_.replace(point_of_[slot], point);
}

Matrix7 CompressedGaussian::covariance_with(std::size_t first, std::size_t second) const {
  assert(is_near(first) && is_near(second));
  return near_.covariance_with(point_of_[first], point_of_[second]);
}

void CompressedGaussian::make_near(std::span<const std::uint32_t> slots) {
  const bool all_near = std::ranges::all_of(slots, [&](std::uint32_t k) { return is_near(k); });
  if (!all_near || is_time_to_choose()) choose(slots);
}

// The following functions expand the map and compress it around other landmarks.

void CompressedGaussian::expand_into(MapMoments& map) const {
  if (basis_.size() > 0) write_far(map);
  write_near(map);
  mirror_packs(map.covariance, rows());
}

void CompressedGaussian::write_far(MapMoments& map) const {
  const auto W = basis_.vectors();
  const Eigen::MatrixXd Y = coefficients_of_covariance();
  Eigen::MatrixXd WY = Eigen::MatrixXd::Zero(W.rows(), W.cols());
  add_product(W, Y, Part::whole, WY);
  add_product(WY, W, Part::lower, map.covariance.topLeftCorner(W.rows(), W.rows()));
  add_combination(W, coefficients_of_mean(), map.mean.head(W.rows()));
  auto cross = map.cross.topRows(W.rows());
  cross.setZero();
  for (Eigen::Index j = 0; j < 3; ++j) {
    add_combination(W, coefficients_of_cross().col(j), cross.col(j));
  }
}

/// Writes the rows and columns of the near landmarks.
void CompressedGaussian::write_near(MapMoments& map) const {
  const MapMoments& local = near_.map();
  Columns2 column(rows(), 2);
  for (std::size_t slot = 0; slot < landmarks(); ++slot) {
    if (!is_near(slot)) continue;
    const Eigen::Index at = row_of(point_of_[slot]);
    column.setZero();
    if (basis_.size() > 0) write_cross_with_far(at, column);
    for (std::size_t other = 0; other < landmarks(); ++other) {
      if (!is_near(other)) continue;
      column.middleRows<2>(row_of(other)) =
          covariance_of(local.covariance, row_of(point_of_[other]), at);
    }
    write_columns(map.covariance, row_of(slot), rows(), column);
    map.mean.segment<2>(row_of(slot)) = local.mean.segment<2>(at);
    map.cross.middleRows<2>(row_of(slot)) = local.cross.middleRows<2>(at);
  }
}

/// Writes W X for one near point.
void CompressedGaussian::write_cross_with_far(Eigen::Index at, Columns2& column) const {
  const Eigen::MatrixXd& local = near_.map().covariance;
  const Eigen::Index k = basis_.size();
  Columns2 X(k, 2);
  if (at < stand_ins_) {
    X = local.block(stand_ins_, at, k, 2);
  } else {
    X = local.block(at, stand_ins_, 2, k).transpose();
  }
  for (Eigen::Index j = 0; j < 2; ++j) {
    add_combination(basis_.vectors(), X.col(j), column.col(j).head(basis_.vectors().rows()));
  }
}

/// Returns whether there are too many near points, or all have been near for long enough.
bool CompressedGaussian::is_time_to_choose() const {
  if (retraction_ == Retraction::left_invariant) return false;
  return is_suspended_ ? updates_ > kDetectionsUncompressed : near_.landmarks() > most_near_;
}

/// Expands the map and chooses near landmarks again.
void CompressedGaussian::choose(std::span<const std::uint32_t> wanted) {
  if (whole_.room() < rows()) whole_.make_room(std::max(2 * whole_.room(), rows()));
  expand_into(whole_);
  update_balance();
  is_suspended_ = balance_ < -kGreatestBalance;
  if (is_suspended_) {
    chosen_.resize(landmarks());
    std::iota(chosen_.begin(), chosen_.end(), 0U);
    balance_ = 0.0;
  } else {
    choose_around(wanted);
  }
  gather_near();
  span_far();
  use_landmark_stand_ins();
  note_far();
  updates_ = 0;
}

/// Updates the balance of compression since the near landmarks were chosen. Expanding a map takes
/// about as long as one detection for every row of stand-ins.
void CompressedGaussian::update_balance() {
  const double share = static_cast<double>(near_.landmarks()) / static_cast<double>(landmarks());
  const double saved = static_cast<double>(updates_) * (1.0 - share * share);
  balance_ += saved - static_cast<double>(basis_.size());
  balance_ = std::min(balance_, kGreatestBalance);
}

/// Chooses the wanted landmarks and the nearest ones to the vehicle.
void CompressedGaussian::choose_around(std::span<const std::uint32_t> wanted) {
  by_distance_.clear();
  for (std::uint32_t slot = 0; slot < landmarks(); ++slot) {
    const double x = whole_.mean(row_of(slot)) - pose().mean.x;
    const double y = whole_.mean(row_of(slot) + 1) - pose().mean.y;
    by_distance_.emplace_back(x * x + y * y, slot);
  }
  const std::size_t nearest = std::min(kNear, landmarks());
  std::ranges::nth_element(by_distance_,
                           by_distance_.begin() + static_cast<std::ptrdiff_t>(nearest));
  chosen_.assign(wanted.begin(), wanted.end());
  for (std::size_t i = 0; i < nearest; ++i) chosen_.push_back(by_distance_[i].second);
  std::ranges::sort(chosen_);
  chosen_.erase(std::unique(chosen_.begin(), chosen_.end()), chosen_.end());
}

/// Takes the columns of the near landmarks out of whole_, and gathers their own moments.
void CompressedGaussian::gather_near() {
  const Eigen::Index n = row_of(chosen_.size());
  columns_.resize(rows(), 3 + n);
  columns_.leftCols<3>() = whole_.cross.topRows(rows());
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    auto column = columns_.middleCols<2>(3 + row_of(i));
    copy_columns(whole_.covariance, row_of(chosen_[i]), rows(), column);
  }
  gathered_.make_room(n);
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const Eigen::Index from = row_of(chosen_[i]), to = row_of(i);
    gathered_.mean.segment<2>(to) = whole_.mean.segment<2>(from);
    gathered_.cross.middleRows<2>(to) = whole_.cross.middleRows<2>(from);
    gathered_.covariance.block(to, 0, 2, n) = columns_.block(from, 3, 2, n);
    columns_.middleRows<2>(from).setZero();
  }
}

/// Computes the basis of the far landmarks. Columns are scaled by standard deviations, so that
/// dropped residuals are small in each of them.
void CompressedGaussian::span_far() {
  const Eigen::Index n = row_of(chosen_.size());
  sigma_.resize(3 + n);
  sigma_ << pose().covariance.diagonal(), gathered_.covariance.diagonal().head(n);
  sigma_ = sigma_.cwiseMax(0.0).cwiseSqrt();
  for (Eigen::Index j = 0; j < sigma_.size(); ++j) {
    if (sigma_(j) == 0.0) sigma_(j) = 1.0;
    columns_.col(j) /= sigma_(j);
  }
  basis_.span(columns_, retraction_);
}

/// Replaces the map of near_ by the near landmarks and the stand-ins.
void CompressedGaussian::use_landmark_stand_ins() {
  const Eigen::Index n = row_of(chosen_.size()), k = basis_.size();
  const Eigen::MatrixXd X = basis_.coefficients() * sigma_.asDiagonal();
  MapMoments& local = near_.replace_map(chosen_.size() + static_cast<std::size_t>(k / 2));
  local.take(gathered_, n);
  local.cross.middleRows(n, k) = X.leftCols<3>();
  local.covariance.block(n, 0, k, n) = X.rightCols(n);
  local.covariance.block(0, n, n, k) = X.rightCols(n).transpose();
  stand_ins_ = n;
  most_near_ = 2 * chosen_.size() + static_cast<std::size_t>(k / 2);
}

void CompressedGaussian::note_far() {
  std::ranges::fill(point_of_, kFar);
  for (std::uint32_t i = 0; i < chosen_.size(); ++i) point_of_[chosen_[i]] = i;
  far_.resize(landmarks());
  for (std::size_t slot = 0; slot < landmarks(); ++slot) {
    const Eigen::Index row = row_of(slot);
    far_[slot] = {basis_.vectors().middleRows<2>(row).norm(),
                  whole_.covariance(row, row) + whole_.covariance(row + 1, row + 1)};
  }
}

}  // namespace montecarta::filters
