// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/cramer_rao.hpp"

#include "analysis/run/simulated_world.hpp"
#include "analysis/study/efficiency.hpp"
#include "analysis/study/study_analysis.hpp"
#include "filters/models/ackermann.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/filters/some_models.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::analysis {
namespace {

constexpr double kStep = 0.1;  // [s]

using Landmarks = std::vector<Eigen::Vector2d>;

SimulatedWorld open_world() {
  return {.vehicle = Car{.wheelbase = 2.0},
          .control_noise = {.sigma = {0.3, 0.05}},
          .sigma_observation = {0.1, 0.02},
          .detected = 1.0,
          .view = FieldOfView(50.0, kPi),
          .same_path = true};
}

/// A path under these controls, with a scan after every `every`-th step.
TruePath path_of(const std::vector<Control>& controls, std::size_t every, Landmarks landmarks,
                 const Vehicle& vehicle = open_world().vehicle) {
  TruePath path;
  path.landmarks = std::move(landmarks);
  Pose pose = path.start;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    pose = move(pose, controls[k], kStep, vehicle);
    path.rows.push_back(pose);
    path.steps.push_back(1);
    path.durations.push_back(kStep);
    if ((k + 1) % every == 0) path.scan_rows.push_back(static_cast<std::uint32_t>(k));
  }
  return path;
}

std::vector<Control> bends(std::size_t n, double phase = 0.4) {
  std::vector<Control> controls;
  for (std::size_t k = 0; k < n; ++k) {
    controls.push_back({3.0, 0.2 * std::sin(phase * static_cast<double>(k))});
  }
  return controls;
}

/// All that a run says, as a function of all that is unknown: the errors of the controls, the
/// observations of each scan, and the pose at the end, for controls and landmarks moved by
/// `unknown`.
struct Trajectory {
  const SimulatedWorld* world;
  const Landmarks* landmarks;
  const std::vector<Control>* controls;
  std::size_t every;
  Pose end(const Eigen::VectorXd& unknown, std::vector<double>* observations) const {
    const Eigen::Vector3d start =
        world->prior ? Eigen::Vector3d(unknown.tail<3>()) : Eigen::Vector3d::Zero();
    Pose pose{start(0), start(1), start(2)};
    const auto n = static_cast<Eigen::Index>(controls->size());
    for (Eigen::Index k = 0; k < n; ++k) {
      const Control& control = (*controls)[static_cast<std::size_t>(k)];
      pose = move(pose, {control[0] + unknown(2 * k), control[1] + unknown(2 * k + 1)}, kStep,
                  world->vehicle);
      if (static_cast<std::size_t>(k + 1) % every != 0 || observations == nullptr) continue;
      for (Eigen::Index l = 0; l < static_cast<Eigen::Index>(landmarks->size()); ++l) {
        const Eigen::Vector2d at =
            (*landmarks)[static_cast<std::size_t>(l)] + unknown.segment<2>(2 * (n + l));
        const auto seen = linearised_detection(world->sensor, pose, Point{at.x(), at.y()});
        const Eigen::Vector2d weighed = seen->value.cwiseQuotient(world->sigma_observation);
        observations->insert(observations->end(), weighed.begin(), weighed.end());
      }
    }
    return pose;
  }
};

/// The bound by the joint information matrix of the whole trajectory, derivatives by differences.
Eigen::Matrix3d reference(const SimulatedWorld& world, const Landmarks& landmarks,
                          const std::vector<Control>& controls, std::size_t every) {
  const Trajectory trajectory{&world, &landmarks, &controls, every};
  const auto n =
      static_cast<Eigen::Index>(2 * (controls.size() + landmarks.size()) + (world.prior ? 3 : 0));
  std::vector<double> once;
  trajectory.end(Eigen::VectorXd::Zero(n), &once);
  Eigen::MatrixXd H(once.size(), n);
  Eigen::Matrix3Xd G(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double h = 1e-5;
    std::vector<double> more, less;
    const Pose ahead = trajectory.end(h * Eigen::VectorXd::Unit(n, i), &more);
    const Pose behind = trajectory.end(-h * Eigen::VectorXd::Unit(n, i), &less);
    G.col(i) = boxminus(ahead, behind) / (2.0 * h);
    for (std::size_t s = 0; s < more.size(); ++s) {
      H(static_cast<Eigen::Index>(s), i) = (more[s] - less[s]) / (2.0 * h);
    }
  }
  Eigen::MatrixXd information = H.transpose() * H;
  for (std::size_t k = 0; k < controls.size(); ++k) {
    const auto deviations = deviations_of(world.control_noise, controls[k], world.vehicle);
    for (Eigen::Index c = 0; c < 2; ++c) {
      const auto i = 2 * static_cast<Eigen::Index>(k) + c;
      const double sigma = deviations[static_cast<std::size_t>(c)];
      information(i, i) += 1.0 / (sigma * sigma);
    }
  }
  if (world.prior) {
    const Eigen::Index l = 2 * static_cast<Eigen::Index>(controls.size()), m = n - 3 - l;
    information.diagonal().segment(l, m).array() += std::pow(world.prior->landmark, -2);
    information.diagonal().tail<3>() += world.prior->start_covariance().diagonal().cwiseInverse();
  }
  return G * information.ldlt().solve(G.transpose());
}

