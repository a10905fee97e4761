// SPDX-License-Identifier: BSD-3-Clause
// Files without a seal whose numbers contradict each other: refused when they are opened.
#include "engine/errors.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/recorded_drives.hpp"
#include "tests/doubles/result_writing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace montecarta::engine {
namespace {

using ::testing::HasSubstr;

class CheckDescription : public ResultWriting {
 protected:
  /// Why a file that is laid out by a changed description is refused.
  std::string refusal(const std::function<void(ResultDescription&)>& change) const {
    ResultDescription description = describe(plan_, {});
    change(description);
    lay_out(path_, description);
    const std::string said = message<StudyError>([&] { ResultFile{path_}; });
    EXPECT_THAT(said, HasSubstr(path_.string()));
    return said;
  }
};

TEST_F(CheckDescription, LetsAGoodOnePass) {
  for (const bool scans_only : {false, true}) {
    plan_.columns.scans_only = scans_only;
    plan_.columns.joint = plan_.cells[0].joint = true;
    EXPECT_NO_THROW(check_description(describe(plan_, {}), "out.h5"));
  }
}

TEST_F(CheckDescription, RefusesRunsAndTimesThatAreNone) {
  EXPECT_THAT(refusal([](auto& d) { d.runs = {0, 2, 1}; }), HasSubstr("run numbers"));
  EXPECT_THAT(refusal([](auto& d) { d.study_runs = 2; }), HasSubstr("beyond the study's runs"));
  EXPECT_THAT(refusal([](auto& d) { d.times[3] = -1.0; }), HasSubstr("times do not increase"));
  EXPECT_THAT(refusal([](auto& d) { d.times[3] = std::numeric_limits<double>::quiet_NaN(); }),
              HasSubstr("times do not increase"));
  EXPECT_THAT(refusal([](auto& d) { d.times.back() = std::numeric_limits<double>::infinity(); }),
              HasSubstr("times do not increase"));
}

TEST_F(CheckDescription, RefusesScansThatAreNone) {
  EXPECT_THAT(refusal([](auto& d) { d.scan_rows.pop_back(); }), HasSubstr("not equally long"));
  EXPECT_THAT(refusal([](auto& d) { d.scan_rows.back() = 4'000'000'000U; }),
              HasSubstr("scan_row is beyond"));
  EXPECT_THAT(refusal([](auto& d) { d.scan_rows[0] = d.scan_rows[1]; }), HasSubstr("increase"));
  EXPECT_THAT(refusal([](auto& d) { d.scan_steps.back() = 4'000'000'000U; }),
              HasSubstr("scan_step is beyond"));
  EXPECT_THAT(refusal([](auto& d) { ++d.scan_steps.back(); }), HasSubstr("neither scan_step"));
  EXPECT_THAT(refusal([](auto& d) { d.scan_times[0] += 1e-9; }), HasSubstr("scan is not time"));
  plan_.columns.joint = plan_.cells[0].joint = true;
  const auto misplaced = [&](std::uint32_t scan) {
    ResultDescription description = describe(plan_, {});
    description.joint_scans.back() = scan;
    return message<StudyError>([&] { check_description(description, path_); });
  };
  EXPECT_THAT(misplaced(4000), HasSubstr("joint_scan"));
}

TEST_F(CheckDescription, RefusesColumnsThatDoNotFitTheirAxes) {
  const auto column = [](ResultDescription& d, std::string_view name) -> Column& {
    return *std::ranges::find(d.cells[0].columns, name, &Column::name);
  };
  EXPECT_THAT(refusal([&](auto& d) { --column(d, "pose_mean").shape[0]; }), HasSubstr("pose_mean"));
  EXPECT_THAT(refusal([&](auto& d) { ++column(d, "map_mean").shape[1]; }), HasSubstr("map_"));
  EXPECT_THAT(refusal([&](auto& d) { ++d.cells[0].particles; }), HasSubstr("axis particle"));
  EXPECT_THAT(refusal([&](auto& d) {
                column(d, "nis").axes = {Axis::time};
                column(d, "nis").shape = {d.times.size()};
              }),
              HasSubstr("nis has other axes"));
  EXPECT_THAT(refusal([](auto& d) {
                std::erase_if(d.cells[0].columns,
                              [](const auto& c) { return c.name == "nis_dof"; });
              }),
              HasSubstr("only a part of nis"));
  EXPECT_THAT(refusal([](auto& d) {
                std::erase_if(d.cells[0].columns,
                              [](const auto& c) { return c.name == "pose_mean"; });
              }),
              HasSubstr("has no pose_mean"));
  EXPECT_THAT(refusal([](auto& d) {
                std::erase_if(d.cells[0].columns,
                              [](const auto& c) { return c.name == "pose_covariance"; });
              }),
              HasSubstr("no pose_covariance"));
  EXPECT_THAT(refusal([](auto& d) { d.cells[0].label = std::string(1001, 'x'); }),
              HasSubstr("too long"));
}

// They stand in LaTeX comments, in scripts and on terminals.
TEST_F(CheckDescription, RefusesTextsThatAreNotOneLine) {
  EXPECT_THAT(refusal([](auto& d) { d.study_name = "a\n\\input{/etc/passwd}"; }),
              HasSubstr("a control character in 'a\\n"));
  EXPECT_THAT(refusal([](auto& d) { d.title = "\x1b[2J"; }), HasSubstr("'\\x1b[2J'"));
  EXPECT_THAT(refusal([](auto& d) { d.cells[0].long_name = "\r"; }), HasSubstr("\\x0d"));
}

TEST_F(CheckDescription, HoldsErrorsOfAnyDimension) {
  plan_.cells[0].error_components = 4;
  plan_.cells[0].poses = plan_.cells[0].innovations = false;
  const ResultDescription good = describe(plan_, {});
  EXPECT_NO_THROW(check_description(good, "out.h5"));
  for (const char* name : {"pose_mean", "pose_covariance", "ess", "nis"})
    EXPECT_FALSE(good.cells[0].has(name)) << name;
  const auto column = [](auto& d, const char* name) {
    return std::ranges::find(d.cells[0].columns, name, &Column::name);
  };
  EXPECT_EQ(column(good, "error")->shape.back(), 4U);
  EXPECT_THAT(refusal([&](auto& d) { column(d, "error_covariance")->shape.back() = 3; }),
              HasSubstr("error_covariance is not as long as its axis"));
  EXPECT_THAT(refusal([&](auto& d) { d.cells[0].columns.erase(column(d, "error")); }),
              HasSubstr("only a part of error"));
}

TEST_F(CheckDescription, RefusesPlacesThatAreNone) {
  EXPECT_THAT(refusal([](auto& d) { d.start.x = std::numeric_limits<double>::infinity(); }),
              HasSubstr("no places"));
  plan_.drives = std::make_shared<RecordedDrives>(24);
  EXPECT_THAT(refusal([](auto& d) { d.references[0].heading.pop_back(); }),
              HasSubstr("other fixes than times"));
  EXPECT_THAT(refusal([](auto& d) { d.references[0].position.pop_back(); }),
              HasSubstr("other fixes than times"));
  EXPECT_THAT(refusal([](auto& d) { d.references[1].position[2].y() = std::nan(""); }),
              HasSubstr("a fix of reference coarse is no place"));
}

/// Whatever one number is: the file is refused, or can be read.
TEST_F(CheckDescription, FindsEveryOddNumber) {
  for (std::uint64_t seed = 0; seed < damaged_files(200); ++seed) {
    Dice dice(seed);
    ResultDescription description = describe(plan_, {});
    const std::uint64_t word = extreme_word(dice);
    const auto put = [&](auto& values) {
      using Number = std::decay_t<decltype(values[0])>;
      std::memcpy(&values[dice.below(values.size())], &word, sizeof(Number));
    };
    switch (dice.below(6)) {
      case 0:
        put(description.runs);
        break;
      case 1:
        put(description.times);
        break;
      case 2:
        put(description.scan_times);
        break;
      case 3:
        put(description.scan_steps);
        break;
      case 4:
        put(description.scan_rows);
        break;
      default:
        description.study_runs = word;
    }
    lay_out(path_, description);
    try {
      const ResultFile file(path_);
      for (const std::uint32_t row : file.scan_rows()) EXPECT_LT(row, file.times().size());
    } catch (const StudyError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path_.string())) << seed;
    }
  }
}

}  // namespace
}  // namespace montecarta::engine
