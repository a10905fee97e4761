// SPDX-License-Identifier: BSD-3-Clause
// Settings of vehicles and sensors in a study.
#include "engine/records/result_file.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/make_drives.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"
#include "tests/experiments/study/study_text.hpp"

#include <boost/math/distributions/chi_squared.hpp>

#include <cmath>

namespace montecarta::experiments {
namespace {

const std::string kRobot =
    with("world = web_loop ", "world = web_loop\nvehicle = differential_drive ");

TEST(VehicleStudy, ARobotHasItsOwnSettingsAndNoneOfACar) {
  const auto robot = resolved_settings(parsed(kRobot)), car = resolved_settings(parsed(kGoodStudy));
  EXPECT_EQ(robot.at("scenario.integration"), "arc");
  EXPECT_EQ(robot.at("scenario.sigma_yaw_rate_deg"), "3");
  EXPECT_EQ(robot.at("scenario.turn_on_spot_deg"), "45");
  EXPECT_EQ(car.at("scenario.wheelbase"), "4");
  EXPECT_EQ(car.at("scenario.sigma_steer_deg"), "3");
  for (const char* key : {"scenario.wheelbase", "scenario.sigma_steer_deg"}) {
    EXPECT_FALSE(robot.contains(key)) << key;
  }
  for (const char* key : {"scenario.sigma_yaw_rate_deg", "scenario.integration"}) {
    EXPECT_FALSE(car.contains(key)) << key;
  }
}

TEST(VehicleStudy, TheResolvedTextIsTheSameStudy) {
  const auto overrides = {"scenario.vehicle=differential_drive", "scenario.alpha_3=0.01",
                          "belief.integration=euler", "belief.alpha_1=0.2"};
  const Study study = parsed(kGoodStudy, {overrides.begin(), overrides.end()});
  const std::string text = resolved_text(study);
  EXPECT_EQ(resolved_text(parsed(text)), text);
  EXPECT_EQ(resolved_settings(study).at("scenario.alpha_3"), "0.01");
}

TEST(VehicleStudy, SettingsReachTheVehicleAndItsNoise) {
  const Study study = parsed(
      kRobot, {"scenario.yaw_rate_limit_deg=180", "scenario.alpha_4=0.1",
               "scenario.sigma_yaw_rate_deg=18", "belief.alpha_4=0", "scenario.integration=euler"});
  const auto vehicle = std::get<DifferentialDrive>(vehicle_of(study.settings, "scenario"));
  EXPECT_DOUBLE_EQ(vehicle.yaw_rate_limit, kPi);
  EXPECT_EQ(vehicle.integration, Integration::euler);
  EXPECT_EQ(std::get<DifferentialDrive>(vehicle_of(study.settings, "belief")).integration,
            Integration::euler);
  const ControlNoise noise = control_noise_of(study.settings, "scenario");
  EXPECT_DOUBLE_EQ(noise.sigma[1], 0.1 * kPi);
  EXPECT_EQ(noise.alpha[3], 0.1);
  EXPECT_EQ(control_noise_of(study.settings, "belief").alpha[3], 0.0);
}

TEST(VehicleStudy, WhatIsOfAnotherVehicleOrNoiseIsRefused) {
  EXPECT_THAT(complaint(kRobot, {"scenario.wheelbase=2"}),
              HasSubstr("scenario.wheelbase does not apply"));
  EXPECT_THAT(complaint(kRobot, {"belief.sigma_steer_deg=2"}),
              HasSubstr("sigma_steer_deg does not apply to belief.vehicle = differential_drive"));
  EXPECT_THAT(complaint(kRobot, {"scenario.noise=measured-control", "scenario.pilot=open_loop"}),
              HasSubstr("pilot = open_loop with noise = measured-control"));
  const Study open = parsed(kRobot, {"scenario.noise=matched", "scenario.pilot=open_loop"});
  EXPECT_EQ(resolved_settings(open).at("scenario.pilot"), "open_loop");
}

TEST(VehicleStudy, AFilterThatBelievesInOtherControlsIsRefused) {
  const auto plan = [](const Study& study) {
    return complaint_of([&] { make_plan(study, std::nullopt, ExternalPrograms::refused); });
  };
  EXPECT_THAT(plan(parsed(kRobot, {"belief.vehicle=front_axle"})),
              AllOf(HasSubstr("controlled by speed, steer (the drive has speed, yaw_rate)")));
  EXPECT_EQ(plan(parsed(kGoodStudy, {"belief.vehicle=rear_wheel"})), "nothing");
}

TEST(VehicleStudy, NoiseGrowsByTheSquareOfAMismatch) {
  const std::string text = kRobot + "cell = dead_reckoning\ncell = dead_reckoning motion_noise=3\n";
  const StudyPlan plan =
      make_plan(parsed(text, {"scenario.alpha_1=0.1"}), std::nullopt, ExternalPrograms::refused);
  std::vector<Eigen::Matrix3d> covariances;
  for (const std::size_t cell : {1, 2}) {
    const auto filter = plan.cells[cell].make_filter();
    filter->start(Pose());
    filter->predict(StepContext(1, 0, 0, Parallel::serial()), {3.0, 0.5}, 0.1);
    covariances.push_back(filter->estimate().spread.covariance);
  }
  EXPECT_TRUE(covariances[1].isApprox(9.0 * covariances[0], 1e-12));
  EXPECT_NEAR(covariances[0](0, 0), 0.01 * (0.09 + 0.1 * 9.0), 1e-4);
}

// Until the first landmark is seen again the covariance is that of the motion alone.
TEST(VehicleStudy, AFilterBelievesTheNoiseTimesItsFactors) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "out.h5";
  analysis::write_studied_result(path, analysis::kTinyLoop,
                                 {"cells.cell=ekf_slam motion_noise=1,2 sensor_noise=1,2",
                                  "study.runs=1", "scenario.noise=matched"});
  const ResultFile file(path);
  ASSERT_EQ(file.cells().size(), 4u);
  std::vector<std::vector<double>> covariance;
  for (const StoredCell& cell : file.cells()) {
    auto& P = covariance.emplace_back(9 * file.times().size());
    file.read(cell, "pose_covariance", 0, std::span(P));
  }
  EXPECT_DOUBLE_EQ(covariance[1][0], covariance[0][0]);
  EXPECT_DOUBLE_EQ(covariance[2][0], 4.0 * covariance[0][0]);
  EXPECT_DOUBLE_EQ(covariance[3][8], 4.0 * covariance[0][8]);
  const std::size_t last = 9 * (file.times().size() - 1);
  EXPECT_GT(covariance[1][last], 1.2 * covariance[0][last]);
}

const std::string kWorld = "[study]\nname = s\nruns = 1\n[scenario]\nworld = web_loop\n";
const std::string kKnown = "[association]\nkind = known\n";

std::string of_cell(const std::string& filter) {
  return kWorld + kKnown + "[cells]\ncell = " + filter + "\n";
}

TEST(SensorStudy, ASensorHasItsOwnNoiseAndNoOther) {
  const auto position = resolved_settings(parsed(
      of_cell("ekf_slam"), {"scenario.sensor=position", "scenario.sigma_position_left=0.3"}));
  EXPECT_EQ(position.at("scenario.sensor"), "position");
  EXPECT_EQ(position.at("scenario.sigma_position_left"), "0.3");
  EXPECT_EQ(position.at("scenario.sigma_position_forward"), "0.1");
  EXPECT_FALSE(position.contains("scenario.sigma_range"));
  EXPECT_FALSE(position.contains("scenario.sigma_bearing_deg"));
  const auto usual = resolved_settings(parsed(of_cell("ekf_slam")));
  EXPECT_TRUE(usual.contains("scenario.sigma_range"));
  EXPECT_FALSE(usual.contains("scenario.sigma_position_left"));
  EXPECT_THAT(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=bearing_only", "scenario.sigma_range=1"}),
      AllOf(HasSubstr("sigma_range does not apply to scenario.sensor = bearing_only"),
            HasSubstr("range_bearing, range_only")));
}

TEST(SensorStudy, BeliefsMayMountItElsewhere) {
  const Study study = parsed(
      of_cell("ekf_slam"),
      {"scenario.mount_forward=0.5", "scenario.mount_turn_deg=90", "belief.mount_left=-0.1"});
  const Mounting is = sensor_of(study.settings, "scenario").mounting;
  const Mounting believed = sensor_of(study.settings, "belief").mounting;
  EXPECT_EQ(is.forward, 0.5);
  EXPECT_EQ(is.left, 0.0);
  EXPECT_DOUBLE_EQ(believed.turn, kPi / 2);
  EXPECT_EQ(believed.forward, 0.5);
  EXPECT_EQ(believed.left, -0.1);
}

TEST(SensorStudy, WhatAFilterDoesNotTakeIsRefused) {
  EXPECT_THAT(complaint(of_cell("marginal"), {"scenario.sensor=range_only"}),
              AllOf(HasSubstr("marginal takes no sensor range_only (it takes range_bearing)"),
                    HasSubstr("ekf_slam, riekf_slam")));
  EXPECT_THAT(complaint(of_cell("de_srcd"), {"scenario.mount_left=1"}),
              AllOf(HasSubstr("de_srcd takes no sensor that is mounted elsewhere"),
                    HasSubstr("fastslam1, fastslam2, ufastslam, srcd")));
  EXPECT_THAT(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=bearing_only", "association.kind=nearest"}),
      HasSubstr("association.kind = nearest with bearing_only"));
  EXPECT_EQ(
      complaint(of_cell("ekf_slam"), {"scenario.sensor=position", "association.kind=nearest"}),
      "nothing");
  EXPECT_EQ(complaint(of_cell("dead_reckoning"),
                      {"scenario.sensor=bearing_only", "association.kind=nearest"}),
            "nothing");
}

TEST(SensorStudy, ParticleFiltersTakeEverySensorButNeedToKnowWhatTheyDelay) {
  for (const char* filter : {"fastslam1", "fastslam2", "ufastslam", "srcd"}) {
    for (const std::string& sensor : sensor_names()) {
      const std::string kind = "scenario.sensor=" + sensor;
      EXPECT_EQ(complaint(of_cell(filter), {kind, "scenario.mount_left=1"}), "nothing");
      const std::string refusal =
          complaint(of_cell(filter), {kind, "association.kind=nearest", "scenario.mount_left=1"});
      if (fixes_landmark(*sensor_named(sensor))) {
        EXPECT_EQ(refusal, "nothing") << filter << ", " << sensor;
      } else {
        EXPECT_THAT(refusal, HasSubstr("association.kind = nearest with " + sensor));
      }
    }
  }
}

TEST(SensorStudy, ABeliefInOtherDetectionsIsRefused) {
  const Study study = parsed(of_cell("ekf_slam"), {"belief.sensor=position"});
  EXPECT_THAT(complaint_of([&] { drives_of(study, 1); }), HasSubstr("belief.sensor = position"));
}

TEST(SensorStudy, GatesAcceptAsOftenWhateverTheDimensionOfADetection) {
  for (const std::string& sensor : sensor_names()) {
    Study study = parsed(of_cell("dead_reckoning"),
                         {"scenario.sensor=" + sensor, "association.gate_sigma=2.5"});
    AssociationSettings given;
    FilterKind asking = *study.cells[0].filter;
    asking.make = [&given, make = asking.make](const FilterSetup& setup) {
      given = setup.association;
      return make(setup);
    };
    study.cells[0].filter = &asking;
    make_plan(study).cells[0].make_filter();
    const auto dimension = static_cast<double>(components_of(*sensor_named(sensor)).size());
    const double accepted = std::erf(2.5 / std::sqrt(2.0));
    EXPECT_NEAR(given.gate, quantile(boost::math::chi_squared(dimension), accepted), 1e-9)
        << sensor;
  }
}

/// A log of a robot that turns on the spot and measures bearings, as a folder.
class RobotLog : public testing::Test {
 protected:
  RobotLog() {
    write_text(folder_ / "start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write_text(folder_ / "odometry.csv",
               "time_s,speed_mps,yaw_rate_radps\n0,0.5,0\n1,0,1.5\n2,0,0\n");
    write_text(folder_ / "detections.csv",
               "time_s,bearing_rad,identity\n1.5,,\n2.5,0.2,3\n2.5,-0.5,\n");
    write_text(folder_ / "reference.csv", "time_s,x_m,y_m\n0,0,0\n3,0.5,0\n");
  }
  DriveLog read() const { return read_log_csv(folder_.path()); }
  std::shared_ptr<const DriveSource> drives(const std::string& belief) const {
    const Study study = parsed("[study]\nname = robot\nruns = 1\n[scenario]\nkind = log\npath = " +
                               folder_.path().string() + "\n" + kKnown + "[belief]\n" + belief +
                               "\nsigma_bearing_deg = 1\n[cells]\ncell = ekf_slam\n");
    return drives_of(study, 1);
  }
  std::string complaint_about(const std::string& belief) const {
    return complaint_of([&] { drives(belief); });
  }
  ScratchFolder folder_;
};

const std::string kRobotBelief = "vehicle = differential_drive\nsigma_speed = 0.1\n";

TEST_F(RobotLog, IsDrivenAsItWasRecorded) {
  const auto source = drives(kRobotBelief + "sigma_yaw_rate_deg = 3\nsensor = bearing_only");
  Drive drive;
  source->generate(0, drive);
  const std::size_t moving = source->itinerary().moving_controls;
  EXPECT_EQ(moving, 2U);
  ASSERT_EQ(drive.controls.size(), 4U);
  EXPECT_EQ(drive.controls[1][1], 1.5);
  EXPECT_FALSE(drive.controls[1].stands(moving));
  EXPECT_TRUE(drive.controls[3].stands(moving));
}

TEST_F(RobotLog, NeedsABeliefInThatVehicleAndThatSensor) {
  EXPECT_THAT(complaint_about("wheelbase = 1\nsigma_speed = 0.1\nsigma_steer_deg = 3\n"
                              "sensor = bearing_only"),
              HasSubstr("controlled by speed, steer (the drive has speed, yaw_rate)"));
  EXPECT_THAT(complaint_about(kRobotBelief + "sensor = bearing_only"),
              HasSubstr("sigma_yaw_rate_deg is missing"));
  EXPECT_THAT(complaint_about(kRobotBelief + "sigma_yaw_rate_deg = 3\nsigma_range = 1"),
              HasSubstr("set belief.sensor"));
}

TEST_F(RobotLog, IsWrittenAsItWasRead) {
  const DriveLog log = read();
  ASSERT_EQ(log.components.size(), 1U);
  EXPECT_EQ(log.components[0], Quantity::bearing);
  EXPECT_TRUE(log.scans[0].detections.empty());
  EXPECT_EQ(log.scans[1].detections[0].identity, 3);
  write_log_csv(log, folder_ / "copy");
  const DriveLog copy = read_log_csv(folder_ / "copy");
  EXPECT_EQ(copy.controls.data(), log.controls.data());
  EXPECT_EQ(copy.components.data(), log.components.data());
  ASSERT_EQ(copy.odometry.size(), 3U);
  EXPECT_EQ(copy.odometry[1].control.values, log.odometry[1].control.values);
  ASSERT_EQ(copy.scans.size(), 2U);
  EXPECT_EQ(copy.scans[1].detections[1].values, log.scans[1].detections[1].values);
}

TEST_F(RobotLog, InDegreesIsRefused) {
  const std::string odometry = "time_s,speed_mps,yaw_rate_radps\n0,0.5,0\n";
  write_text(folder_ / "odometry.csv", odometry + "1,0,180\n");
  EXPECT_THAT(complaint_of([this] { read(); }), HasSubstr(": yaw_rate 180"));
  write_text(folder_ / "odometry.csv", odometry);
  write_text(folder_ / "detections.csv", "time_s,bearing_rad\n1.5,45\n");
  EXPECT_THAT(complaint_of([this] { read(); }), HasSubstr(": bearing 45"));
}

TEST(SensorStudy, ObservabilityIsOfFiltersThatTellItAndSensorsThatFixLandmarks) {
  const auto refusal = [](const char* filter, const char* sensor) {
    const std::string chosen = std::string("scenario.sensor=") + sensor;
    const Study study = parsed(of_cell(filter), {chosen, "record.columns=pose, observability"});
    return complaint_of([&] { make_plan(study); });
  };
  EXPECT_THAT(refusal("dead_reckoning", "range_bearing"), HasSubstr("observability (no cell"));
  EXPECT_THAT(refusal("ekf_slam", "bearing_only"), HasSubstr("observability (no cell reports"));
  EXPECT_EQ(refusal("ekf_slam", "position"), "nothing");
  EXPECT_EQ(refusal("fej_ekf_slam", "range_bearing"), "nothing");
}

TEST(Study, RecordsEvolutionOfFiltersThatEvolve) {
  const auto refusal = [](const char* filter) {
    const Study study = parsed(of_cell(filter), {"record.columns=pose, evolution"});
    return complaint_of([&] { make_plan(study); });
  };
  EXPECT_THAT(refusal("ekf_slam"), HasSubstr("evolution (no cell's filter evolves"));
  EXPECT_THAT(refusal("ampf_de map_solver=gauss_newton"), HasSubstr("evolution (no cell"));
  EXPECT_EQ(refusal("de_srcd"), "nothing");
  EXPECT_EQ(refusal("ampf_de"), "nothing");
}

TEST(SensorStudy, SomethingIsInReach) {
  EXPECT_THAT(
      engine::complaint_of([] {
        drives_of(parsed(of_cell("ekf_slam"), {"scenario.max_range=5", "scenario.min_range=5"}), 1);
      }),
      AllOf(HasSubstr("min_range is not below max_range = 5"), HasSubstr("lower it")));
}

}  // namespace
}  // namespace montecarta::experiments
