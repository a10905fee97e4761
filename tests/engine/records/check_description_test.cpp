// SPDX-License-Identifier: BSD-3-Clause
// Files without a seal and with contradictory numbers are refused when they are opened.
#include "engine/records/check_description.hpp"

#include "engine/errors.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/result_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/result_schema.hpp"
#include "engine/records/seal.hpp"
#include "engine/records/shard.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/doubles/recorded_drives.hpp"
#include "tests/doubles/result_writing.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

namespace montecarta::engine {
namespace {

class CheckDescription : public ResultWriting {
 protected:
  struct Refused {
    std::function<void(ResultDescription&)> change;
    std::string words;
  };
  /// Files that are laid out by a changed description are refused with these words.
  void expect_refusals(const std::vector<Refused>& cases) const {
    for (const auto& [change, words] : cases) {
      ResultDescription description = describe(plan_, {});
      change(description);
      lay_out(path_, description);
      EXPECT_THAT(complaint_of([&] { ResultFile{path_}; }),
                  AllOf(HasSubstr(path_.string()), HasSubstr(words)));
    }
  }
};

TEST_F(CheckDescription, LetsAGoodOnePass) {
  for (const bool scans_only : {false, true}) {
    plan_.columns.scans_only = scans_only;
    plan_.columns.joint = plan_.cells[0].reports.joint = true;
    EXPECT_NO_THROW(check_description(describe(plan_, {}), "out.h5"));
  }
}

TEST_F(CheckDescription, RefusesRunsAndTimesThatAreNone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  expect_refusals({
      {[](auto& d) {
         d.runs = {0, 2, 1};
       },
       "run numbers"},
      {[](auto& d) { d.study_runs = 2; }, "beyond the study's runs"},
      {[](auto& d) { d.times[3] = -1.0; }, "times do not increase"},
      {[=](auto& d) { d.times[3] = nan; }, "times do not increase"},
      {[=](auto& d) { d.times.back() = infinite; }, "times do not increase"},
      {[](auto& d) { d.scan_rows.pop_back(); }, "not equally long"},
      {[](auto& d) { d.scan_rows.back() = 4'000'000'000U; }, "scan_row is beyond"},
      {[](auto& d) { d.scan_rows[0] = d.scan_rows[1]; }, "increase"},
      {[](auto& d) { d.scan_steps.back() = 4'000'000'000U; }, "scan_step is beyond"},
      {[](auto& d) { ++d.scan_steps.back(); }, "neither scan_step"},
      {[](auto& d) { d.scan_times[0] += 1e-9; }, "scan is not time"},
      {[=](auto& d) { d.start.x = infinite; }, "no places"},
  });
  plan_.columns.joint = plan_.cells[0].reports.joint = true;
  ResultDescription description = describe(plan_, {});
  description.joint_scans.back() = 4000;
  EXPECT_THAT(complaint_of([&] { check_description(description, path_); }),
              HasSubstr("joint_scan"));
}

Column& column_of(ResultDescription& d, std::string_view name) {
  return *std::ranges::find(d.cells[0].columns, name, &Column::name);
}

/// Takes a column away.
auto without(std::string_view name) {
  return [=](ResultDescription& d) {
    d.cells[0].usual_columns -= std::erase_if(
        d.cells[0].columns, [&](const Column& column) { return column.name == name; });
  };
}

TEST_F(CheckDescription, RefusesColumnsThatDoNotFitTheirAxes) {
  const auto of_time = [](ResultDescription& d) {
    column_of(d, "nis").axes = {Axis::time};
    column_of(d, "nis").shape = {d.times.size()};
  };
  expect_refusals({
      {[](auto& d) { --column_of(d, "pose_mean").shape[0]; }, "pose_mean"},
      {[](auto& d) { ++column_of(d, "map_mean").shape[1]; }, "map_"},
      {[](auto& d) { ++d.cells[0].particles; }, "axis particle"},
      {of_time, "nis has other axes"},
      {without("nis_dof"), "only a part of nis"},
      {without("pose_mean"), "has no pose_mean"},
      {without("pose_covariance"), "no pose_covariance"},
      {[](auto& d) { d.cells[0].label = std::string(1001, 'x'); }, "too long"},
  });
}

// They stand in LaTeX comments, in scripts and on terminals.
TEST_F(CheckDescription, RefusesTextsThatAreNotOneLine) {
  expect_refusals({
      {[](auto& d) { d.study_name = "a\n\\input{/etc/passwd}"; }, "character in 'a\\n"},
      {[](auto& d) { d.title = "\x1b[2J"; }, "'\\x1b[2J'"},
      {[](auto& d) { d.cells[0].long_name = "\r"; }, "\\x0d"},
  });
}

TEST_F(CheckDescription, HoldsErrorsOfAnyDimension) {
  plan_.cells[0].imported = ImportedError{.components = 4};
  ResultDescription good = describe(plan_, {});
  EXPECT_NO_THROW(check_description(good, "out.h5"));
  for (const char* name : {"pose_mean", "pose_covariance", "ess", "nis"})
    EXPECT_FALSE(good.cells[0].has(name)) << name;
  EXPECT_EQ(column_of(good, "error").shape.back(), 4U);
  expect_refusals({{[](auto& d) { column_of(d, "error_covariance").shape.back() = 3; },
                    "error_covariance is not as long as its axis"},
                   {without("error"), "only a part of error"}});
}

TEST_F(CheckDescription, RefusesReferencesThatAreNone) {
  plan_.drives = std::make_shared<RecordedDrives>(24);
  expect_refusals({
      {[](auto& d) { d.references[0].heading.pop_back(); }, "other fixes than times"},
      {[](auto& d) { d.references[0].position.pop_back(); }, "other fixes than times"},
      {[](auto& d) { d.references[1].position[2].y() = std::nan(""); }, "coarse is no place"},
  });
}

/// The file is refused or can be read for any value of one number.
TEST_F(CheckDescription, FindsEveryOddNumber) {
  for (std::uint64_t seed = 0; seed < damaged_files(200); ++seed) {
    Dice dice(seed);
    ResultDescription description = describe(plan_, {});
    const std::uint64_t word = extreme_word(dice);
    const auto put = [&](auto& values) {
      using Number = std::decay_t<decltype(values[0])>;
      std::memcpy(&values[dice.below(values.size())], &word, sizeof(Number));
    };
    const std::size_t which = dice.below(6);
    if (which == 0) put(description.runs);
    if (which == 1) put(description.times);
    if (which == 2) put(description.scan_times);
    if (which == 3) put(description.scan_steps);
    if (which == 4) put(description.scan_rows);
    if (which == 5) description.study_runs = word;
    try {
      check_description(description, path_);
    } catch (const StudyError& error) {
      EXPECT_THAT(error.what(), HasSubstr(path_.string())) << seed;
      continue;
    }
    lay_out(path_, description);
    const ResultFile file(path_);
    for (const std::uint32_t row : file.scan_rows()) EXPECT_LT(row, file.times().size());
  }
}

class SealOfResult : public ResultWriting {
 protected:
  void put(const std::filesystem::path& path, const std::string& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  /// Ranges that are left open in the result at `path`.
  std::vector<ByteRange> open_ranges(const std::filesystem::path& path) const {
    const ResultDescription description = read_description(path);
    return written_later(find_slabs(path, description));
  }
  std::string refusal(const std::filesystem::path& path) const {
    return complaint_of([&] { check_seal(path); });
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
  const std::string good = text_in(path_);
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
  const std::string good = text_in(path_);
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
  const std::string good = text_in(path_);
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
