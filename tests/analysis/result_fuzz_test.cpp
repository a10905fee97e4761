// SPDX-License-Identifier: BSD-3-Clause
// Damaged result files: refused with the name of the file, or analysed to the end.
#include "analysis/render/page/replay/replay.hpp"
#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/errors.hpp"
#include "engine/records/check_file.hpp"
#include "engine/records/result_layout.hpp"
#include "engine/records/shard.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/damage.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <sstream>

namespace montecarta::analysis {
namespace {

class ResultFuzz : public testing::Test {
 protected:
  ResultFuzz() {
    write_synthetic_result(path_, 5, 24, {}, store_everything);
    std::ifstream file(path_, std::ios::binary);
    good_.assign(std::istreambuf_iterator<char>(file), {});
  }

  /// Everything that is left open by the seal.
  std::vector<ByteRange> open_ranges() const {
    const ResultDescription description = read_description(path_);
    return written_later(find_slabs(path_, description));
  }
  /// Returns whether a file of these bytes is refused. Tables take longer than all else.
  bool is_refused(const std::string& bytes, bool with_tables = false) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    try {
      const ResultFile file(path_);
      const StudyAnalysis study = analyze(file);
      std::ostringstream tables;
      if (with_tables) print_all(tables, study, 80);
      read_replay(file, file.runs().size() - 1);
      return false;
    } catch (const StudyError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos) << error.what();
    } catch (const RunError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos) << error.what();
    }
    return true;
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "out.h5";
  std::string good_;
};

TEST_F(ResultFuzz, AnyBytes) {
  const std::uint64_t cases = damaged_files(60);
  std::size_t refused = 0;
  for (std::uint64_t seed = 0; seed < cases; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ASSERT_NO_THROW(refused += is_refused(damaged(good_, seed), seed % 8 == 0) ? 1 : 0);
  }
  EXPECT_GT(refused, cases / 4);
  EXPECT_LT(refused, cases);
}

/// The bytes that the seal does not cover.
TEST_F(ResultFuzz, NumbersOfRuns) {
  const std::vector<ByteRange> ranges = open_ranges();
  for (std::uint64_t seed = 0; seed < damaged_files(60); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Dice dice(seed);
    std::string bytes = good_;
    for (std::size_t n = 1 + dice.below(20); n > 0; --n) {
      const ByteRange& range = ranges[dice.below(ranges.size())];
      if (range.length < 8) continue;
      set_word(bytes, range.offset + dice.below(range.length / 8) * 8, extreme_word(dice));
    }
    ASSERT_NO_THROW(is_refused(bytes, seed % 8 == 0));
  }
}

}  // namespace
}  // namespace montecarta::analysis
