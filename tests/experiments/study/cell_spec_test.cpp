// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/cell_spec.hpp"

#include "engine/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Two filters that exist on paper only.
std::vector<FilterKind> paper_filters() {
  const Parameter particles = count_parameter("particles", "100", 1, 1e6, "how many");
  const Parameter threshold = number_parameter("threshold", "0.5", 0, 1, "when to resample");
  const Parameter weight =
      choice_parameter("weight", "closed", {"closed", "ratio", "as_printed"}, "which form");
  const auto kind = [](const char* name, const char* long_name, bool has_particles,
                       std::vector<Parameter> options) {
    FilterKind made;
    made.name = name;
    made.long_name = long_name;
    made.has_particles = has_particles;
    made.options = std::move(options);
    made.sensors = {};
    return made;
  };
  return {kind("bold", "Bold filter", true, {particles, threshold, weight}),
          kind("plain", "Plain filter", false, {threshold})};
}

std::vector<CellSpec> cells_of(const std::vector<FilterKind>& filters,
                               const std::vector<std::string>& lines,
                               bool controls_are_measured = false) {
  std::vector<IniEntry> entries;
  for (const std::string& line : lines)
    entries.push_back({"cells", "cell", line, "x.ini:" + std::to_string(entries.size() + 1)});
  return read_cells(entries, "x.ini", filters, controls_are_measured);
}

std::vector<std::string> labels_of(const std::vector<std::string>& lines) {
  const auto filters = paper_filters();
  std::vector<std::string> labels;
  for (const CellSpec& cell : cells_of(filters, lines)) labels.push_back(cell.label);
  return labels;
}

std::string complaint_about(const std::string& line) {
  try {
    labels_of({line});
  } catch (const StudyError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Cells, TakeAnotherDefaultWhereControlsAreMeasured) {
  auto filters = paper_filters();
  Parameter& option = filters.back().options.back();
  option.fallback_if_measured = option.choices.back();
  const auto value_of = [&](const std::string& line, bool measured) {
    return cells_of(filters, {line}, measured).at(0).options.back().second;
  };
  const std::string plain = filters.back().name;
  EXPECT_EQ(value_of(plain, false), *option.fallback);
  EXPECT_EQ(value_of(plain, true), option.choices.back());
  EXPECT_EQ(value_of(plain + " " + option.key + "=" + *option.fallback, true), *option.fallback);
}

TEST(Cells, AreLabelledByWhatDistinguishesThem) {
  EXPECT_THAT(labels_of({"bold particles=100", "plain"}), ElementsAre("bold_m100", "plain"));
  EXPECT_THAT(labels_of({"bold particles=30,100"}), ElementsAre("bold_m30", "bold_m100"));
  EXPECT_THAT(labels_of({"bold weight=ratio"}), ElementsAre("bold_m100"));
  EXPECT_THAT(labels_of({"bold weight=ratio,closed threshold=0.75"}),
              ElementsAre("bold_m100_weight_ratio", "bold_m100_weight_closed"));
  EXPECT_THAT(labels_of({"plain threshold=0.5,0.75"}),
              ElementsAre("plain_threshold_0p5", "plain_threshold_0p75"));
  EXPECT_THAT(labels_of({"bold weight=closed,as_printed"}),
              ElementsAre("bold_m100_weight_closed", "bold_m100_weight_as_printed"));
  EXPECT_THAT(labels_of({"bold label=mine", "bold particles=3"}), ElementsAre("mine", "bold_m3"));
}

TEST(Cells, AreTheProductOfTheirLists) {
  EXPECT_THAT(labels_of({"bold particles=1,2 weight=closed,ratio"}),
              ElementsAre("bold_m1_weight_closed", "bold_m1_weight_ratio", "bold_m2_weight_closed",
                          "bold_m2_weight_ratio"));
}

TEST(Cells, FillInTheOptionsNotGiven) {
  const auto filters = paper_filters();
  const CellSpec cell = cells_of(filters, {"bold threshold=0.750"}).at(0);
  EXPECT_EQ(cell_line(cell), "bold label=bold_m100 particles=100 threshold=0.75 weight=closed");
  EXPECT_EQ(cell.distinction, "100 particles");
}

TEST(Cells, RefuseWhatAFilterDoesNotTake) {
  EXPECT_THAT(complaint_about("bold particles=0"),
              HasSubstr("particles = 0 (a whole number from 1 to"));
  EXPECT_THAT(complaint_about("bold particles=3,-4"), HasSubstr("particles = -4"));
  EXPECT_THAT(complaint_about("bold particles=3 particles=4"),
              HasSubstr("particles is given twice"));
  EXPECT_THAT(complaint_about("bold partcles=3"), HasSubstr("did you mean particles?"));
  EXPECT_THAT(complaint_about("bold weight=clsed"), HasSubstr("did you mean closed?"));
  EXPECT_THAT(complaint_about("bold threshold=nan"), HasSubstr("threshold = nan"));
  EXPECT_THAT(complaint_about("bold particles=3, 4"), HasSubstr("x.ini:1"));
  EXPECT_THAT(complaint_about("bold particles=3,3"), HasSubstr("bold_m3 is given twice"));
  EXPECT_THAT(complaint_about("bold particles=3,4 label=a"), HasSubstr("one label for 2 cells"));
}

TEST(Cells, AreToldWrongNoiseWhereTheLineSaysSo) {
  EXPECT_THAT(labels_of({"plain motion_noise=0.5,1 sensor_noise=2,1"}),
              ElementsAre("plain_motion_noise_0p5_sensor_noise_2", "plain_motion_noise_0p5",
                          "plain_sensor_noise_2", "plain"));
  const auto filters = paper_filters();
  const auto cells = cells_of(filters, {"plain motion_noise=0.5,1.0"});
  EXPECT_EQ(cell_line(cells[0]),
            "plain label=plain_motion_noise_0p5 threshold=0.5 motion_noise=0.5");
  EXPECT_EQ(cell_line(cells[1]), "plain label=plain threshold=0.5");
  EXPECT_EQ(cells[0].distinction, "believes motion_noise x 0.5");
  EXPECT_EQ(mismatch_of(cells[0], "motion_noise"), 0.5);
  EXPECT_EQ(mismatch_of(cells[0], "sensor_noise"), 1.0);
  EXPECT_THAT(complaint_about("plain motion_noise=0"), HasSubstr("motion_noise = 0"));
}

}  // namespace
}  // namespace montecarta::experiments
