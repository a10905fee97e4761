// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/compressed_gaussian.hpp"
#include "filters/joint/products.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

// How a CompressedGaussian is expanded, and compressed around other landmarks.

namespace montecarta::filters {
namespace {

/// So many landmarks around the vehicle are near: a detection costs their square, and with more of
/// them the time is longer until another one is seen.
constexpr std::size_t kNear = 30;
/// [detections of a whole map] so much may compressing cost before the map rests, and so long.
constexpr double kPatience = 150.0;
constexpr std::size_t kRest = 5000;

}  // namespace

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

/// The near landmarks' rows and columns.
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

/// W X of one near point.
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

/// Whether the near landmarks have become too many, or have rested for long enough.
bool CompressedGaussian::is_time_to_choose() const {
  return rests_ ? updates_ > kRest : near_.landmarks() > most_near_;
}

/// Brings the map up to date and parts it anew.
void CompressedGaussian::choose(std::span<const std::uint32_t> wanted) {
  if (whole_.room() < rows()) whole_.make_room(std::max(2 * whole_.room(), rows()));
  expand_into(whole_);
  book();
  rests_ = balance_ < -kPatience;
  if (rests_) {
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

/// Books what compressing saved since the near ones were chosen, and that to expand a map takes
/// about as long as one detection for every row of stand-ins.
void CompressedGaussian::book() {
  const double share = static_cast<double>(near_.landmarks()) / static_cast<double>(landmarks());
  const double saved = static_cast<double>(updates_) * (1.0 - share * share);
  balance_ += saved - static_cast<double>(basis_.size());
  balance_ = std::min(balance_, kPatience);
}

/// Near are from now on those that are wanted and those around the vehicle.
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

/// Takes the near landmarks' columns out of whole_, and what near landmarks have of them.
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

/// In units of standard deviations, lest what is left out be small beside another column only.
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

/// Puts the near landmarks and the stand-ins in the place of the map.
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
