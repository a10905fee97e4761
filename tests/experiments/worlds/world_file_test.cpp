// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/worlds/world.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <fstream>
#include <string>

namespace montecarta::experiments {
namespace {

class WorldFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// The complaint about `text` as a CSV world.
  std::string complaint(const std::string& text) const {
    return complaint_of([&] { read_world_file(write("bad.csv", text)); });
  }
  ScratchFolder folder_;
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
  EXPECT_THAT(complaint(head + "landmark,1\n"), HasSubstr("bad.csv:4"));
  EXPECT_THAT(complaint(head + "landmrk,1,2\n"), HasSubstr("bad.csv:4"));
  EXPECT_THAT(complaint(head + "landmark,nan,2\n"), HasSubstr("bad.csv:4"));
  EXPECT_THAT(complaint(head + "landmark,1.5m,2\n"), HasSubstr("'1.5m' is no coordinate"));
  EXPECT_THAT(complaint(head + "landmark,1e9,2\n"), HasSubstr("landmark 1 is no place"));
  EXPECT_THAT(complaint(head), HasSubstr("no landmarks"));
  EXPECT_THAT(complaint("kind,x,y\nwaypoint,1,2\nlandmark,1,2\n"), HasSubstr("1 way-points (a"));
  EXPECT_THAT(complaint("x,y\n1,2\n"), HasSubstr("bad.csv:1"));
  EXPECT_THAT(complaint(""), HasSubstr("empty (the first row names the columns)"));
}

TEST_F(WorldFile, LooksInTheStudysFolderFirstAndSaysWhatThereIs) {
  EXPECT_THROW(read_world_file(folder_ / "absent.csv"), StudyError);
  const auto folder = write("map.mat", "MATLAB 5.0").parent_path();
  EXPECT_THAT(complaint_of([&] { find_world("map.mat", {folder}); }),
              HasSubstr("convert/world.py"));
  EXPECT_THAT(complaint_of([] { find_world("web_lop"); }), HasSubstr("did you mean web_loop?"));
  write("mine.csv", "kind,x,y\nwaypoint,1,2\nwaypoint,3,4\nlandmark,7,8\n");
  EXPECT_EQ(find_world("mine.csv", {folder_.path()}).landmarks[0], Eigen::Vector2d(7, 8));
}

TEST(ShippedWorlds, AreWhatTheyPromise) {
  EXPECT_THAT(shipped_worlds(), testing::ElementsAre("dense_loop", "small_loop", "web_loop"));
}

}  // namespace
}  // namespace montecarta::experiments
