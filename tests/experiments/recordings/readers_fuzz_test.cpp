// SPDX-License-Identifier: BSD-3-Clause
// Damaged files: each reader gives a log that passes its check, or says what is wrong.
#include "experiments/recordings/car_park.hpp"
#include "experiments/recordings/check_log.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/victoria_park.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/small_drives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <iterator>
#include <vector>

namespace montecarta {
namespace {

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Whole numbers below a bound from a counter of its own.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(seed) {}
  std::size_t below(std::size_t bound) {  // splitmix64
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15U);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return static_cast<std::size_t>((z ^ (z >> 31U)) % bound);
  }

 private:
  std::uint64_t state_;
};

void mutate(std::string& bytes, Dice& dice) {
  if (bytes.empty()) return;
  const std::size_t at = dice.below(bytes.size());
  const std::size_t length = 1 + dice.below(12);
  switch (dice.below(6)) {
    case 0:
      bytes.erase(at, length);
      break;
    case 1:
      bytes.insert(at, bytes.substr(at, length));
      break;
    case 2:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.below(8)));
      break;
    case 3:
      bytes[at] = static_cast<char>(dice.below(256));
      break;
    case 4:
      bytes[at % 256 % bytes.size()] = static_cast<char>(dice.below(256));
      break;
    default:
      bytes.resize(dice.below(4) == 0 ? at : bytes.size());
  }
}

using Reader = std::function<DriveLog(const fs::path&)>;

/// Damages each file of the folder `cases` times; returns how many damaged drives were refused.
std::size_t refused(const fs::path& folder, const Reader& read, std::uint64_t cases) {
  std::size_t count = 0;
  std::vector<fs::path> files(fs::directory_iterator(folder), {});
  std::sort(files.begin(), files.end());
  for (const fs::path& path : files) {
    const std::string good = bytes_of(path);
    for (std::uint64_t seed = 0; seed < cases; ++seed) {
      Dice dice(seed);
      std::string bytes = good;
      for (std::size_t n = 1 + dice.below(3); n > 0; --n) mutate(bytes, dice);
      write_text(path, bytes);
      SCOPED_TRACE(path.filename().string() + " seed " + std::to_string(seed));
      const std::string said = complaint_of([&] { check_log(read(folder), "read"); });
      EXPECT_FALSE(said.starts_with("read")) << "a log that does not pass: " << said;
      count += said != "nothing" ? 1 : 0;
    }
    write_text(path, good);
  }
  return count;
}

TEST(ReadersFuzz, CsvLogs) {
  const ScratchFolder folder;
  write_log_csv(full_log(), folder / "log");
  EXPECT_GT(refused(folder / "log", read_log_csv, 40), 60U);
}

TEST(ReadersFuzz, VictoriaParkText) {
  const ScratchFolder folder;
  write_small_park(folder.path());
  const auto read = [](const fs::path& path) {
    return read_victoria_park(path, Steering::calibrated);
  };
  EXPECT_GT(refused(folder.path(), read, 60), 100U);
}

TEST(ReadersFuzz, VictoriaParkMat) {
  const ScratchFolder folder;
  add_small_park_mat(folder.path());
  add_small_laser_mat(folder.path());
  const auto read = [](const fs::path& path) { return read_victoria_park(path, Steering::raw); };
  EXPECT_GT(refused(folder.path(), read, 150), 100U);
}

TEST(ReadersFuzz, CarPark) {
  const ScratchFolder folder;
  write_small_car_park(folder.path());
  EXPECT_GT(refused(folder.path(), read_car_park, 100), 100U);
}

}  // namespace
}  // namespace montecarta
