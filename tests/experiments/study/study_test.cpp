// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study.hpp"

#include "tests/experiments/study/study_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace montecarta::experiments {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

struct BadStudy {
  const char* name;
  std::string text;
  std::vector<std::string> expected;
};

class BadStudies : public testing::TestWithParam<BadStudy> {};

TEST_P(BadStudies, AreErrorsThatNamePlaceKeyReasonAndRemedy) {
  const std::string said = complaint(GetParam().text);
  for (const std::string& words : GetParam().expected) EXPECT_THAT(said, HasSubstr(words));
}

const BadStudy kBadStudies[] = {
    {"negative_sigma",
     with("[cells]", "sigma_range = -1\n[cells]"),
     {"trial.ini:6", "sigma_range = -1", "a number from 0 to 1000 m", "sigma_range = 0.1"}},
    {"nan",
     with("[cells]", "sigma_speed = nan\n[cells]"),
     {"trial.ini:6", "sigma_speed = nan", "a number from 0"}},
    {"infinite", with("[cells]", "max_range = inf\n[cells]"), {"trial.ini:6", "max_range = inf"}},
    {"unit_in_number", with("[cells]", "speed = 3m/s\n[cells]"), {"trial.ini:6", "speed = 3m/s"}},
    {"no_runs",
     with("runs = 20", "runs = 0"),
     {"trial.ini:3", "runs = 0", "a whole number from 1 to"}},
    {"a_million_million_runs",
     with("runs = 20", "runs = 1000000000000"),
     {"trial.ini:3", "a whole number from 1 to 1e+07"}},
    {"runs_as_float", with("runs = 20", "runs = 1e12"), {"trial.ini:3", "runs = 1e12"}},
    {"negative_runs", with("runs = 20", "runs = -5"), {"trial.ini:3", "runs = -5"}},
    {"empty_value", with("runs = 20", "runs ="), {"trial.ini:3", "a whole number"}},
    {"unknown_key",
     with("world = web_loop", "wrold = web_loop"),
     {"trial.ini:5", "unknown key scenario.wrold", "did you mean world?"}},
    {"unknown_section",
     with("[scenario]", "[scenaro]"),
     {"trial.ini:4", "unknown section [scenaro]", "did you mean scenario?"}},
    {"unknown_empty_section",
     kGoodStudy + "[asociation]\n",
     {"trial.ini:8", "did you mean association?"}},
    {"unknown_choice",
     with("[cells]", "noise = machted\n[cells]"),
     {"trial.ini:6", "noise = machted", "did you mean matched?"}},
    {"unknown_column",
     kGoodStudy + "[record]\ncolumns = pose, covarience\n",
     {"trial.ini:9", "did you mean covariance?"}},
    {"unknown_world",
     with("web_loop ", "web_lop "),
     {"trial.ini:5", "unknown world 'web_lop'", "did you mean web_loop?"}},
    {"missing_world_file",
     with("web_loop ", "no/such.csv "),
     {"trial.ini:5", "no/such.csv", "no such world file"}},
    {"twice",
     with("runs = 20", "runs = 20\nruns = 30"),
     {"trial.ini:4", "study.runs is given twice (first at trial.ini:3)"}},
    {"stray_text", with("[cells]", "hello\n[cells]"), {"trial.ini:6", "stray text 'hello'"}},
    {"no_key", with("[cells]", "= 5\n[cells]"), {"trial.ini:6", "stray text"}},
    {"before_any_section", "runs = 5\n" + kGoodStudy, {"trial.ini:1", "before any section"}},
    {"no_name",
     with("name = trial", ""),
     {"study.name is missing", "add name = my_study under [study]"}},
    {"no_scenario",
     "[study]\nname=a\nruns=1\n[cells]\ncell=ekf_slam\n",
     {"scenario.world is missing", "world = web_loop"}},
    {"no_cells", with("cell = ekf_slam", ""), {"trial.ini", "no cells", "cell = ekf_slam"}},
    {"empty", "", {"study.name is missing"}},
    {"unknown_filter",
     with("ekf_slam", "ekf_slma"),
     {"trial.ini:7", "unknown filter 'ekf_slma'", "did you mean ekf_slam?"}},
    {"unknown_option",
     with("ekf_slam", "ekf_slam partikles=5"),
     {"trial.ini:7", "ekf_slam has no option 'partikles'"}},
    {"stray_option", with("ekf_slam", "ekf_slam quickly"), {"trial.ini:7", "stray text 'quickly'"}},
    {"equal_cells",
     kGoodStudy + "cell = ekf_slam\n",
     {"trial.ini:8", "cell ekf_slam is given twice (first at trial.ini:7)"}},
    {"equal_labels",
     kGoodStudy + "cell = ekf_slam label=ekf_slam\n",
     {"trial.ini:8", "given twice"}},
    {"bad_label", with("ekf_slam", "ekf_slam label=a/b"), {"trial.ini:7", "label = 'a/b'"}},
    {"no_filter", with("ekf_slam", ""), {"trial.ini:7", "names no filter"}},
    {"wrong_cell_key", with("cell =", "cel ="), {"trial.ini:7", "did you mean cell?"}},
    {"sensor_without_noise",
     with("[cells]", "sigma_bearing_deg = 0\n[cells]"),
     {"trial.ini:6: scenario.sigma_bearing_deg = 0", "1e-06", "give [belief] sigma_bearing_deg"}},
    {"half_a_world", kGoodStudy + "[world]\nlandmark = 1, 2\n", {"0 way-points"}},
    {"no_point", kGoodStudy + "[world]\nlandmark = 1\n", {"trial.ini:9", "two coordinates"}},
};

