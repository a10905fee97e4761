// SPDX-License-Identifier: BSD-3-Clause
#include "filters/marginal/marginal_filters.hpp"
#include "tests/filters/reference/marginal.hpp"
#include "tests/filters/small_world.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace montecarta {
namespace {

using Texts = std::map<std::string, std::string, std::less<>>;

/// A filter with some of its options changed.
struct Variant {
  std::string filter;
  Texts changed;
  Association association = Association::known;

  Choice choice() const { return filter == "marginal" ? Choice::by_weight : Choice::by_likelihood; }
  FilterOptions options() const {
    Texts values;
    for (const FilterOption& option : marginal_options(MapSolver::gauss_newton))
      values[option.name] = option.fallback;
    values["particles"] = "13";  // not a multiple of the lanes
    for (const auto& [name, value] : changed) values[name] = value;
    return FilterOptions(values);
  }
  friend std::ostream& operator<<(std::ostream& out, const Variant& v) {
    out << v.filter;
    for (const auto& [name, value] : v.changed) out << '_' << name << '_' << value;
    return out << (v.association == Association::nearest ? "_nearest" : "");
  }
};

template <class Real>
std::unique_ptr<SlamFilter> make(const Variant& v, const SmallWorldSettings& world) {
  return std::make_unique<MarginalFilter<Real>>(FilterSetup{.belief = world.noise,
                                                            .association = {.kind = v.association},
                                                            .options = v.options(),
                                                            .landmarks = world.landmarks},
                                                marginal_settings(v.options(), v.choice()));
}

struct Cloud {
  std::vector<double> poses, log_weights;
  std::vector<std::uint32_t> ancestors;
  std::vector<std::optional<LandmarkEstimate>> map;
  ScanReport report;

  Cloud(const SlamFilter& filter, std::size_t n, std::size_t landmarks)
      : poses(3 * n), log_weights(n), ancestors(n), map(landmarks), report(filter.report()) {
    filter.particles({poses, log_weights, ancestors});
    filter.map(map);
  }
};

/// |a - b| < tolerance (1 + |b|).
void expect_close(double a, double b, double tolerance, const char* what) {
  EXPECT_NEAR(a, b, tolerance * (1.0 + std::abs(b))) << what;
}

void expect_same(const Cloud& a, const Cloud& b, double tolerance) {
  EXPECT_EQ(a.ancestors, b.ancestors);
  for (std::size_t k = 0; k < a.poses.size(); ++k)
    expect_close(a.poses[k], b.poses[k], tolerance, "pose");
  for (std::size_t i = 0; i < a.log_weights.size(); ++i)
    expect_close(a.log_weights[i], b.log_weights[i], 1e3 * tolerance, "log-weight");
  expect_close(a.report.log_likelihood, b.report.log_likelihood, 1e3 * tolerance, "likelihood");
  expect_close(a.report.nis, b.report.nis, 1e3 * tolerance, "nis");
  for (std::size_t k = 0; k < a.map.size(); ++k) {
    ASSERT_EQ(a.map[k].has_value(), b.map[k].has_value());
    if (!a.map[k]) continue;
    EXPECT_LT((a.map[k]->mean - b.map[k]->mean).norm(), 1e2 * tolerance);
    EXPECT_LT((a.map[k]->covariance - b.map[k]->covariance).norm(), 1e2 * tolerance);
  }
}

class Marginals : public testing::TestWithParam<Variant> {};

TEST_P(Marginals, LanesEqualOneParticleAtATime) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto lanes = make<Lanes>(GetParam(), settings);
  const auto single = make<double>(GetParam(), settings);
  std::vector<Cloud> clouds;
  drive_through(*lanes, world, Pose(),
                [&](std::size_t) { clouds.emplace_back(*lanes, 13, settings.landmarks); });
  drive_through(*single, world, Pose(), [&](std::size_t scan) {
    expect_same(clouds[scan], Cloud(*single, 13, settings.landmarks), 1e-12);
  });
}

