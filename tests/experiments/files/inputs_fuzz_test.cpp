// SPDX-License-Identifier: BSD-3-Clause
// Damaged studies, worlds, estimates and recorded drives: read, or refused with the name of the
// file.
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/read_rows.hpp"
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"
#include "experiments/worlds/world.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFuzzedWorld =
    "# a yard\nkind,x,y\nwaypoint,10,0\nwaypoint,20,1\nlandmark,15,5\nlandmark,25,-4.5\n";

/// Damages a file `cases` times; returns how often it was refused, with `name` in the message.
std::size_t refused(const fs::path& path, const std::string& name, std::uint64_t cases,
                    const std::function<void()>& read) {
  const std::string good = engine::text_in(path);
  std::size_t count = 0;
  for (std::uint64_t seed = 0; seed < damaged_files(cases); ++seed) {
    SCOPED_TRACE(path.filename().string() + " seed " + std::to_string(seed));
    write_text(path, damaged_text(good, seed));
    const std::string said = complaint_of(read);
    EXPECT_TRUE(said == "nothing" || said.find(name) != said.npos) << said;
    count += said != "nothing" ? 1 : 0;
  }
  write_text(path, good);
  return count;
}

using Reader = std::function<void(const fs::path&)>;

/// Most of 1000 damaged files of this text are refused.
void expect_refusals(const std::string& name, const std::string& text, const Reader& read) {
  const ScratchFolder folder;
  const fs::path path = folder / name;
  write_text(folder / "yard.csv", kFuzzedWorld);
  write_text(path, text);
  EXPECT_GT(refused(path, name, 1000, [&] { read(path); }), 250U);
}

TEST(InputsFuzz, WorldCsv) {
  expect_refusals("yard.csv", kFuzzedWorld, [](const fs::path& path) { read_world_file(path); });
}

TEST(InputsFuzz, Estimates) {
  expect_refusals("estimate.csv",
                  "time_s,x_m,qual,cov_0_0,cov_1_0,cov_1_1\n0.5,1,2,3,0.5,4\n1.5,1,2,3,0.5,4\n",
                  [](const fs::path& path) { read_estimates(path); });
}

TEST(InputsFuzz, Innovations) {
  expect_refusals("innovation.csv",
                  "time_s,r_m,b_rad,cov_0_0,cov_1_0,cov_1_1\n1,1,2,3,0.5,4\n2,1,2,3,0.5,4\n",
                  [](const fs::path& path) {
                    StateRows rows;
                    rows.time = {1.0, 2.0};
                    read_innovations(path, "estimate.csv", 1e-6, rows);
                  });
}

TEST(InputsFuzz, Study) {
  expect_refusals("blink.ini",
                  "[study]\nname = blink\ntitle = A blink\nruns = 3\nuntil = position_rmse < 0.02\n"
                  "[scenario]\nworld = yard.csv\nnoise = matched\nscan_rate = 5 # Hz\n"
                  "[association]\nkind = nearest\n[record]\ncolumns = pose, covariance\n"
                  "[cells]\ncell = ekf_slam\ncell = fastslam2 particles=3,10 motion_noise=1,2\n",
                  [](const fs::path& path) { resolved_text(read_study(path, known_filters())); });
}

void expect_order_and_limits(const DriveLog& log) {
  EXPECT_TRUE(std::ranges::is_sorted(log.odometry, std::ranges::less_equal(), &Odometry::time));
  EXPECT_TRUE(std::ranges::is_sorted(log.scans, std::ranges::less_equal(), &LoggedScan::time));
  for (const Odometry& odometry : log.odometry) {
    for (std::size_t c = 0; c < log.controls.size(); ++c)
      EXPECT_LE(std::abs(odometry.control[c]), component_of(log.controls[c]).most);
  }
  for (const LoggedScan& scan : log.scans) {
    for (const Detection& detection : scan.detections) {
      for (std::size_t i = 0; i < log.components.size(); ++i)
        EXPECT_LE(std::abs(detection[i]), component_of(log.components[i]).most);
    }
  }
}

// The reader returns a log that can be, or names the fault.
TEST(ReadersFuzz, CsvLogs) {
  const ScratchFolder folder;
  write_log_csv(full_log(), folder / "log");
  std::size_t count = 0;
  std::vector<fs::path> files(fs::directory_iterator(folder / "log"), {});
  std::ranges::sort(files);
  for (const fs::path& path : files) {
    count += refused(path, (folder / "log").string(), 200,
                     [&] { expect_order_and_limits(read_log_csv(folder / "log")); });
  }
  EXPECT_GT(count, 300U);
}

}  // namespace
}  // namespace montecarta::experiments
