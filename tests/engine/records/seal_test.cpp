// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/seal.hpp"

#include "engine/errors.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/recorded_drives.hpp"
#include "tests/doubles/result_writing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

namespace montecarta::engine {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class SealOfResult : public ResultWriting {
 protected:
  void put(const std::filesystem::path& path, const std::string& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  /// Ranges that are left open in the result at `path`.
  std::vector<ByteRange> open_ranges(const std::filesystem::path& path) const {
    const ResultDescription description = read_description(h5::open_file(path), path);
    return written_later(find_slabs(path, description), description.runs.size());
  }
  std::string refusal(const std::filesystem::path& path) const {
    return message<StudyError>([&] { check_seal(path); });
  }
};

TEST_F(SealOfResult, HoldsWhateverIsWrittenLater) {
  begin();
  EXPECT_EQ(check_seal(part_), Seal::holds) << "work in progress";
  {
    ResultWriter writer = resume();
    store_run(writer, plan_, 1);
    writer.spare(0, 2);
    writer.spare(1, 2);
    writer.note_wall_seconds(2.0);
    writer.finish();
  }
  EXPECT_EQ(check_seal(path_), Seal::holds) << "resumed, with a log of it, and finished";
  for (std::uint64_t run = 0; run < 3; ++run) {
    write_result(folder_ / ("shard" + std::to_string(run)), part_of_plan(plan_, run, run + 1));
  }
  merge_results(folder_ / "merged.h5", {folder_ / "shard2", folder_ / "shard0", folder_ / "shard1"},
                Existing::refuse);
  EXPECT_EQ(check_seal(folder_ / "merged.h5"), Seal::holds);
  {
    ResultWriter first = ResultWriter::attempt(folder_ / "tried.h5", plan_, {});
    store_run(first, plan_, 0);
    ResultWriter second = ResultWriter::attempt(folder_ / "tried.h5", plan_, {});
    for (std::uint64_t run = 1; run < 3; ++run) store_run(second, plan_, run);
    second.finish();
  }
  EXPECT_EQ(check_seal(folder_ / "tried.h5"), Seal::holds);
}

TEST_F(SealOfResult, HoldsWithLandmarksOfRunsAndWithoutTruth) {
  plan_.own_landmarks = [this](std::uint64_t) { return plan_.drives->itinerary().landmarks; };
  write_result(path_, plan_);
  EXPECT_EQ(check_seal(path_), Seal::holds);
  plan_.own_landmarks = nullptr;
  plan_.drives = std::make_shared<RecordedDrives>(24);
  write_result(folder_ / "recorded.h5", plan_);
  EXPECT_EQ(check_seal(folder_ / "recorded.h5"), Seal::holds);
}

TEST_F(SealOfResult, LeavesOpenWhatIsWrittenLaterAndNothingElse) {
  write_result(path_, plan_);
  const std::string good = bytes_of(path_);
  const std::vector<ByteRange> ranges = open_ranges(path_);
  const auto is_open = [&](std::size_t at) {
    return std::ranges::any_of(
        ranges, [&](const ByteRange& r) { return at >= r.offset && at - r.offset < r.length; });
  };
  std::size_t closed = 0;
  const PosixFile file(path_, PosixFile::Mode::write);
  const std::size_t seal = good.rfind("\x89MCSEAL\n");
  for (std::size_t at = 0; at < good.size(); at += at < seal ? 1 + at % 61 : 1) {
    const std::byte changed{static_cast<unsigned char>(good[at] ^ 0x10)};
    file.write_at(at, std::span(&changed, 1));
    if (is_open(at)) {
      EXPECT_EQ(check_seal(path_), Seal::holds) << at;
    } else {
      EXPECT_THAT(refusal(path_), HasSubstr(path_.string())) << at;
      ++closed;
    }
    file.write_at(at, std::as_bytes(std::span(&good[at], 1)));
  }
  EXPECT_GT(closed, 500U);
  std::uint64_t left_open = 0, end = 0;
  for (const ByteRange& range : ranges) {
    EXPECT_GT(range.offset, end) << "ranges that touch are one";
    end = range.offset + range.length;
    left_open += range.length;
  }
  EXPECT_LT(good.size() - left_open, 200'000U) << "runs are not read when a file is opened";
}

TEST_F(SealOfResult, TellsAFileThatWasCutShort) {
  write_result(path_, plan_);
  const std::string good = bytes_of(path_);
  const auto cut = folder_ / "cut.h5";
  for (std::size_t length = 0; length < good.size(); length += 1 + length / 3) {
    put(cut, good.substr(0, length));
    EXPECT_THAT(refusal(cut), StartsWith(cut.string() + ": ")) << length;
    put(cut, good.substr(0, good.size() - 1 - length / 4));
    EXPECT_THAT(refusal(cut), HasSubstr("damaged")) << length;
  }
  put(cut, good + "x");
  EXPECT_THAT(refusal(cut), HasSubstr("the seal at its end is not whole"));
}

TEST_F(SealOfResult, IsNotAskedOfFilesThatHaveNone) {
  const auto older = folder_ / "older.h5";
  lay_out(older, describe(plan_, {}));
  EXPECT_EQ(check_seal(older), Seal::absent);
  EXPECT_EQ(ResultFile(older).runs().size(), 3U);
  if (!installed("h5repack")) GTEST_SKIP() << "h5repack (hdf5-tools) is not installed";
  write_result(path_, plan_);
  const auto packed = folder_ / "packed.h5";
  ASSERT_EQ(run_program("h5repack -f GZIP=1 " + path_.string() + " " + packed.string()).status, 0);
  EXPECT_EQ(check_seal(packed), Seal::absent);
  EXPECT_EQ(ResultFile(packed).runs().size(), 3U);
}

TEST_F(SealOfResult, RefusesWhatIsNoHdf5) {
  put(path_, "");
  EXPECT_THAT(refusal(path_), HasSubstr("not a readable HDF5 file"));
  put(path_, std::string(5000, 'x'));
  EXPECT_THAT(refusal(path_), HasSubstr("not a readable HDF5 file"));
  EXPECT_THAT(refusal(folder_.path()), HasSubstr("not a readable HDF5 file"));
  EXPECT_THAT(refusal(folder_ / "absent.h5"), HasSubstr("cannot open it"));
}

/// No few bytes make a sealed file count as one without a seal.
TEST_F(SealOfResult, IsNotLostByDamage) {
  write_result(path_, plan_);
  const std::string good = bytes_of(path_);
  const auto spoilt = folder_ / "spoilt.h5";
  std::size_t refused = 0;
  for (std::uint64_t seed = 0; seed < damaged_files(500); ++seed) {
    Dice dice(seed);
    std::string bytes = good;
    set_word(bytes, dice.below(64), extreme_word(dice));
    bytes[dice.below(64)] = static_cast<char>(dice.below(256));
    if (bytes == good) continue;
    put(spoilt, bytes);
    EXPECT_THAT(refusal(spoilt), HasSubstr(spoilt.string())) << seed;
    ++refused;
  }
  EXPECT_GT(refused, 400U);
}

}  // namespace
}  // namespace montecarta::engine