TEST_P(Marginals, FollowTheTruth) {
  const SmallWorldSettings settings;
  const SmallWorld world = small_world(settings);
  const auto filter = make<Lanes>(GetParam(), settings);
  drive_through(*filter, world, Pose(), [&](std::size_t scan) {
    const Pose& truth = world.drive.truth[world.itinerary.scan_step[scan]];
    EXPECT_LT(boxminus(filter->estimate().spread.mean, truth).norm(), 2.5) << "scan " << scan;
  });
}

INSTANTIATE_TEST_SUITE_P(
    All, Marginals,
    testing::Values(Variant{"marginal", {}}, Variant{"marginal", {{"kernel", "posterior"}}},
                    Variant{"ampf_de", {}}, Variant{"ampf_de", {{"kernel", "posterior"}}},
                    Variant{"ampf_de", {{"map_solver", "de"}}},
                    Variant{"ampf_de", {{"map_solver", "de"}, {"base", "best"}}},
                    Variant{"ampf_de", {{"map_solver", "de"}, {"map", "onestep_threshold"}}},
                    Variant{"ampf_de",
                            {{"map_solver", "de"},
                             {"map", "onestep_converged"},
                             {"map_objective", "squares_as_printed"}}},
                    Variant{"ampf_de", {{"map_solver", "de"}}, Association::nearest},
                    Variant{"marginal", {}, Association::nearest}),
    [](const auto& instance) { return "v" + std::to_string(instance.index); });

/// Plain Eigen beside production, scan by scan.
void expect_reference(const Variant& v, double tolerance) {
  const SmallWorldSettings settings{.scans = 25};
  const SmallWorld world = small_world(settings);
  const auto filter = make<Lanes>(v, settings);
  reference::Marginal plain(marginal_settings(v.options(), v.choice()), settings.noise,
                            settings.landmarks);
  std::vector<Cloud> clouds;
  drive_through(*filter, world, Pose(),
                [&](std::size_t) { clouds.emplace_back(*filter, 13, settings.landmarks); });
  drive_through(plain, world, Pose(), [&](std::size_t scan) {
    const Cloud& cloud = clouds[scan];
    ASSERT_EQ(cloud.ancestors, plain.ancestor) << "scan " << scan;
    for (std::size_t i = 0; i < 13; ++i) {
      for (std::size_t k = 0; k < 3; ++k)
        expect_close(cloud.poses[3 * i + k], plain.pose[i](static_cast<Eigen::Index>(k)), tolerance,
                     "pose");
      expect_close(std::exp(cloud.log_weights[i]), plain.weight[i], 1e3 * tolerance, "weight");
    }
    expect_close(cloud.report.log_likelihood, plain.log_evidence, 1e4 * tolerance, "likelihood");
    for (std::size_t k = 0; k < settings.landmarks; ++k) {
      ASSERT_EQ(cloud.map[k].has_value(), plain.map()[k].has_value());
      if (!cloud.map[k]) continue;
      EXPECT_LT((cloud.map[k]->mean - plain.map()[k]->mean).norm(), 1e2 * tolerance);
      EXPECT_LT((cloud.map[k]->covariance - plain.map()[k]->covariance).norm(), 1e2 * tolerance);
    }
  });
}

TEST(MarginalReference, EqualsPlainEigen) {
  expect_reference({"marginal", {}}, 1e-12);
  expect_reference({"marginal", {{"kernel", "posterior"}}}, 1e-12);
  expect_reference({"ampf_de", {}}, 1e-12);
  expect_reference({"ampf_de", {{"kernel", "posterior"}}}, 1e-12);
  expect_reference({"ampf_de", {{"map", "onestep_converged"}, {"map_objective", "squares"}}},
                   1e-12);
  expect_reference(
      {"ampf_de", {{"map", "onestep_threshold"}, {"map_objective", "squares_as_printed"}}}, 1e-12);
}

}  // namespace
}  // namespace montecarta
