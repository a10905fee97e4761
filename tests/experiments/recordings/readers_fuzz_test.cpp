// SPDX-License-Identifier: BSD-3-Clause
// Damaged files: each reader gives a log that passes its check, or says what is wrong.
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/published_drives.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

using Reader = std::function<DriveLog(const fs::path&)>;

/// Damages each file of the folder `cases` times; returns how many damaged drives were refused.
std::size_t refused(const fs::path& folder, const Reader& read, std::uint64_t cases) {
  std::size_t count = 0;
  std::vector<fs::path> files(fs::directory_iterator(folder), {});
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    const std::string good = bytes_of(path);
    const bool is_text = path.extension() != ".mat";
    for (std::uint64_t seed = 0; seed < damaged_files(cases); ++seed) {
      write_text(path, is_text ? damaged_text(good, seed) : damaged(good, seed));
      SCOPED_TRACE(path.filename().string() + " seed " + std::to_string(seed));
      const std::string said = complaint_of([&] { check_log(read(folder), "read"); });
      EXPECT_FALSE(said.starts_with("read")) << "a log that does not pass: " << said;
      EXPECT_TRUE(said == "nothing" || said.find(folder.string()) != said.npos) << said;
      count += said != "nothing" ? 1 : 0;
    }
    write_text(path, good);
  }
  return count;
}

TEST(ReadersFuzz, CsvLogs) {
  const ScratchFolder folder;
  write_log_csv(full_log(), folder / "log");
  EXPECT_GT(refused(folder / "log", read_log_csv, 400), 600U);
}

TEST(ReadersFuzz, VictoriaParkText) {
  const ScratchFolder folder;
  write_small_park(folder.path());
  const auto read = [](const fs::path& path) {
    return read_victoria_park(path, Steering::calibrated);
  };
  EXPECT_GT(refused(folder.path(), read, 500), 800U);
}

TEST(ReadersFuzz, VictoriaParkMat) {
  const ScratchFolder folder;
  add_small_park_mat(folder.path());
  add_small_laser_mat(folder.path());
  const auto read = [](const fs::path& path) { return read_victoria_park(path, Steering::raw); };
  EXPECT_GT(refused(folder.path(), read, 700), 500U);
}

TEST(ReadersFuzz, CarPark) {
  const ScratchFolder folder;
  write_small_car_park(folder.path());
  EXPECT_GT(refused(folder.path(), read_car_park, 700), 700U);
}

}  // namespace
}  // namespace montecarta::experiments
