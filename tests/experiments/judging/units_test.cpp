// SPDX-License-Identifier: BSD-3-Clause
// Units that a header does not state as they are: angles in degrees, times in ns.
#include "engine/numbers/angle.hpp"
#include "experiments/judging/angle_units.hpp"
#include "experiments/judging/time_units.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

#include <cmath>
#include <functional>

namespace montecarta::experiments {
namespace {

constexpr int kDrivenRows = 200;
const StateShape kPlanarPose = {
    StateKind::pose, {"x_m", "y_m", "heading_rad"}, {"x", "y", "heading"}, {"m", "m", "rad"}};

/// A drive with 1 m between its rows in the direction of `heading` [rad], which is written as
/// `written` of it.
StateRows driven(const std::function<double(int)>& heading,
                 const std::function<double(double)>& written) {
  StateRows rows{kPlanarPose, {}, {}, {}, {}, {}};
  Eigen::Vector2d place(0.0, 0.0);
  for (int k = 0; k < kDrivenRows; ++k) {
    rows.time.push_back(0.1 * k);
    rows.line.push_back(static_cast<std::size_t>(k) + 2);
    rows.state.emplace_back(Eigen::Vector3d(place.x(), place.y(), written(heading(k))));
    place += Eigen::Vector2d(std::cos(heading(k)), std::sin(heading(k)));
  }
  return rows;
}

std::string on_angles(const StateRows& rows) {
  return complaint_of([&] { require_radians(rows, "a.csv"); });
}

double in_degrees(double angle) { return wrap(angle) * 180.0 / kPi; }
double from_north(double angle) { return std::fmod(angle * 180.0 / kPi + 3600.0, 360.0); }
double unwrapped(double angle) { return angle; }

TEST(AngleUnits, OfHeadingsInDegreesAreRefused) {
  const auto turns = [](int k) { return 0.2 * k; };
  const auto turns_slowly = [](int k) { return 0.02 * k; };
  const auto drives_an_s = [](int k) { return 1.2 * std::sin(0.03 * k); };
  for (const auto& heading :
       {std::function<double(int)>(turns), std::function<double(int)>(turns_slowly),
        std::function<double(int)>(drives_an_s)}) {
    for (const auto& written : {in_degrees, from_north}) {
      EXPECT_THAT(on_angles(driven(heading, written)),
                  AllOf(HasSubstr("a.csv:"), HasSubstr("heading_rad"), HasSubstr("in degrees")));
    }
  }
  StateRows with_speed = driven(turns_slowly, in_degrees);
  with_speed.shape = {
      StateKind::vector, {"x_m", "y_m", "yaw_rad"}, {"x", "y", "yaw"}, {"m", "m", "rad"}};
  EXPECT_THAT(on_angles(with_speed), HasSubstr("yaw_rad"));
  const StateRows vector = [&] {
    StateRows rows = driven(turns, in_degrees);
    rows.shape.kind = StateKind::vector;
    rows.shape.components[2] = "bearing";
    return rows;
  }();
  EXPECT_EQ(on_angles(vector), "nothing") << "that may be the angle of a wheel";
  EXPECT_THAT(note_on_angles(vector, "a.csv"), HasSubstr("is it in degrees"));
}

TEST(AngleUnits, OfSmallHeadingsInDegreesAreNoted) {
  const auto drives_nearly_straight = [](int k) { return 0.15 * std::sin(0.03 * k); };
  const StateRows rows = driven(drives_nearly_straight, in_degrees);
  EXPECT_EQ(on_angles(rows), "nothing");
  EXPECT_THAT(note_on_angles(rows, "a.csv"), HasSubstr("is it in degrees"));
  EXPECT_EQ(note_on_angles(driven(drives_nearly_straight, unwrapped), "a.csv"), "");
}

TEST(AngleUnits, OfHeadingsThatCountTurnsAreRadians) {
  const auto turns = [](int k) { return 0.5 * k; };
  const auto jumps_once = [](int k) { return 0.3 * k + (k > 100 ? 9.0 : 0.0); };
  for (const auto& heading :
       {std::function<double(int)>(turns), std::function<double(int)>(jumps_once)}) {
    EXPECT_EQ(on_angles(driven(heading, unwrapped)), "nothing");
    EXPECT_EQ(on_angles(driven(heading, [](double angle) { return wrap(angle); })), "nothing");
    EXPECT_EQ(note_on_angles(driven(heading, unwrapped), "a.csv"), "");
  }
}

StateRows timed(double first, double spacing) {
  StateRows rows = driven([](int) { return 0.0; }, unwrapped);
  for (std::size_t k = 0; k < rows.time.size(); ++k) {
    rows.time[k] = first + spacing * static_cast<double>(k);
  }
  return rows;
}

TEST(TimeUnits, OtherThanSecondsAreRefused) {
  const auto on_times = [](double first, double spacing) {
    return complaint_of([&] { require_seconds(timed(first, spacing), "t.csv"); });
  };
  EXPECT_THAT(on_times(1.4e18, 5e7), AllOf(HasSubstr("t.csv:2"), HasSubstr("by 1e9")));
  EXPECT_THAT(on_times(1.4e15, 5e4), HasSubstr("by 1e6"));
  EXPECT_THAT(on_times(1.4e12, 50.0), HasSubstr("by 1e3"));
  EXPECT_THAT(on_times(0.0, 5e7), HasSubstr("by 1e9"));
  EXPECT_EQ(on_times(1.4e9, 0.05), "nothing");
  EXPECT_EQ(on_times(0.0, 86400.0), "nothing") << "one row a day";
  EXPECT_THAT(note_on_times(timed(0.0, 1e5), "t.csv"), HasSubstr("divide it by 1e6"));
  EXPECT_EQ(note_on_times(timed(0.0, 60.0), "t.csv"), "");
}

TEST(TimeUnits, OfEstimatesAndTruthAreTheSame) {
  const auto on_both = [](const StateRows& estimates, const StateRows& truth) {
    return complaint_of([&] { require_same_time_unit(estimates, "e.csv", truth, "t.csv"); });
  };
  EXPECT_THAT(on_both(timed(0.0, 0.5), timed(0.0, 500.0)),
              AllOf(HasSubstr("t.csv: times look like ms"), HasSubstr("by 1e3")));
  EXPECT_THAT(on_both(timed(3.0, 0.5), timed(1.0e6, 0.5e6)),
              HasSubstr("t.csv: times look like us"));
  EXPECT_THAT(on_both(timed(0.0, 500.0), timed(0.0, 0.5)), HasSubstr("e.csv: times look like ms"));
  EXPECT_EQ(on_both(timed(0.0, 0.5), timed(0.0, 0.5)), "nothing");
  EXPECT_EQ(on_both(timed(50.0, 0.01), timed(0.0, 0.5)), "nothing");
  EXPECT_EQ(on_both(timed(50.0, 0.0005), timed(0.0, 0.5)), "nothing") << "a short part of it";
}

}  // namespace
}  // namespace montecarta::experiments
