// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/compressed_gaussian.hpp"

#include "engine/random/stream.hpp"
#include "tests/filters/small_world.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {
namespace {

/// A setting in which the two forms are compared.
struct Setting {
  Retraction retraction;
  int iterations;
};

constexpr std::size_t kLandmarks = 150;
/// Largest relative difference of the covariances, which is due to rounding.
constexpr double kRounding = 1e-9;

/// A vehicle that goes round a map twice, of which it sees a twentieth at a time.
SmallWorld large_world(std::size_t scans = 570) {
  return small_world({.seed = 31, .landmarks = kLandmarks, .scans = scans, .max_range = 11.0});
}

/// A Gaussian that is driven as a belief drives it, with known association.
template <class Gaussian>
class Driven {
 public:
  explicit Driven(const Setting& setting)
      : gaussian(Belief{}, setting.retraction, 10), setting_(setting) {
    gaussian.start({});
  }

  void drive(const SmallWorld& world, std::size_t scan) {
    MotionIncrement motion;
    for (std::size_t step = 8 * scan; step < 8 * (scan + 1); ++step) {
      motion.advance(world.drive.controls[step], world.itinerary.duration(step), Belief{});
    }
    gaussian.move(motion);
    const Scan detections = world.drive.scan(scan);
    if constexpr (requires { gaussian.make_near({}); }) gaussian.make_near(slots_in(detections));
    for (const Detection& detection : detections) update_with(detection);
    for (const Detection& detection : detections) initialise_landmarks(detection);
  }

  Gaussian gaussian;

 private:
  static constexpr std::uint32_t kUnseen = 9999;

  std::vector<std::uint32_t> slots_in(Scan scan) const {
    std::vector<std::uint32_t> slots;
    for (const Detection& detection : scan) {
      const std::uint32_t slot = slot_of_[static_cast<std::size_t>(detection.identity)];
      if (slot != kUnseen) slots.push_back(slot);
    }
    return slots;
  }

  void update_with(const Detection& detection) {
    const std::uint32_t slot = slot_of_[static_cast<std::size_t>(detection.identity)];
    ExpectedObservation expected;
    if (slot == kUnseen) return;
    if (gaussian.predict_observation(slot, expected) != JointGaussian::ObservationStatus::usable)
      return;
    gaussian.update_with(slot, vector_of(detection), setting_.iterations, expected);
  }

  void initialise_landmarks(const Detection& detection) {
    std::uint32_t& slot = slot_of_[static_cast<std::size_t>(detection.identity)];
    if (slot != kUnseen) return;
    slot = static_cast<std::uint32_t>(gaussian.landmarks());
    gaussian.append(vector_of(detection));
  }

