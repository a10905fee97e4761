// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/recorder.hpp"

#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <cmath>

namespace montecarta::engine {
namespace {

std::vector<std::string> names(const RecordLayout& layout) {
  std::vector<std::string> names;
  for (const Column& column : layout.columns()) names.push_back(column.name);
  return names;
}

TEST(RecordLayout, HoldsWhatWasAskedForAndWidensAncestorsWhereNecessary) {
  StudyPlan plan = small_result_plan();
  plan.columns = {.covariance = false, .ancestry = false};
  const RecordLayout least = layout_of(plan);
  EXPECT_THAT(names(least), ElementsAre("pose_mean", "ess", "resampled", "log_likelihood", "nis",
                                        "nis_dof", "numerical_faults", "map_size"));
  plan.columns = {};
  plan.cells[0].reports.mixture = false;
  const RecordLayout usual = layout_of(plan);
  EXPECT_FALSE(usual.find("pose_mean_mixture"));
  EXPECT_TRUE(usual.find("ancestor"));
  for (auto [particles, element] :
       {std::pair(65535U, Element::u16), std::pair(65536U, Element::u32)}) {
    plan.cells[0].particles = particles;
    const RecordLayout layout = layout_of(plan);
    EXPECT_EQ(layout.columns()[*layout.find("ancestor")].element, element) << particles;
  }
}

TEST(RecordLayout, ColumnsDoNotOverlap) {
  const StudyPlan plan = small_result_plan();
  const RecordLayout layout = layout_of(plan);
  for (std::size_t c = 0; c + 1 < layout.columns().size(); ++c) {
    EXPECT_EQ(layout.offset(c) % 64, 0U);
    EXPECT_GE(layout.offset(c + 1), layout.offset(c) + layout.columns()[c].bytes());
  }
  EXPECT_GE(layout.bytes(),
            layout.offset(layout.columns().size() - 1) + layout.columns().back().bytes());
}

TEST(Recorder, LeavesNaNWhereNothingWasRecorded) {
  const StudyPlan plan = small_result_plan();
  FilledRecord filled(plan, 0, 0);
  filled.record.clear();
  for (std::size_t c = 0; c < filled.layout.columns().size(); ++c) {
    if (filled.layout.columns()[c].element == Element::f64) {
      EXPECT_THAT(filled.record.column<double>(c), Each(IsNan()))
          << filled.layout.columns()[c].name;
    } else {
      EXPECT_THAT(filled.record.bytes(c), Each(std::byte{0})) << filled.layout.columns()[c].name;
    }
  }
  EXPECT_EQ(filled.record.status(), RunStatus::missing);
}

TEST(Recorder, PutsCovariancesAndMapsWhereTheyBelong) {
  const StudyPlan plan = small_result_plan();
  FilledRecord filled(plan, 0, 0);
  EXPECT_THAT(filled.column<double>("pose_covariance").subspan(9 * 5, 9),
              ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
  const auto seen = filled.column<std::uint8_t>("map_seen");
  const auto mean = filled.column<double>("map_mean");
  EXPECT_THAT(seen.first(6), ElementsAre(0, 0, 0, 1, 0, 0));  // nothing, then one landmark
  EXPECT_TRUE(std::isnan(mean[2]));
  EXPECT_EQ(mean[2 * 3 + 1], 0.0);
}

TEST(Recorder, StoresTheLastMapWithoutThoseBefore) {
  StudyPlan plan = small_result_plan();
  FilledRecord every(plan, 0, 1);
  plan.columns.map = false;
  plan.columns.final_map = true;
  FilledRecord last(plan, 0, 1);
  EXPECT_FALSE(last.layout.find("map_mean"));
  const auto seen = last.column<std::uint8_t>("final_map_seen");
  const auto mean = last.column<double>("final_map_mean");
  const auto covariance = last.column<double>("final_map_covariance");
  EXPECT_THAT(seen, ElementsAreArray(every.column<std::uint8_t>("map_seen").last(seen.size())));
  ASSERT_EQ(seen[0], 1);
  EXPECT_EQ(mean[0], every.column<double>("map_mean").last(mean.size())[0]);
  EXPECT_EQ(covariance[3], every.column<double>("map_covariance").last(covariance.size())[3]);
}

TEST(Recorder, StoresAssociationsWhereTheyAreAskedFor) {
  StudyPlan plan = small_result_plan();
  EXPECT_FALSE(layout_of(plan).find("association_wrong"));
  plan.columns.association = true;
  FilledRecord filled(plan, 0, 0);
  for (std::size_t s = 0; s < plan.drives->itinerary().scans(); ++s) {
    EXPECT_EQ(filled.column<double>("association_correct")[s],
              static_cast<double>(filled.drive.scan(s).size()));
  }
  EXPECT_THAT(filled.column<double>("association_missed"), Each(1.0));
  for (const char* name : {"association_wrong", "association_new_again", "association_clutter"}) {
    EXPECT_THAT(filled.column<double>(name), Each(0.0)) << name;
  }
}

TEST(Recorder, StoresJointEstimatesAtTheEndOfEachPartOfTheRun) {
  StudyPlan plan = small_result_plan();  // of six scans
  plan.columns.joint = true;
  plan.columns.joint_scans = 3;
  EXPECT_FALSE(layout_of(plan).find("joint_mean")) << "of a filter that has none";
  plan.cells[0].reports.joint = true;
  FilledRecord filled(plan, 0, 2);
  EXPECT_THAT(filled.layout.joint_scans(), ElementsAre(1, 3, 5));
  const auto mean = filled.column<double>("joint_mean");
  const auto covariance = filled.column<double>("joint_covariance");
  ASSERT_EQ(mean.size(), 3u * 9u);
  ASSERT_EQ(covariance.size(), 3u * 81u);
  const auto seen = [&](std::size_t until) {
    std::size_t all = 0;
    for (std::size_t s = 0; s <= until; ++s) all += filled.drive.scan(s).size();
    return static_cast<double>(std::min<std::size_t>(3, all));
  };
  EXPECT_THAT((std::vector{mean[0], mean[9], mean[18]}), ElementsAre(seen(1), seen(3), seen(5)));
  EXPECT_EQ(mean[17], 8.0);
  EXPECT_EQ(covariance[81 + 8], 0.5);
  EXPECT_EQ(covariance[81 + 10], 1.0);
  EXPECT_THAT(filled.column<std::uint32_t>("numerical_faults"),
              ElementsAre(0u, 1u, 0u, 1u, 0u, 1u));
}

/// A plan with a first cell that declares two columns of its own and reports this number of values.
StudyPlan plan_with_own_columns(std::size_t values) {
  StudyPlan plan = small_result_plan();
  plan.cells[0] = scripted_cell("own", {.own_values = values});
  plan.cells[0].reports.own_columns = {{"seen", "pose", "1", "detections"},
                                       {"seen_plus_1", "observability", "m", "one more"}};
  return plan;
}

TEST(Recorder, StoresTheColumnsThatAFilterDeclares) {
  StudyPlan plan = plan_with_own_columns(2);
  EXPECT_FALSE(layout_of(plan).find("seen_plus_1")) << "its group is not chosen";
  plan.columns.observability = true;
  FilledRecord filled(plan, 0, 0);
  const Column& column = filled.layout.columns()[*filled.layout.find("seen_plus_1")];
  EXPECT_EQ(column.units, "m");
  EXPECT_THAT(column.axes, ElementsAre(Axis::scan));
  for (std::size_t s = 0; s < plan.drives->itinerary().scans(); ++s) {
    const auto detections = static_cast<double>(filled.drive.scan(s).size());
    EXPECT_EQ(filled.column<double>("seen")[s], detections);
    EXPECT_EQ(filled.column<double>("seen_plus_1")[s], detections + 1.0);
  }
  EXPECT_FALSE(FilledRecord(plan, 1, 0).layout.find("seen")) << "of another filter";
}

TEST(Recorder, RefusesOtherValuesThanTheFilterDeclares) {
  const StudyPlan plan = plan_with_own_columns(1);
  EXPECT_THAT(complaint_of([&] { FilledRecord(plan, 0, 0); }),
              HasSubstr("reports 1 values of its own (it declares 2)"));
}

TEST(Recorder, RefusesAnEstimateWithoutTheMixtureThatTheFilterDeclares) {
  StudyPlan plan = small_result_plan();
  plan.cells[0] = scripted_cell("none", {.has_mixture = false});
  plan.cells[0].reports.mixture = false;
  EXPECT_TRUE(std::isfinite(FilledRecord(plan, 0, 0).column<double>("pose_mean")[0]));
  plan.cells[0].reports.mixture = true;
  EXPECT_THAT(complaint_of([&] { FilledRecord(plan, 0, 0); }), HasSubstr("declares a mixture"));
}

TEST(RecordLayout, RefusesAnOwnColumnWithTheNameOfAnother) {
  for (const char* name : {"nis", "seen", "status", "full", "a/b"}) {
    StudyPlan plan = plan_with_own_columns(2);
    plan.cells[0].reports.own_columns[1].name = name;
    EXPECT_THAT(complaint_of([&] { layout_of(plan); }),
                HasSubstr("its column " + std::string(name) + " (there is one already"));
  }
  StudyPlan plan = plan_with_own_columns(2);
  plan.cells[0].reports.own_columns[1].group = "speed";
  EXPECT_THAT(complaint_of([&] { layout_of(plan); }), HasSubstr("is of the group speed"));
}

TEST(JointScans, AreTheLastOfEqualParts) {
  EXPECT_THAT(joint_scans_of(10, 3), ElementsAre(2, 5, 9));
  EXPECT_THAT(joint_scans_of(2, 16), ElementsAre(0, 1));
  EXPECT_THAT(joint_scans_of(0, 16), IsEmpty());
}

TEST(RunRecord, FingerprintTellsEveryBitApart) {
  const StudyPlan plan = small_result_plan();
  FilledRecord filled(plan, 0, 0);
  const std::uint64_t whole = filled.record.fingerprint();
  for (std::size_t c = 0; c < filled.layout.columns().size(); ++c) {
    auto* last = const_cast<std::byte*>(&filled.record.bytes(c).back());
    *last ^= std::byte{1};
    EXPECT_NE(filled.record.fingerprint(), whole) << filled.layout.columns()[c].name;
    *last ^= std::byte{1};
  }
  EXPECT_EQ(filled.record.fingerprint(), whole);
  filled.record.mark_failed(1, "", 0.0);
  EXPECT_NE(filled.record.fingerprint(), whole);
}

}  // namespace
}  // namespace montecarta::engine
