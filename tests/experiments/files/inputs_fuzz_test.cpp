// SPDX-License-Identifier: BSD-3-Clause
// Damaged studies, worlds and estimates: read, or refused with the name of the file. (Damaged
// recorded drives: recordings/readers_fuzz_test.cpp.)
#include "experiments/judging/state_rows.hpp"
#include "experiments/study/study.hpp"
#include "experiments/worlds/world.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <iterator>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorld =
    "# a yard\nkind,x,y\nwaypoint,10,0\nwaypoint,20,1\nlandmark,15,5\nlandmark,25,-4.5\n";

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Damages a file `cases` times; returns how often it was refused.
std::size_t refused(const fs::path& path, std::uint64_t cases, const std::function<void()>& read) {
  const std::string good = text_of(path);
  std::size_t count = 0;
  for (std::uint64_t seed = 0; seed < damaged_files(cases); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    write_text(path, damaged_text(good, seed));
    const std::string said = complaint_of(read);
    EXPECT_TRUE(said == "nothing" || said.find(path.filename()) != said.npos) << said;
    count += said != "nothing" ? 1 : 0;
  }
  return count;
}

TEST(InputsFuzz, WorldCsv) {
  const ScratchFolder folder;
  const fs::path path = folder / "yard.csv";
  write_text(path, kWorld);
  EXPECT_GT(refused(path, 2000, [&] { read_world_file(path); }), 500U);
}

TEST(InputsFuzz, Estimates) {
  const ScratchFolder folder;
  const fs::path path = folder / "estimate.csv";
  write_text(path, "time_s,x_m,qual,cov_0_0,cov_1_0,cov_1_1\n0.5,1,2,3,0.5,4\n1.5,1,2,3,0.5,4\n");
  EXPECT_GT(refused(path, 2000, [&] { read_estimates(path); }), 500U);
}

TEST(InputsFuzz, Innovations) {
  const ScratchFolder folder;
  const fs::path path = folder / "innovation.csv";
  write_text(path, "time_s,r_m,b_rad,cov_0_0,cov_1_0,cov_1_1\n1,1,2,3,0.5,4\n2,1,2,3,0.5,4\n");
  const auto read = [&] {
    StateRows rows;
    rows.time = {1.0, 2.0};
    read_innovations(path, "estimate.csv", 1e-6, rows);
  };
  EXPECT_GT(refused(path, 2000, read), 500U);
}

TEST(InputsFuzz, Study) {
  const ScratchFolder folder;
  const fs::path path = folder / "blink.ini";
  write_text(folder / "yard.csv", kWorld);
  write_text(
      path,
      "[study]\nname = blink\ntitle = A blink\nruns = 3\nuntil = position_rmse < 0.02\n"
      "[scenario]\nworld = yard.csv\nnoise = matched\nscan_rate = 5 # Hz\n"
      "[association]\nkind = nearest\n[record]\ncolumns = pose, covariance\n"
      "[cells]\ncell = ekf_slam\ncell = fastslam2 particles=3,10 motion_noise=1,2\n");
  EXPECT_GT(refused(path, 2000, [&] { resolved_text(read_study(path)); }), 500U);
}

}  // namespace
}  // namespace montecarta::experiments
