// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/worlds/world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

/// A folder of its own for every test, removed afterwards.
class WorldFile : public testing::Test {
 protected:
  WorldFile() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("montecarta_world_" + std::string(test->name()) + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  ~WorldFile() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// What reading `text` as a CSV world complains of.
  std::string complaint(const std::string& text) const {
    try {
      read_world_file(write("bad.csv", text));
    } catch (const StudyError& error) {
      return error.what();
    }
    return "nothing";
  }

  fs::path folder_;
};

TEST_F(WorldFile, ReadsCsvWithCommentsAndEmptyLines) {
  const World world = read_world_file(
      write("yard.csv",
            "# my yard\nkind,x,y\n\nwaypoint, 1, 2 # first\nwaypoint,3,4\nlandmark,-5.5,+6e1\n"));
  EXPECT_EQ(world.name, "yard");
  EXPECT_EQ(read_world_file(write("sheet.csv",
                                  "\xEF\xBB\xBFkind,x,y\nwaypoint,1,2\nwaypoint,3,4\n"
                                  "landmark,1,2\n"))
                .waypoints.size(),
            2U)
      << "as spreadsheets save it";
  ASSERT_EQ(world.waypoints.size(), 2U);
  EXPECT_EQ(world.waypoints[1], Eigen::Vector2d(3, 4));
  ASSERT_EQ(world.landmarks.size(), 1U);
  EXPECT_EQ(world.landmarks[0], Eigen::Vector2d(-5.5, 60));
}

TEST_F(WorldFile, NamesFileLineReasonAndRemedy) {
  const std::string head = "kind,x,y\nwaypoint,1,2\nwaypoint,3,4\n";
  EXPECT_THAT(complaint(head + "landmark,1\n"),
              AllOf(HasSubstr("bad.csv:4"), HasSubstr("2 fields")));
  EXPECT_THAT(complaint(head + "landmrk,1,2\n"),
              AllOf(HasSubstr("bad.csv:4"), HasSubstr("did you mean landmark?")));
  EXPECT_THAT(complaint(head + "landmark,nan,2\n"),
              AllOf(HasSubstr("bad.csv:4"), HasSubstr("'nan' is no coordinate")));
  EXPECT_THAT(complaint(head + "landmark,1.5m,2\n"), HasSubstr("'1.5m' is no coordinate"));
  EXPECT_THAT(complaint(head + "landmark,1e9,2\n"), HasSubstr("landmark 1 is no place"));
  EXPECT_THAT(complaint(head), HasSubstr("no landmarks"));
  EXPECT_THAT(complaint("kind,x,y\nwaypoint,1,2\nlandmark,1,2\n"),
              HasSubstr("1 way-points (a drive needs at least two)"));
  EXPECT_THAT(complaint("x,y\n1,2\n"),
              AllOf(HasSubstr("bad.csv:1"), HasSubstr("begin with kind,x,y")));
  EXPECT_THAT(complaint(""), HasSubstr("empty (the first row names the columns)"));
}

TEST_F(WorldFile, SaysWhatThereIsWhereAWorldIsMissing) {
  EXPECT_THROW(read_world_file(folder_ / "absent.csv"), StudyError);
  try {
    find_world("map.mat", {write("map.mat", "MATLAB 5.0").parent_path()});
    ADD_FAILURE() << "a MATLAB file was read";
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("map.mat"), HasSubstr("convert/world.py")));
  }
  try {
    find_world("web_lop");
    ADD_FAILURE() << "a world of that name exists";
  } catch (const StudyError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean web_loop?"));
  }
}

TEST_F(WorldFile, LooksInTheStudysFolderFirst) {
  write("mine.csv", "kind,x,y\nwaypoint,1,2\nwaypoint,3,4\nlandmark,7,8\n");
  EXPECT_EQ(find_world("mine.csv", {folder_}).landmarks[0], Eigen::Vector2d(7, 8));
}

TEST(ShippedWorlds, AreWhatTheyPromise) {
  EXPECT_THAT(shipped_worlds(), testing::ElementsAre("dense_loop", "small_loop", "web_loop"));
  EXPECT_EQ(find_world("web_loop").landmarks.size(), 35U);
  EXPECT_EQ(find_world("web_loop").waypoints.size(), 17U);
  EXPECT_EQ(find_world("dense_loop").landmarks.size(), 135U);
  EXPECT_EQ(find_world("small_loop").landmarks.size(), 15U);
}

}  // namespace
}  // namespace montecarta::experiments
