// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/drive_log.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// What is said of a good log after one change.
std::string complaint_after(const std::function<void(DriveLog&)>& change) {
  DriveLog log = full_log();
  change(log);
  return complaint_of([&] { check_log(log, "yard"); });
}

TEST(CheckLog, TakesAGoodLog) {
  EXPECT_EQ(complaint_after([](DriveLog&) {}), "nothing");
}

TEST(CheckLog, WantsEachPart) {
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.odometry.clear(); }),
              HasSubstr("yard (odometry): no records"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans.clear(); }),
              HasSubstr("yard (scans): no records"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references.clear(); }),
              HasSubstr("no reference"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[1].name = "reference"; }),
              HasSubstr("two references called reference"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[1].name = "../x"; }),
              HasSubstr("is no name"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[0].heading.pop_back(); }),
              HasSubstr("as many places, or headings"));
}

TEST(CheckLog, WantsTimesToIncrease) {
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.odometry[1].time = 0.1; }),
              AllOf(HasSubstr("record 2"), HasSubstr("time 0.1 s comes after 0.1 s")));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans[2].time = 0.15; }),
              AllOf(HasSubstr("(scans): record 3"), HasSubstr("times must increase")));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[0].time[1] = -1; }),
              AllOf(HasSubstr("(reference reference): record 2"), HasSubstr("must increase")));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans[1].time = kNan; }),
              HasSubstr("record 2: time nan"));
}

TEST(CheckLog, WantsNumbersThatCanBe) {
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.odometry[0].control[0] = kNan; }),
              HasSubstr("(odometry): record 1: speed nan"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.odometry[1].control[1] = 5; }),
              HasSubstr("record 2: steering 5 (radians"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans[1].detections[0][0] = kNan; }),
              HasSubstr("(scans): record 2: range nan"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans[1].detections[0][0] = 0; }),
              HasSubstr("record 2: range 0"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.scans[1].detections[0][1] = 45; }),
              HasSubstr("record 2: bearing 45 (radians"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[1].position[0].x() = 5e6; }),
              HasSubstr("(reference gps): record 1: coordinate 5e+06"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.landmarks[1].y() = kNan; }),
              HasSubstr("(landmarks): record 2: coordinate nan"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.references[0].heading[1] = kNan; }),
              HasSubstr("record 2: heading nan"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.start.heading = kNan; }),
              HasSubstr("yard (start)"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.start_time = 0.15; }),
              HasSubstr("yard (scans): the first is at 0.1 s, before the start"));
  EXPECT_THAT(complaint_after([](DriveLog& log) { log.start_time = 0.4, log.scans.clear(); }),
              HasSubstr("yard (scans): no records"));
}

TEST(CheckLog, RefusesScansLongAfterTheLastOdometry) {
  EXPECT_THAT(complaint_after([](DriveLog& log) {
                log.scans.push_back({5.4, {}});
              }),
              AllOf(HasSubstr("yard (odometry): the last record is at 0.3"),
                    HasSubstr("the last scan at 5.4 s")));
  EXPECT_EQ(complaint_after([](DriveLog& log) { log.scans.push_back({5.2, {}}); }), "nothing");
}

TEST(CheckLog, RefusesALandmarkTwiceInAScan) {
  EXPECT_THAT(complaint_after([](DriveLog& log) {
                log.scans[1].detections.push_back({4.0, 0.0, 1});
              }),
              HasSubstr("(scans): record 2, at 0.2 s: identity 1 twice"));
  EXPECT_EQ(complaint_after([](DriveLog& log) {
              log.scans[1].detections.push_back({4.0, 0.0, Detection::kClutter});
            }),
            "nothing");
}

TEST(CheckLog, WantsIdentitiesForAllOrNone) {
  const auto identify = [](std::int32_t identity) {
    return complaint_after([=](DriveLog& log) { log.scans[2].detections[0].identity = identity; });
  };
  EXPECT_THAT(identify(Detection::kUnidentified),
              AllOf(HasSubstr("record 3"), HasSubstr("all or none")));
  EXPECT_THAT(identify(2), HasSubstr("identity 2 of 2 landmarks"));
  EXPECT_THAT(identify(-3), HasSubstr("identity -3"));
  EXPECT_THAT(identify(kMostIdentities), HasSubstr("identity 1000000"));
}

}  // namespace
}  // namespace montecarta::experiments
