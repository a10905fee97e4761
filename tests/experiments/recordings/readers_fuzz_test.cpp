// SPDX-License-Identifier: BSD-3-Clause
// Damaged logs: the reader gives a log that passes its check, or says what is wrong.
#include "experiments/recordings/drive_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Damages each file of the folder `cases` times; returns how many damaged drives were refused.
std::size_t refused(const fs::path& folder, std::uint64_t cases) {
  std::size_t count = 0;
  std::vector<fs::path> files(fs::directory_iterator(folder), {});
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    const std::string good = bytes_of(path);
    for (std::uint64_t seed = 0; seed < damaged_files(cases); ++seed) {
      write_text(path, damaged_text(good, seed));
      SCOPED_TRACE(path.filename().string() + " seed " + std::to_string(seed));
      const std::string said = complaint_of([&] { check_log(read_log_csv(folder), "read"); });
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
  EXPECT_GT(refused(folder / "log", 400), 600U);
}

}  // namespace
}  // namespace montecarta::experiments
