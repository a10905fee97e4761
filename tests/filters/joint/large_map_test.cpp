// SPDX-License-Identifier: BSD-3-Clause
// Laws of whole filters on a map so large that most of it is compressed.
#include "filters/joint/joint_filter.hpp"
#include "filters/joint/joint_gaussian.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {
namespace {

constexpr std::size_t kLandmarks = 300;

/// A vehicle that goes round once and a half, of which it sees a twentieth at a time.
SmallWorldSettings large_world(const Belief& noise = {}) {
  return {.seed = 41, .landmarks = kLandmarks, .scans = 430, .max_range = 11.0, .noise = noise};
}

/// EKF-SLAM with known association on one JointGaussian that is never compressed.
struct Plain {
  JointGaussian gaussian{Belief{}, Retraction::additive, kLandmarks};
  MotionIncrement motion;
  std::vector<std::int32_t> identities;  ///< {slot}

  void start(const Pose& pose) { gaussian.start(pose); }
  void predict(const StepContext&, const Control& control, double duration) {
    motion.advance(control, duration, Belief{});
  }
  void update(const StepContext&, Scan scan) {
    gaussian.move(motion);
    motion.restart();
    const std::size_t known = identities.size();
    for (const Detection& detection : scan) {
      const std::size_t slot = slot_of(detection.identity);
      ExpectedObservation expected;
      if (slot == known) continue;
      ASSERT_EQ(gaussian.predict_observation(slot, expected),
                JointGaussian::ObservationStatus::usable);
      EXPECT_EQ(gaussian.update_with(slot, vector_of(detection), 0, expected),
                JointGaussian::ObservationStatus::usable);
    }
    for (const Detection& detection : scan) {
      if (std::ranges::find(identities, detection.identity) != identities.end()) continue;
      gaussian.append(vector_of(detection));
      identities.push_back(detection.identity);
    }
  }
  std::size_t slot_of(std::int32_t identity) const {
    return static_cast<std::size_t>(std::ranges::find(identities, identity) - identities.begin());
  }
};

TEST(LargeMap, OfEkfSlamEqualsThatOfOnePlainGaussian) {
  const SmallWorld world = small_world(large_world());
  Plain plain;
  std::vector<PoseMoments> poses;
  drive_through(plain, world, {}, [&](std::size_t) { poses.push_back(plain.gaussian.pose()); });
  ASSERT_GT(plain.identities.size(), 190u);
  const auto filter = make_filter(ekf_slam_kind(), large_world());
  std::optional<JointEstimate> joint;
  drive_through(*filter, world, {}, [&](std::size_t s) {
    const PoseMoments pose = filter->estimate().spread;
    EXPECT_LT(boxminus(pose.mean, poses[s].mean).norm(), 1e-9) << "scan " << s;
    EXPECT_TRUE(pose.covariance.isApprox(poses[s].covariance, 1e-9)) << "scan " << s;
    joint = filter->joint(kLandmarks);
  });
  std::vector<Eigen::Index> rows = {0, 1, 2}, plain_rows = {0, 1, 2};
  for (std::size_t slot = 0; slot < plain.identities.size(); ++slot) {
    for (const Eigen::Index coordinate : {0, 1}) {
      rows.push_back(3 + 2 * plain.identities[slot] + coordinate);
      plain_rows.push_back(3 + 2 * static_cast<Eigen::Index>(slot) + coordinate);
    }
  }
  const auto n = static_cast<Eigen::Index>(rows.size() - 3);
  const MapMoments& map = plain.gaussian.map();
  EXPECT_LT((joint->mean(rows).tail(n) - map.mean.head(n)).norm(), 1e-8);
  const Eigen::MatrixXd P = joint->covariance(rows, rows);
  EXPECT_TRUE(P.bottomLeftCorner(n, 3).isApprox(map.cross.topRows(n), 1e-8));
  const Eigen::MatrixXd lower = map.covariance.topLeftCorner(n, n).triangularView<Eigen::Lower>();
  const Eigen::MatrixXd ours = P.bottomRightCorner(n, n).triangularView<Eigen::Lower>();
  EXPECT_TRUE(ours.isApprox(lower, 1e-8));
}

TEST(LargeMap, IsSearchedAsIfNobodyHadCompressedIt) {
  const SmallWorldSettings settings = large_world(fine());
  const SmallWorld world = small_world(settings);
  const auto knowing = make_filter(ekf_slam_kind(), settings);
  const auto expected = estimates_of(*knowing, world);
  const auto searching = make_filter(ekf_slam_kind(), settings, {}, Association::nearest);
  double wrong = 0.0;
  drive_through(*searching, world, {}, [&](std::size_t s) {
    wrong += searching->report().association.wrong + searching->report().association.new_again;
    EXPECT_LT(boxminus(searching->estimate().spread.mean, expected[s].mean).norm(), 0.01)
        << "scan " << s << ": one detection in twenty lies outside the gate";
  });
  EXPECT_EQ(wrong, 0.0) << "landmarks lie far apart in this noise";
  EXPECT_GT(searching->report().map_size, 190.0);
}

}  // namespace
}  // namespace montecarta::filters
