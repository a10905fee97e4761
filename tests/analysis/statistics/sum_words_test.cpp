// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sum_words.hpp"

#include "engine/errors.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace montecarta::analysis {
namespace {

struct WordsOfScan {
  double sum = 0.0;
  std::uint32_t n = 0;
  static constexpr auto members() { return std::tuple(&WordsOfScan::sum, &WordsOfScan::n); }
};

struct WordsOfCell {
  std::size_t dimension = 0, scratch = 0;
  std::vector<WordsOfScan> scans;
  std::array<std::optional<Eigen::Vector3d>, 2> moments;
  std::vector<double> first_runs;
  std::size_t most() const { return 3; }
  static constexpr auto parts() {
    return std::tuple(settings(&WordsOfCell::dimension),
                      added(&WordsOfCell::scans, &WordsOfCell::moments),
                      appended_up_to(&WordsOfCell::most, &WordsOfCell::first_runs));
  }
};

WordsOfCell example_sums() {
  WordsOfCell outer{.dimension = 3,
                    .scratch = 7,
                    .scans = {{0.5, 1}, {-0.0, 4}},
                    .moments = {},
                    .first_runs = {1.0, 2.0}};
  outer.moments[1] = Eigen::Vector3d(1.0, 2.0, 3.0);
  return outer;
}

Words words_for(const WordsOfCell& outer,
                SumWriter::FirstRuns first_runs = SumWriter::FirstRuns::keep) {
  SumWriter writer(first_runs);
  writer.put(outer);
  return writer.take();
}

TEST(SumWords, GiveBackWhatWasWritten) {
  const Words words = words_for(example_sums());
  WordsOfCell read;
  SumReader reader(words);
  reader.get(read);
  reader.expect_end();
  EXPECT_EQ(words_for(read), words);
  EXPECT_EQ(read.dimension, 3U);
  EXPECT_EQ(read.scratch, 0U);
  EXPECT_EQ(read.scans[1].n, 4U);
  EXPECT_FALSE(read.moments[0]);
  EXPECT_EQ((*read.moments[1])(2), 3.0);
  EXPECT_EQ(read.first_runs, example_sums().first_runs);
}

TEST(SumWords, LeaveOutTheFirstRunsOfOtherGroups) {
  const Words words = words_for(example_sums(), SumWriter::FirstRuns::leave_out);
  WordsOfCell read;
  SumReader(words).get(read);
  EXPECT_TRUE(read.first_runs.empty());
  EXPECT_EQ(read.scans.size(), 2U);
}

TEST(SumWords, AreRefusedWhereverTheyAreCutShort) {
  const Words words = words_for(example_sums());
  for (std::size_t length = 0; length < words.size(); ++length) {
    WordsOfCell read;
    SumReader reader{std::span(words).first(length)};
    EXPECT_THROW(reader.get(read), StudyError) << length;
  }
}

TEST(SumWords, AreRefusedIfALengthOrANumberIsTooLarge) {
  for (const std::size_t place : {std::size_t{1}, std::size_t{3}, std::size_t{6}}) {
    Words words = words_for(example_sums());
    words[place] = std::numeric_limits<std::uint64_t>::max();
    WordsOfCell read;
    SumReader reader(words);
    EXPECT_THROW(reader.get(read), StudyError) << place;
  }
}

TEST(SumLayout, DiffersIfAMemberDoes) {
  std::string outer, inner;
  SumLayout<WordsOfCell>::add(outer);
  SumLayout<WordsOfScan>::add(inner);
  EXPECT_EQ(inner, "{dn}");
  EXPECT_EQ(outer, "{n*{dn}2x?3xd1*d}");
}

TEST(PackedWords, GiveBackWhatWasPacked) {
  for (const Words& words :
       {Words{}, Words{1}, Words{5, 5, 5, 5, 5, 5}, Words{1, 2, 3, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5}}) {
    EXPECT_EQ(unpacked(packed(words)), words);
  }
  EXPECT_EQ(packed(Words(1000, 7)), (Words{2001, 7}));
}

TEST(PackedWords, AreRefusedIfTheyAreNone) {
  for (const Words& words : {Words{4, 1}, Words{3}, Words{std::uint64_t{1} << 40U, 1},
                             Words{(std::uint64_t{1} << 40U) + 1, 1}}) {
    EXPECT_THROW(unpacked(words), StudyError);
  }
}

}  // namespace
}  // namespace montecarta::analysis