const Landmarks kAhead = {{30, 3}, {31, -6}, {40, 12}};  // always in view

/// Compares from the first scan on after which all landmarks are fixed.
void expect_information_of_trajectory(const SimulatedWorld& world, std::size_t first = 0,
                                      double tolerance = 1e-5) {
  const std::vector<Control> controls = bends(24);
  const CramerRaoBound bound = squared_bound(world, path_of(controls, 4, kAhead, world.vehicle));
  ASSERT_EQ(bound.position.size(), 6u);
  for (std::size_t s = first; s < 6; ++s) {
    const std::vector<Control> until(controls.begin(),
                                     controls.begin() + static_cast<std::ptrdiff_t>(4 * (s + 1)));
    const Eigen::Matrix3d P = reference(world, kAhead, until, 4);
    EXPECT_NEAR(bound.position[s] / (P(0, 0) + P(1, 1)), 1.0, tolerance) << "scan " << s;
    EXPECT_NEAR(bound.heading[s] / P(2, 2), 1.0, tolerance) << "scan " << s;
  }
}

TEST(CramerRaoBound, IsThatOfTheJointInformationOfTheWholeTrajectoryOfACarAndARobot) {
  expect_information_of_trajectory(open_world());
  SimulatedWorld world = open_world();
  world.vehicle = DifferentialDrive{};
  world.control_noise.alpha = {0.02, 0.1, 1e-3, 0.5};
  expect_information_of_trajectory(world);
}

TEST(CramerRaoBound, IsThatOfEverySensorWhereverItIsMounted) {
  for (const auto& [name, sensor] : some_sensors()) {
    SCOPED_TRACE(name);
    SimulatedWorld world = open_world();
    world.sensor = sensor;
    world.view = FieldOfView(50.0, kPi, sensor.mounting);
    const double first = wraps(components_of(sensor)[0]) ? 0.02 : 0.1;
    world.sigma_observation = {first, fixes_landmark(sensor) ? 0.02 : 1.0};
    const bool fixes = fixes_landmark(sensor);
    expect_information_of_trajectory(world, fixes ? 0 : 3, fixes ? 1e-5 : 3e-3);
  }
}

TEST(CramerRaoBound, IsThatOfALocalisationInAKnownMap) {
  SimulatedWorld world = open_world();
  world.prior = {.position = 0.3, .heading = 0.05, .landmark = 0.2};
  expect_information_of_trajectory(world);
  const TruePath path = path_of(bends(24), 4, kAhead);
  const double some = squared_bound(world, path).map;
  EXPECT_LT(some, 2 * 0.2 * 0.2);
  world.prior->landmark = 0.0;
  EXPECT_TRUE(std::isnan(squared_bound(world, path).map)) << "an exact map has no error";
}

// On a straight line towards its only landmark, with an error of the speed alone, the problem is
// linear: a Kalman filter of two numbers, by hand.
TEST(CramerRaoBound, IsTheKalmanFiltersCovarianceWhereTheProblemIsLinear) {
  SimulatedWorld world = open_world();
  world.view = FieldOfView(200.0, kPi);
  world.control_noise.sigma = {0.3, 0.0};
  const std::vector<Control> controls(20, Control{3.0, 0.0});
  const CramerRaoBound bound = squared_bound(world, path_of(controls, 2, {{100.0, 0.0}}));
  const double q = 2.0 * 0.3 * 0.3 * kStep * kStep, r = 0.1 * 0.1;
  double x = q, xl = q,
         l = q + r;  // covariance after the first scan, where the landmark is initialised
  for (std::size_t s = 0; s < bound.position.size(); ++s) {
    if (s > 0) {
      x += q;
      const double S = x - 2.0 * xl + l + r, gain_x = (xl - x) / S, gain_l = (l - xl) / S;
      const double old_x = x, old_l = l, old_xl = xl;
      x = old_x - gain_x * gain_x * S;
      l = old_l - gain_l * gain_l * S;
      xl = old_xl - gain_x * gain_l * S;
    }
    EXPECT_NEAR(bound.position[s], x, 1e-12);
    EXPECT_NEAR(bound.heading[s], 0.0, 1e-12);
  }
}