INSTANTIATE_TEST_SUITE_P(Study, BadStudies, testing::ValuesIn(kBadStudies),
                         [](const auto& bad) { return std::string(bad.param.name); });

TEST(Study, FillsInWhatIsNotSaid) {
  const Study study = parsed(kGoodStudy);
  EXPECT_EQ(study.settings.number("scenario", "speed"), 3.0);
  EXPECT_EQ(study.settings.text("study", "title"), "trial");
  EXPECT_EQ(study.settings.count("study", "runs"), 20U);
  EXPECT_EQ(study.world.landmarks.size(), 35U);
  EXPECT_EQ(study.settings.radians("scenario", "field_of_view_deg"), kPi);
}

TEST(Study, BelievesTheScenarioUnlessToldOtherwise) {
  const Study study = parsed(
      with("[cells]", "sigma_range = 0.7\nsigma_speed = 2\n[belief]\nsigma_speed = 1\n[cells]"));
  EXPECT_EQ(study.settings.number("belief", "sigma_range"), 0.7);
  EXPECT_EQ(study.settings.number("belief", "sigma_speed"), 1.0);
}

TEST(Study, IsOverriddenBySetOptions) {
  const Study study = parsed(kGoodStudy, {"study.runs=7", "scenario.loops = 2"});
  EXPECT_EQ(study.settings.count("study", "runs"), 7U);
  EXPECT_EQ(study.settings.count("scenario", "loops"), 2U);
  EXPECT_EQ(parsed(kGoodStudy, {"cells.cell=ekf_slam label=other"}).cells.at(0).label, "other");
  EXPECT_THAT(complaint(kGoodStudy, {"study.rnus=7"}),
              AllOf(StartsWith("--set study.rnus"), HasSubstr("did you mean runs?")));
  EXPECT_THAT(complaint(kGoodStudy, {"study.runs=-7"}),
              AllOf(StartsWith("--set study.runs"), HasSubstr("whole number")));
  EXPECT_THAT(complaint(kGoodStudy, {"runs"}), HasSubstr("section.key=value"));
  EXPECT_THAT(complaint(kGoodStudy, {"study.runs=7", "study.runs=8"}), HasSubstr("given twice"));
  EXPECT_THAT(complaint(kGoodStudy, {"study.title=no # 1"}), HasSubstr("#"));
}

TEST(Study, MissingFileIsTheUsersToMend) {
  EXPECT_THROW(read_study("no/such/study.ini"), StudyError);
  EXPECT_THROW(read_study("/"), StudyError);
}

TEST(ResolvedText, IsAFixedPoint) {
  const std::string studies[] = {kGoodStudy,
                                 with("[cells]",
                                      "sigma_range = 0.10000000000000002\nnoise = matched\nstart_x "
                                      "= -0.0\n[record]\ncolumns = map, pose\n[cells]"),
                                 with("ekf_slam", "ekf_slam label=mine")};
  for (const std::string& text : studies) {
    const std::string once = resolved_text(parsed(text));
    EXPECT_EQ(resolved_text(parsed(once)), once);
  }
}

TEST(ResolvedText, DoesNotDependOnSpelling) {
  const std::string other =
      "[cells]\ncell =  ekf_slam\n[scenario]\nworld=web_loop\nspeed=3.0\nsigma_speed = "
      "3e-1\n[study]\nruns=20\nname=trial\n";
  EXPECT_EQ(resolved_text(parsed(other)), resolved_text(parsed(kGoodStudy)));
}

TEST(ResolvedText, NamesTheWorldByItsContents) {
  const std::string text = resolved_text(parsed(kGoodStudy));
  EXPECT_NE(resolved_text(parsed(with("web_loop ", "dense_loop "))), text);
  std::string moved = text;
  moved.replace(moved.find("landmark = ") + 11, 1, "9");
  EXPECT_NE(resolved_text(parsed(moved)), text);
}

}  // namespace
}  // namespace montecarta::experiments
