// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/sums.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace montecarta::analysis {
namespace {

using testing::ElementsAre;

struct Inner {
  double sum = 0.0;
  static constexpr auto parts() { return std::tuple(added(&Inner::sum)); }
};

struct Outer {
  int runs = 0;
  std::vector<Inner> scans = {};
  std::optional<Inner> known = {};
  std::vector<int> values = {};
  std::vector<std::vector<int>> kept = {}, lists = {};
  std::optional<int> first = {};
  int setting = 0;

  std::size_t most() const { return 3; }
  static constexpr auto parts() {
    return std::tuple(added(&Outer::runs, &Outer::scans, &Outer::known),
                      appended(&Outer::values, &Outer::lists),
                      appended_up_to(&Outer::most, &Outer::kept), of_first_run(&Outer::first));
  }
};

TEST(Merging, TreatsEveryMemberAsWhatItIs) {
  Outer sums{.runs = 1,
             .scans = {{1.0}},
             .values = {1},
             .kept = {{1}, {2}},
             .lists = {{1}, {}},
             .setting = 7};
  const Outer next{.runs = 2,
                   .scans = {{10.0}, {20.0}},
                   .known = Inner{5.0},
                   .values = {2, 3},
                   .kept = {{3, 3}, {4}},
                   .lists = {{2}, {3}},
                   .first = 4,
                   .setting = 8};
  Outer used_up = next;
  merge_into(sums, used_up);
  EXPECT_EQ(sums.runs, 3);
  ASSERT_EQ(sums.scans.size(), 2U);
  EXPECT_EQ(sums.scans[0].sum, 11.0);
  EXPECT_EQ(sums.scans[1].sum, 20.0);
  EXPECT_EQ(sums.known->sum, 5.0);
  EXPECT_THAT(sums.values, ElementsAre(1, 2, 3));
  EXPECT_THAT(sums.lists, ElementsAre(ElementsAre(1, 2), ElementsAre(3)));
  EXPECT_THAT(sums.kept, ElementsAre(ElementsAre(1), ElementsAre(2), ElementsAre(3, 3)));
  EXPECT_EQ(sums.first, 4);
  EXPECT_EQ(sums.setting, 7);
  used_up = next;
  merge_into(sums, used_up);
  EXPECT_EQ(sums.known->sum, 10.0);
  EXPECT_EQ(sums.kept.size(), 3U);
  EXPECT_EQ(sums.first, 4);
}

TEST(Merging, IntoEmptyListsKeepsAsManyOfTheFirstRunsAsBefore) {
  Outer sums, next{.values = {1, 2}, .kept = {{1}, {2}, {3}, {4}}};
  merge_into(sums, next);
  EXPECT_THAT(sums.values, ElementsAre(1, 2));
  EXPECT_THAT(sums.kept, ElementsAre(ElementsAre(1), ElementsAre(2), ElementsAre(3)));
}

TEST(Merging, OfSummariesIsThatOfAllValues) {
  SummaryOf all, parts[3];
  for (int k = 0; k < 30; ++k) {
    const double value = 1e3 + std::sin(k);
    all.add(value);
    parts[k < 13 ? 0 : 1].add(value);
  }
  merge_into(parts[0], parts[1]);
  merge_into(parts[0], parts[2]);  // of nothing
  EXPECT_EQ(parts[0].result().n, 30U);
  EXPECT_NEAR(parts[0].result().mean, all.result().mean, 1e-12);
  EXPECT_NEAR(parts[0].result().sd, all.result().sd, 1e-12);
  SummaryOf none;
  none.merge(all);
  EXPECT_EQ(none.result().mean, all.result().mean);
  EXPECT_EQ(none.result().sd, all.result().sd);
}

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