TEST(CramerRaoBound, NeedsTheScansAloneOnASmoothPath) {
  const SimulatedWorld world = open_world();
  const std::vector<Control> controls = bends(40, 0.1);
  const TruePath every = path_of(controls, 4, kAhead);
  TruePath scans{every.start, {}, {}, {}, kAhead, {}};
  for (std::size_t s = 0; s < every.scan_rows.size(); ++s) {
    scans.rows.push_back(every.rows[every.scan_rows[s]]);
    scans.steps.push_back(4);
    scans.durations.push_back(kStep);
    scans.scan_rows.push_back(static_cast<std::uint32_t>(s));
  }
  const CramerRaoBound all = squared_bound(world, every), few = squared_bound(world, scans);
  for (std::size_t s = 0; s < all.position.size(); ++s) {
    EXPECT_NEAR(few.position[s] / all.position[s], 1.0, 0.01);
    EXPECT_NEAR(few.heading[s] / all.heading[s], 1.0, 0.01);
  }
}

// Half of the information, on the average, is that of twice the variance.
TEST(CramerRaoBound, LosesTheInformationOfWhatIsMissed) {
  SimulatedWorld half = open_world(), worse = half, none = half;
  half.detected = 0.5;
  worse.sigma_observation *= std::sqrt(2.0);
  none.detected = 0.0;
  const TruePath path = path_of(bends(24), 4, kAhead);
  const CramerRaoBound full = squared_bound(open_world(), path);
  EXPECT_NEAR(squared_bound(half, path).map, squared_bound(worse, path).map, 1e-12);
  EXPECT_GT(squared_bound(half, path).position.back(), full.position.back());
  EXPECT_GT(squared_bound(none, path).position.back(), squared_bound(half, path).position.back());
  EXPECT_TRUE(std::isnan(squared_bound(none, path).map));
}

TEST(CramerRaoBound, KnowsLandmarksInViewOnly) {
  const auto bound_with = [](const Landmarks& landmarks) {
    return squared_bound(open_world(), path_of(bends(24), 4, landmarks));
  };
  EXPECT_EQ(bound_with({{-5.0, 0.0}, {500.0, 0.0}}).position, bound_with({}).position);
  EXPECT_EQ(bound_with({{8.0, 3.0}, {500.0, 0.0}}).map, bound_with({{8.0, 3.0}}).map);
}

class BoundOfAFile : public ::testing::Test {
 protected:
  StudyAnalysis analyzed(const std::vector<std::string>& overrides) const {
    write_studied_result(path_, kTinyLoop, overrides);
    return analyze(ResultFile(path_));
  }
  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
};

const std::vector<std::string> kTinyNoise = {
    "scenario.sigma_speed=0.003",      "scenario.sigma_steer_deg=0.03",
    "scenario.sigma_range=0.001",      "scenario.sigma_bearing_deg=0.01",
    "scenario.noise=measured-control", "study.runs=400"};

// The mean squares are 12.5 of 50, 1 of 16 and 9 of 36.
TEST(Efficiency, IsTheRatioOfRootsByHand) {
  CellAnalysis cell;
  cell.complete = 2;
  const ScoreTable::Value run[] = {
      {"position_mse", 50.0}, {"heading_mse", 16.0}, {"landmark_rms", 6.0}};
  cell.scores.add(run);
  cell.scores.add(run);
  CramerRaoBound bound;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).map));
  bound.map = 3.0;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).map)) << "without a path there is no bound";
  bound.position = {3.0, 4.0};
  bound.heading = {1.0, 1.0};
  const Efficiency found = efficiency_of(cell, bound);
  EXPECT_DOUBLE_EQ(found.position, 0.5);
  EXPECT_DOUBLE_EQ(found.heading, 0.25);
  EXPECT_DOUBLE_EQ(found.map, 0.5);
  bound.is_bound = false;
  EXPECT_TRUE(std::isnan(efficiency_of(cell, bound).position)) << "a reference is no bound";
}

