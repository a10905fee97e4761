// SPDX-License-Identifier: BSD-3-Clause
#include "engine/random/normals.hpp"
#include "filters/joint/joint_filters.hpp"
#include "tests/filters/default_options.hpp"
#include "tests/filters/fine_noise.hpp"
#include "tests/filters/small_world.hpp"
#include "tests/filters/told_bits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace montecarta::filters {
namespace {

using Options = std::map<std::string, std::string, std::less<>>;

const Options kAsEkfSlam{{"split_beyond_deg", "1e9"},
                         {"error", "additive"},
                         {"iterations", "0"},
                         {"motion", "linearised"}};

FilterSetup setup_of(const FilterKind& kind, const Options& options, const Belief& belief = {},
                     Association association = Association::known) {
  return {.belief = belief,
          .association = {.kind = association},
          .options = default_options(kind, options),
          .landmarks = 20};
}

/// What a filter told after each scan.
struct Told {
  std::vector<PoseMoments> pose;
  std::vector<ScanReport> report;
  std::vector<std::optional<LandmarkEstimate>> map;
};

Told told(SlamFilter& filter, const SmallWorld& world) {
  Told all;
  all.map.resize(20);
  drive_through(filter, world, {}, [&](std::size_t) {
    const PoseEstimate estimate = filter.estimate();
    all.pose.push_back(estimate.mixture ? *estimate.mixture : estimate.spread);
    all.report.push_back(filter.report());
    filter.map(all.map);
  });
  return all;
}

void expect_same_bits(const Told& a, const Told& b) {
  ASSERT_EQ(a.pose.size(), b.pose.size());
  for (std::size_t s = 0; s < a.pose.size(); ++s) {
    EXPECT_EQ(boxminus(a.pose[s].mean, b.pose[s].mean).norm(), 0.0) << "scan " << s;
    EXPECT_EQ(a.pose[s].covariance, b.pose[s].covariance) << "scan " << s;
    // Sums over equal particles.
    EXPECT_NEAR(a.report[s].log_likelihood, b.report[s].log_likelihood, 1e-12) << "scan " << s;
    EXPECT_NEAR(a.report[s].nis, b.report[s].nis, 1e-12 * (1.0 + b.report[s].nis)) << "scan " << s;
  }
  for (std::size_t k = 0; k < a.map.size(); ++k) {
    ASSERT_EQ(a.map[k].has_value(), b.map[k].has_value()) << "landmark " << k;
    if (!a.map[k]) continue;
    EXPECT_EQ(a.map[k]->mean, b.map[k]->mean) << "landmark " << k;
    EXPECT_EQ(a.map[k]->covariance, b.map[k]->covariance) << "landmark " << k;
  }
}

TEST(Hrb, ThatNeverSplitsIsEkfSlamBitForBit) {
  const SmallWorld world = small_world({.seed = 21, .scans = 200});
  for (const auto association : {Association::known, Association::nearest}) {
    const Told one = told(*make_ekf_slam(setup_of(ekf_slam_kind(), {}, {}, association)), world);
    for (const char* particles : {"1", "7", "30"}) {
      Options options = kAsEkfSlam;
      options["particles"] = particles;
      const auto bank = make_hrb(setup_of(hrb_kind(), options, {}, association));
      expect_same_bits(told(*bank, world), one);
    }
  }
}

TEST(Hrb, ThatNeverSplitsIsRightInvariantEkfSlamBitForBit) {
  const SmallWorld world = small_world({.seed = 22, .scans = 200});
  const Options likewise{{"iterations", "2"}, {"motion", "quadrature"}};
  const auto one = make_riekf_slam(setup_of(riekf_slam_kind(), likewise));
  Options options = likewise;
  options["particles"] = "7";
  options["split_beyond_deg"] = "1e9";
  expect_same_bits(told(*make_hrb(setup_of(hrb_kind(), options)), world), told(*one, world));
}

TEST(Hrb, ManySplitsOfALinearModelAreTheKalmanFilter) {
  const SmallWorld world = small_world({.seed = 23, .scans = 25, .noise = fine()});
  const Told kalman = told(*make_ekf_slam(setup_of(ekf_slam_kind(), {}, fine())), world);
  for (const char* keep : {"0", "0.7"}) {
    Options options = kAsEkfSlam;
    options["split_beyond_deg"] = "1e-9";  // at every scan
    options["particles"] = "4000";
    options["keep"] = keep;
    const Told bank = told(*make_hrb(setup_of(hrb_kind(), options, fine())), world);
    for (std::size_t s = 0; s < kalman.pose.size(); ++s) {
      const Eigen::Vector3d sigma = kalman.pose[s].covariance.diagonal().cwiseSqrt();
      const double particles = bank.report[s].ess;
      const Eigen::Vector3d away = boxminus(bank.pose[s].mean, kalman.pose[s].mean);
      const Eigen::Vector3d spread = bank.pose[s].covariance.diagonal().cwiseSqrt();
      for (int k = 0; k < 3; ++k) {
        // Genealogies join, so that particles count for less than their number: a third of it.
        EXPECT_LT(std::abs(away(k)), 5.0 * sigma(k) / std::sqrt(particles / 3.0))
            << "scan " << s << ", " << k << ", keep " << keep;
        EXPECT_NEAR(spread(k) / sigma(k), 1.0, 5.0 / std::sqrt(2.0 * particles / 3.0))
            << "scan " << s << ", " << k << ", keep " << keep;
      }
    }
  }
}

/// Headings of the particles, in increasing order.
std::vector<double> headings(const SlamFilter& filter, std::size_t particles) {
  std::vector<double> poses(3 * particles), all(particles);
  filter.particles({poses, {}, {}});
  for (std::size_t i = 0; i < particles; ++i) all[i] = poses[3 * i + 2];
  std::ranges::sort(all);
  return all;
}

TEST(Hrb, SplitsAsEvenlyAsTheNormalDistributionIs) {
  constexpr std::size_t kParticles = 40;
  Options options = kAsEkfSlam;
  options["split_beyond_deg"] = "0.01";
  options["particles"] = std::to_string(kParticles);
  options["keep"] = "0";
  const auto bank = make_hrb(setup_of(hrb_kind(), options));
  const StepContext context(5, 0, 0, Parallel::serial());
  bank->start({});
  bank->predict(context, {3.0, 0.1}, 0.2);
  const PoseMoments before = bank->estimate().mixture.value();
  bank->update(context, std::vector<Detection>{{10.0, 0.2, 0}});
  const std::vector<double> drawn = headings(*bank, kParticles);
  const double sigma = std::sqrt(before.covariance(2, 2));
  for (std::size_t i = 0; i < kParticles; ++i) {
    const double z = (drawn[i] - before.mean.heading) / sigma;
    const double below = 0.5 * std::erfc(-z / std::sqrt(2.0));
    EXPECT_GT(below, static_cast<double>(i) / kParticles);
    EXPECT_LT(below, static_cast<double>(i + 1) / kParticles);
  }
}

TEST(Hrb, LeavesTheShareOfTheHeadingThatItIsToldToKeep) {
  for (const double keep : {0.0, 0.5, 0.85}) {
    Options options{
        {"split_beyond_deg", "0.01"}, {"particles", "1"}, {"keep", std::to_string(keep)}};
    const auto bank = make_hrb(setup_of(hrb_kind(), options));
    const StepContext context(6, 0, 0, Parallel::serial());
    bank->start({});
    bank->predict(context, {3.0, 0.1}, 0.2);
    const double before = bank->estimate().mixture->covariance(2, 2);
    bank->update(context, std::vector<Detection>{{10.0, 0.2, 0}});
    bank->predict(context, {0.0, 0.0}, 0.0);  // no motion: what the draw left
    const double after = bank->estimate().mixture->covariance(2, 2);
    EXPECT_NEAR(after, keep * keep * before, 1e-12 * before) << keep;
  }
}

TEST(Hrb, SplitsBySizeWhereATurnBendsTheMapByMoreThanTheSensorErrs) {
  // sigma^2 D / 2 against sigma_range = 0.1 m, sigma = 2.9 degrees after 2 s: at D = 120 m only.
  for (const auto& [distance, splits] : {std::pair{120.0, true}, std::pair{20.0, false}}) {
    const auto bank = make_hrb(setup_of(hrb_kind(), {}, {.control = {.sigma = {0.3, 0.3}}}));
    const StepContext context(7, 0, 0, Parallel::serial());
    bank->start({});
    for (int step = 0; step < 80; ++step) bank->predict(context, {3.0, 0.0}, 0.025);
    const double sigma = std::sqrt(bank->estimate().mixture->covariance(2, 2));
    ASSERT_LT(0.5 * sigma * sigma * 20.0, 0.1);
    ASSERT_GT(0.5 * sigma * sigma * 110.0, 0.1);
    bank->update(context, std::vector<Detection>{{distance, 0.0, 0}});
    bank->predict(context, {0.0, 0.0}, 0.0);
    bank->update(context, std::vector<Detection>{{distance, 0.0, 0}});
    const std::vector<double> drawn = headings(*bank, 30);
    EXPECT_EQ(drawn.back() > drawn.front(), splits) << distance;
  }
}

}  // namespace
}  // namespace montecarta::filters
