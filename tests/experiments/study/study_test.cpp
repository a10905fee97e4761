// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study.hpp"

#include "engine/errors.hpp"
#include "experiments/study/cell_spec.hpp"
#include "experiments/study/known_filters.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/experiments/study/study_text.hpp"

namespace montecarta::experiments {
namespace {

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
    {"no_runs",
     with("runs = 20", "runs = 0"),
     {"trial.ini:3", "runs = 0", "a whole number from 1 to"}},
    {"negative_runs", with("runs = 20", "runs = -5"), {"trial.ini:3", "runs = -5"}},
    {"unknown_key",
     with("world = web_loop", "wrold = web_loop"),
     {"trial.ini:5", "unknown key scenario.wrold", "did you mean world?"}},
    {"key_of_another_section",
     with("[cells]", "gate_sigma = 3\n[cells]"),
     {"trial.ini:6", "unknown key scenario.gate_sigma", "move it to [association]"}},
    {"key_of_two_other_sections",
     with("[cells]", "[record]\nsigma_range = 3\n[cells]"),
     {"trial.ini:7", "unknown key record.sigma_range", "move it to [scenario] or [belief]"}},
    {"value_of_another_section",
     with("[cells]", "map = known\n[cells]"),
     {"trial.ini:6", "scenario.map = known", "move it to [belief]"}},
    {"option_of_a_cell_in_a_section",
     with("runs = 20", "runs = 20\nparticles = 100"),
     {"trial.ini:4", "unknown key study.particles", "option of a cell", "particles=100"}},
    {"setting_among_cells",
     with("[cells]", "[cells]\ngate_sigma = 3"),
     {"trial.ini:7", "unknown key cells.gate_sigma", "move it to [association]"}},
    {"setting_in_a_cell",
     with("ekf_slam", "ekf_slam gate_sigma=3"),
     {"trial.ini:7", "ekf_slam has no option 'gate_sigma'", "write it under [association]"}},
    {"unknown_section",
     with("[scenario]", "[scenaro]"),
     {"trial.ini:4", "unknown section [scenaro]", "did you mean scenario?"}},
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
    {"bad_label", with("ekf_slam", "ekf_slam label=a/b"), {"trial.ini:7", "label = 'a/b'"}},
    {"no_filter", with("ekf_slam", ""), {"trial.ini:7", "names no filter"}},
    {"wrong_cell_key", with("cell =", "cel ="), {"trial.ini:7", "did you mean cell?"}},
    {"sensor_without_noise",
     with("[cells]", "sigma_bearing_deg = 0\n[cells]"),
     {"trial.ini:6: scenario.sigma_bearing_deg = 0", "1e-06", "give [belief] sigma_bearing_deg"}},
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

TEST(Study, IsOverriddenBySetOptionsAndRefusesAMissingFile) {
  const Study study = parsed(kGoodStudy, {"study.runs=7", "scenario.loops = 2"});
  EXPECT_EQ(study.settings.count("study", "runs"), 7U);
  EXPECT_EQ(study.settings.count("scenario", "loops"), 2U);
  EXPECT_EQ(parsed(kGoodStudy, {"cells.cell=ekf_slam label=other"}).cells.at(0).label, "other");
  EXPECT_THAT(complaint(kGoodStudy, {"study.rnus=7"}), StartsWith("--set study.rnus"));
  EXPECT_THAT(complaint(kGoodStudy, {"study.runs=-7"}), StartsWith("--set study.runs"));
  EXPECT_THAT(complaint(kGoodStudy, {"runs"}), HasSubstr("section.key=value"));
  EXPECT_THAT(complaint(kGoodStudy, {"study.runs=7", "study.runs=8"}), HasSubstr("given twice"));
  EXPECT_THAT(complaint(kGoodStudy, {"study.title=no # 1"}), HasSubstr("#"));
  EXPECT_THROW(read_study("no/such/study.ini", known_filters()), StudyError);
  EXPECT_THROW(read_study("/", known_filters()), StudyError);
}

TEST(ResolvedText, IsAFixedPointThatDoesNotDependOnSpelling) {
  const std::string studies[] = {kGoodStudy,
                                 with("[cells]",
                                      "sigma_range = 0.10000000000000002\nnoise = matched\nstart_x "
                                      "= -0.0\n[record]\ncolumns = map, pose\n[cells]"),
                                 with("ekf_slam", "ekf_slam label=mine")};
  for (const std::string& text : studies) {
    const std::string once = resolved_text(parsed(text));
    EXPECT_EQ(resolved_text(parsed(once)), once);
  }
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
    made.reports.particles = has_particles;
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
  return engine::complaint_of([&] { labels_of({line}); });
}

TEST(Cells, TakeAnotherDefaultWhereControlsAreMeasured) {
  auto filters = paper_filters();
  Parameter& option = filters.front().options.back();
  option.fallback_if_measured = option.choices.back();
  const auto value_of = [&](const std::string& line, bool measured) {
    return cells_of(filters, {line}, measured).at(0).options.back().second;
  };
  const std::string name = filters.front().name;
  EXPECT_EQ(value_of(name, false), *option.fallback);
  EXPECT_EQ(value_of(name, true), option.choices.back());
  EXPECT_EQ(value_of(name + " " + option.key + "=" + *option.fallback, true), *option.fallback);
}

TEST(Cells, AreTheProductOfTheirListsLabelledByWhatDistinguishesThem) {
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
  EXPECT_THAT(complaint_about("bold particles=0"), HasSubstr("particles = 0 (a whole number"));
  EXPECT_THAT(complaint_about("bold particles=3,-4"), HasSubstr("particles = -4"));
  EXPECT_THAT(complaint_about("bold particles=3 particles=4"), HasSubstr("particles is given"));
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