// Where noise is so small that all is linear, a Kalman filter is as good as can be. 400 runs know
// the position error to 5 %: one run's mean square scatters by about its own size.
TEST_F(BoundOfAFile, IsAttainedByEkfSlamAtTinyNoise) {
  const StudyAnalysis study = analyzed(kTinyNoise);
  ASSERT_FALSE(study.bound.empty());
  EXPECT_EQ(study.bound.runs, 1u);
  EXPECT_TRUE(study.bound.is_bound);
  const CellAnalysis& cell = study.cells.front();
  const double relative =
      2.5 * cell.over_runs("position_mse").standard_error() / cell.over_runs("position_mse").mean;
  EXPECT_NEAR(cell.get<Efficiency>().position, 1.0, relative);
  EXPECT_NEAR(cell.get<Efficiency>().heading, 1.0, 0.1);
  EXPECT_NEAR(cell.get<Efficiency>().map, 1.0, 0.1);
  EXPECT_NEAR(cell.over_runs("landmark_nees").mean, 2.0,
              5.0 * cell.over_runs("landmark_nees").standard_error());
}

TEST_F(BoundOfAFile, IsTheAverageOverPathsThatDiffer) {
  const StudyAnalysis study = analyzed({"scenario.noise=matched", "study.runs=20"});
  EXPECT_EQ(study.bound.runs, kBoundRuns);
  EXPECT_GT(study.bound.map, 0.0);
  EXPECT_FALSE(study.bound.is_bound);
  EXPECT_TRUE(std::isnan(study.cells.front().get<Efficiency>().position));
  // The average is about the value of one path.
  const StudyAnalysis one = analyzed({"scenario.noise=matched", "study.runs=1"});
  EXPECT_NEAR(study.bound.position.back() / one.bound.position.back(), 1.0, 0.5);
}

TEST_F(BoundOfAFile, IsThatOfTheTruthWhateverFiltersBelieve) {
  const StudyAnalysis matched = analyzed({"study.runs=1"});
  const StudyAnalysis wrong = analyzed({"study.runs=1", "belief.sigma_range=3"});
  EXPECT_EQ(matched.bound, wrong.bound);
}

TEST_F(BoundOfAFile, IsMissingWithItsReason) {
  EXPECT_EQ(analyzed({"scenario.sigma_range=0", "belief.sigma_range=0.1"}).bound.missing,
            "the sensor has no noise");
  write_synthetic_result(path_);
  const StudyAnalysis study = analyze(ResultFile(path_));
  EXPECT_TRUE(study.bound.empty());
  EXPECT_NE(study.bound.missing.find("simulated"), std::string::npos);
  EXPECT_TRUE(std::isnan(study.cells.front().get<Efficiency>().position));
}

// Why the mean over paths of the recursion along each of them is called a reference and no bound:
// one number x with the prior N(0, 1), observed as z = x^3 + v.
constexpr double kSeenSigma = 0.1;  // of v
constexpr double kPriorStep = 0.002, kPriorEnd = 6.0;
constexpr double kSeenStep = 0.02;  // a fifth of sigma

double normal_density(double x, double sigma) {
  return std::exp(-0.5 * x * x / (sigma * sigma)) / (sigma * std::sqrt(2.0 * M_PI));
}

/// Sum of value(x) times the prior's probability.
template <class Value>
double over_prior(const Value& value) {
  double sum = 0.0;
  for (double x = -kPriorEnd; x <= kPriorEnd; x += kPriorStep)
    sum += value(x) * normal_density(x, 1.0) * kPriorStep;
  return sum;
}

/// Information of z about x where x is known.
double information_of_cube(double x) { return 9.0 * std::pow(x, 4) / (kSeenSigma * kSeenSigma); }

/// Mean square error of the conditional mean, of which no estimator is better.
double least_error() {
  double of_means = 0.0;  // E[x^2] is 1
  for (double z = -150.0; z <= 150.0; z += kSeenStep) {
    // Where x^3 is within six sigma of z.
    const double low = std::cbrt(z - 6.0 * kSeenSigma), high = std::cbrt(z + 6.0 * kSeenSigma);
    const double step = (high - low) / 400.0;
    double density = 0.0, first = 0.0;
    for (double x = low; x <= high; x += step) {
      const double p = normal_density(x, 1.0) * normal_density(z - x * x * x, kSeenSigma) * step;
      density += p;
      first += x * p;
    }
    if (density > 0.0) of_means += first * first / density * kSeenStep;
  }
  return 1.0 - of_means;
}

TEST(MeanOverPathsOfTheRecursion, IsNoBound) {
  const double reference =
      over_prior([](double x) { return 1.0 / (1.0 + information_of_cube(x)); });
  const double achieved = least_error();
  EXPECT_NEAR(reference, 0.160, 0.001);
  EXPECT_NEAR(achieved, 0.040, 0.002);
  EXPECT_GT(reference, 3.5 * achieved);
  // Information averaged first, the bound of Van Trees, is one, and a loose one.
  EXPECT_LT(1.0 / (1.0 + over_prior(information_of_cube)), achieved);
}

}  // namespace
}  // namespace montecarta::analysis