  Setting setting_;
  std::vector<std::uint32_t> slot_of_ = std::vector<std::uint32_t>(kLandmarks, kUnseen);
};

void expect_equal_poses(const PoseMoments& a, const PoseMoments& b, std::size_t scan) {
  EXPECT_LT(boxminus(a.mean, b.mean).norm(), kRounding) << "scan " << scan;
  EXPECT_LT((a.covariance - b.covariance).norm(), kRounding * a.covariance.norm())
      << "scan " << scan;
}

/// Landmark by landmark, and the whole.
void expect_equal_maps(const JointGaussian& plain, const CompressedGaussian& compressed) {
  ASSERT_EQ(plain.landmarks(), compressed.landmarks());
  const MapMoments whole = compressed.map();
  for (std::size_t slot = 0; slot < plain.landmarks(); ++slot) {
    const PointMoments a = plain.point(slot), b = compressed.point(slot);
    EXPECT_LT((a.mean - b.mean).norm(), kRounding) << "landmark " << slot;
    EXPECT_LT((a.covariance - b.covariance).norm(), kRounding * a.covariance.norm());
    EXPECT_EQ(b.covariance, b.covariance.transpose());
    ExpectedObservation one, other;
    ASSERT_EQ(plain.predict_observation(slot, one), compressed.predict_observation(slot, other));
    EXPECT_NEAR(one.factor.log_det(), other.factor.log_det(), kRounding) << "landmark " << slot;
  }
  const Eigen::Index rows = 2 * static_cast<Eigen::Index>(plain.landmarks());
  const Eigen::MatrixXd P = plain.map().covariance.topLeftCorner(rows, rows);
  const Eigen::MatrixXd Q = whole.covariance.topLeftCorner(rows, rows);
  const Eigen::MatrixXd away = (P - Q).triangularView<Eigen::Lower>();
  EXPECT_LT(away.cwiseAbs().maxCoeff(), kRounding * P.diagonal().maxCoeff());
  EXPECT_LT((plain.map().mean.head(rows) - whole.mean.head(rows)).norm(), kRounding);
  EXPECT_LT((plain.map().cross.topRows(rows) - whole.cross.topRows(rows)).norm(),
            kRounding * plain.map().cross.norm());
}

class CompressedAndPlain : public testing::TestWithParam<Setting> {};

TEST_P(CompressedAndPlain, AreEqualOverALoop) {
  const SmallWorld world = large_world();
  Driven<JointGaussian> plain(GetParam());
  Driven<CompressedGaussian> compressed(GetParam());
  std::vector<char> was_far(kLandmarks, false);
  std::size_t far_at_most = 0, came_back = 0;
  for (std::size_t scan = 0; scan < world.itinerary.scans(); ++scan) {
    plain.drive(world, scan);
    compressed.drive(world, scan);
    expect_equal_poses(plain.gaussian.pose(), compressed.gaussian.pose(), scan);
    if (scan % 60 == 59) expect_equal_maps(plain.gaussian, compressed.gaussian);
    std::size_t far = 0;
    for (std::size_t slot = 0; slot < compressed.gaussian.landmarks(); ++slot) {
      const bool is_far = !compressed.gaussian.is_near(slot);
      far += is_far ? 1 : 0;
      came_back += was_far[slot] && !is_far ? 1 : 0;
      was_far[slot] = is_far;
    }
    far_at_most = std::max(far_at_most, far);
  }
  EXPECT_GT(far_at_most, 80u) << "hardly compressed: no test";
  EXPECT_GT(came_back, 100u) << "hardly expanded: no test";
}

INSTANTIATE_TEST_SUITE_P(BothErrors, CompressedAndPlain,
                         testing::Values(Setting{Retraction::additive, 0},
                                         Setting{Retraction::additive, 3},
                                         Setting{Retraction::right_invariant, 0},
                                         Setting{Retraction::right_invariant, 5}));

TEST(CompressedGaussian, ARestartLeavesNothingBehind) {
  const SmallWorld world = large_world(400);
  const Setting setting{Retraction::additive, 0};
  Driven<CompressedGaussian> fresh(setting), restarted(setting);
  for (std::size_t scan = 0; scan < 400; ++scan) fresh.drive(world, scan);
  restarted.gaussian = fresh.gaussian;
  restarted.gaussian.start({});
  for (std::size_t scan = 0; scan < 400; ++scan) restarted.drive(world, scan);
  EXPECT_EQ(restarted.gaussian.pose().covariance, fresh.gaussian.pose().covariance);
  EXPECT_EQ(restarted.gaussian.landmark(7).covariance, fresh.gaussian.landmark(7).covariance);
}

std::size_t first_far(const CompressedGaussian& gaussian) {
  std::size_t slot = 0;
  while (slot < gaussian.landmarks() && gaussian.is_near(slot)) ++slot;
  return slot;
}

TEST(CompressedGaussian, IsNotUsedWhereItSavesNothing) {
  const SmallWorld world = large_world(340);
  Driven<CompressedGaussian> driven({Retraction::right_invariant, 0});
  for (std::size_t scan = 0; scan < 340; ++scan) driven.drive(world, scan);
  CompressedGaussian& gaussian = driven.gaussian;
  ASSERT_LT(first_far(gaussian), gaussian.landmarks());
  const MapMoments before = gaussian.map();
  for (int look = 0; look < 20 && first_far(gaussian) < gaussian.landmarks(); ++look) {
    const auto slot = static_cast<std::uint32_t>(first_far(gaussian));
    gaussian.make_near(std::span(&slot, 1));  // one after the other, and nothing is learnt
  }
  ASSERT_EQ(first_far(gaussian), gaussian.landmarks());
  const MapMoments after = gaussian.map();
  EXPECT_LT((after.mean - before.mean).norm(), kRounding);
  EXPECT_LT((after.covariance - before.covariance).norm(), kRounding);
  ExpectedObservation expected;
  for (int look = 0; look < 6000; ++look) {
    ASSERT_EQ(gaussian.predict_observation(0, expected), JointGaussian::ObservationStatus::usable);
    gaussian.update_with(0, expected.observation, 0, expected);
  }
  gaussian.make_near({});
  EXPECT_LT(first_far(gaussian), gaussian.landmarks());
}

TEST(CompressedGaussian, KeepsAllLandmarksNearForTheLeftInvariantError) {
  const SmallWorld world = large_world(340);
  Driven<CompressedGaussian> driven({Retraction::left_invariant, 0});
  for (std::size_t scan = 0; scan < 340; ++scan) driven.drive(world, scan);
  ASSERT_GT(driven.gaussian.landmarks(), 100u);
  EXPECT_EQ(first_far(driven.gaussian), driven.gaussian.landmarks());
}

TEST(CompressedGaussian, WhatIsOutOfReachIsBeyondTheGate) {
  const SmallWorld world = large_world(420);
  for (const auto retraction : {Retraction::additive, Retraction::right_invariant}) {
    Driven<CompressedGaussian> driven({retraction, 0});
    std::size_t out = 0, looked_at = 0;
    constexpr double kRange = 11.0, kSigmas = 5.0;
    for (std::size_t scan = 0; scan < 420; ++scan) {
      driven.drive(world, scan);
      if (scan < 300) continue;
      const CompressedGaussian& gaussian = driven.gaussian;
      const auto drift = gaussian.drift();
      for (std::size_t slot = 0; slot < gaussian.landmarks(); ++slot) {
        if (gaussian.is_near(slot)) continue;
        ++looked_at;
        if (!gaussian.is_out_of_reach(slot, drift, kRange, kSigmas)) continue;
        ++out;
        ExpectedObservation expected;
        ASSERT_EQ(gaussian.predict_observation(slot, expected),
                  JointGaussian::ObservationStatus::usable);
        const Eigen::Vector2d nearest{kRange, expected.observation(1)};
        EXPECT_GT(expected.factor.whiten(expected.innovation(nearest)).norm(), kSigmas);
      }
    }
    EXPECT_GT(out, looked_at / 2) << "a bound that leaves out too little";
  }
}

TEST(Basis, SpansItsColumnsAndTurnsWithThem) {
  RngStream draw({.seed = 3, .purpose = Draw::test});
  Eigen::MatrixXd columns(40, 9);
  for (double& number : columns.reshaped()) number = draw.normal();
  columns.col(4) = columns.col(2) - 3.0 * columns.col(7);
  const Eigen::MatrixXd before = columns;
  for (const auto& [retraction, size] :
       {std::pair{Retraction::additive, 8}, std::pair{Retraction::right_invariant, 16}}) {
    columns = before;
    Basis basis;
    basis.span(columns, retraction);
    ASSERT_EQ(basis.size(), size);
    const Eigen::MatrixXd Q = basis.vectors();
    EXPECT_LT((Q.transpose() * Q - Eigen::MatrixXd::Identity(size, size)).norm(), 1e-12);
    EXPECT_LT((Q * basis.coefficients() - before).norm(), 1e-12);
    if (retraction == Retraction::additive) continue;
    Eigen::MatrixXd turned = before, coefficients = basis.coefficients();
    for (auto column : turned.colwise()) apply(quarter_turn(), column.reshaped(2, 20));
    for (auto column : coefficients.colwise()) apply(quarter_turn(), column.reshaped(2, 8));
    EXPECT_LT((Q * coefficients - turned).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace montecarta::filters
