// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/recorder.hpp"

#include "tests/doubles/scripted_result.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace montecarta::engine {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::IsEmpty;
using ::testing::IsNan;

std::vector<std::string> names(const RecordLayout& layout) {
  std::vector<std::string> names;
  for (const Column& column : layout.columns()) names.push_back(column.name);
  return names;
}

/// Asks for nothing but what it was told may be asked for.
class StrictFilter : public ScriptedFilter {
 public:
  using ScriptedFilter::ScriptedFilter;
  void particles(const ParticleColumns& columns) const override {
    EXPECT_THAT(columns.pose, IsEmpty());
    EXPECT_THAT(columns.log_weight, IsEmpty());
    ScriptedFilter::particles(columns);
  }
  void map(std::span<std::optional<LandmarkEstimate>>) const override {
    ADD_FAILURE() << "nobody asked for a map";
  }
};

TEST(RecordLayout, HoldsWhatWasAskedFor) {
  StudyPlan plan = small_result_plan();
  plan.columns = {.covariance = false, .ancestry = false};
  const RecordLayout least(plan.cells[0], plan.columns, plan.drives->itinerary());
  EXPECT_THAT(names(least), ElementsAre("pose_mean", "ess", "resampled", "log_likelihood", "nis",
                                        "nis_dof", "numerical_faults", "map_size"));
  plan.columns = {};
  plan.cells[0].mixture = false;
  const RecordLayout usual(plan.cells[0], plan.columns, plan.drives->itinerary());
  EXPECT_FALSE(usual.find("pose_mean_mixture"));
  EXPECT_TRUE(usual.find("ancestor"));
}

TEST(RecordLayout, HasNoParticleColumnsForAKalmanFilter) {
  StudyPlan plan = small_result_plan();
  plan.cells[0].particles = 0;
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  EXPECT_FALSE(layout.find("ancestor"));
  EXPECT_FALSE(layout.find("particle_pose"));
  EXPECT_TRUE(layout.find("map_mean"));
}

TEST(RecordLayout, WidensAncestorsWhereSixteenBitsDoNotReach) {
  StudyPlan plan = small_result_plan();
  for (auto [particles, element] :
       {std::pair(65535U, Element::u16), std::pair(65536U, Element::u32)}) {
    plan.cells[0].particles = particles;
    const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
    EXPECT_EQ(layout.columns()[*layout.find("ancestor")].element, element) << particles;
  }
}

TEST(RecordLayout, ColumnsDoNotOverlap) {
  const StudyPlan plan = small_result_plan();
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  for (std::size_t c = 0; c + 1 < layout.columns().size(); ++c) {
    EXPECT_EQ(layout.offset(c) % 64, 0U);
    EXPECT_GE(layout.offset(c + 1), layout.offset(c) + layout.columns()[c].bytes());
  }
  EXPECT_GE(layout.bytes(),
            layout.offset(layout.columns().size() - 1) + layout.columns().back().bytes());
}

TEST(Recorder, NeverAsksForAColumnThatNobodyWants) {
  StudyPlan plan = small_result_plan();
  plan.columns = {.covariance = true, .ancestry = true};
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  Recorder recorder(record);
  StrictFilter filter({.particles = 4});
  filter.start({});
  recorder.after_scan(filter, 0);
  recorder.after_step(filter, 3);
  EXPECT_THAT(record.column<std::uint16_t>(*layout.find("ancestor")).first(4),
              ElementsAre(0, 1, 2, 3));
}

TEST(Recorder, LeavesNaNWhereNothingWasRecorded) {
  const StudyPlan plan = small_result_plan();
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  Drive drive;
  plan.drives->generate(0, drive);
  fill_record(plan, 0, 0, drive, record);
  record.clear();
  for (std::size_t c = 0; c < layout.columns().size(); ++c) {
    if (layout.columns()[c].element == Element::f64) {
      EXPECT_THAT(record.column<double>(c), Each(IsNan())) << layout.columns()[c].name;
    } else {
      EXPECT_THAT(record.bytes(c), Each(std::byte{0})) << layout.columns()[c].name;
    }
  }
  EXPECT_EQ(record.status(), RunStatus::missing);
}

TEST(Recorder, PutsCovariancesAndMapsWhereTheyBelong) {
  const StudyPlan plan = small_result_plan();
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  Drive drive;
  plan.drives->generate(0, drive);
  fill_record(plan, 0, 0, drive, record);
  EXPECT_THAT(record.column<double>(*layout.find("pose_covariance")).subspan(9 * 5, 9),
              ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 1));
  const auto seen = record.column<std::uint8_t>(*layout.find("map_seen"));
  const auto mean = record.column<double>(*layout.find("map_mean"));
  EXPECT_THAT(seen.first(6),
              ElementsAre(0, 0, 0, 1, 0, 0));  // run 0 sees nothing, then one landmark
  EXPECT_TRUE(std::isnan(mean[2]));
  EXPECT_EQ(mean[2 * 3 + 1], 0.0);
}

TEST(Recorder, StoresTheLastMapWithoutThoseBefore) {
  StudyPlan plan = small_result_plan();
  const RecordLayout every(plan.cells[0], plan.columns, plan.drives->itinerary());
  plan.columns.map = false;
  plan.columns.final_map = true;
  const RecordLayout last(plan.cells[0], plan.columns, plan.drives->itinerary());
  EXPECT_FALSE(last.find("map_mean"));
  RunRecord all_maps(every), last_map(last);
  Drive drive;
  plan.drives->generate(1, drive);
  fill_record(plan, 0, 1, drive, all_maps);
  fill_record(plan, 0, 1, drive, last_map);
  const auto seen = last_map.column<std::uint8_t>(*last.find("final_map_seen"));
  const auto mean = last_map.column<double>(*last.find("final_map_mean"));
  const auto covariance = last_map.column<double>(*last.find("final_map_covariance"));
  EXPECT_THAT(seen, ElementsAreArray(
                        all_maps.column<std::uint8_t>(*every.find("map_seen")).last(seen.size())));
  ASSERT_EQ(seen[0], 1);
  EXPECT_EQ(mean[0], all_maps.column<double>(*every.find("map_mean")).last(mean.size())[0]);
  EXPECT_EQ(covariance[3],
            all_maps.column<double>(*every.find("map_covariance")).last(covariance.size())[3]);
}

TEST(Recorder, StoresAssociationsWhereTheyAreAskedFor) {
  StudyPlan plan = small_result_plan();
  EXPECT_FALSE(RecordLayout(plan.cells[0], plan.columns, plan.drives->itinerary())
                   .find("association_wrong"));
  plan.columns.association = true;
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  Drive drive;
  plan.drives->generate(0, drive);
  fill_record(plan, 0, 0, drive, record);
  const auto column = [&](const char* name) { return record.column<double>(*layout.find(name)); };
  for (std::size_t s = 0; s < plan.drives->itinerary().scans(); ++s) {
    EXPECT_EQ(column("association_correct")[s], static_cast<double>(drive.scan(s).size()));
  }
  EXPECT_THAT(column("association_missed"), Each(1.0));
  for (const char* name : {"association_wrong", "association_new_again", "association_clutter"}) {
    EXPECT_THAT(column(name), Each(0.0)) << name;
  }
}

TEST(Recorder, StoresJointEstimatesAtTheEndOfEachPartOfTheRun) {
  StudyPlan plan = small_result_plan();  // of six scans
  plan.columns.joint = true;
  plan.columns.joint_scans = 3;
  EXPECT_FALSE(
      RecordLayout(plan.cells[0], plan.columns, plan.drives->itinerary()).find("joint_mean"))
      << "of a filter that has none";
  plan.cells[0].joint = true;
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  EXPECT_THAT(layout.joint_scans(), ElementsAre(1, 3, 5));
  RunRecord record(layout);
  Drive drive;
  plan.drives->generate(2, drive);
  fill_record(plan, 0, 2, drive, record);
  const auto mean = record.column<double>(*layout.find("joint_mean"));
  const auto covariance = record.column<double>(*layout.find("joint_covariance"));
  ASSERT_EQ(mean.size(), 3u * 9u);
  ASSERT_EQ(covariance.size(), 3u * 81u);
  const auto seen = [&](std::size_t until) {
    std::size_t all = 0;
    for (std::size_t s = 0; s <= until; ++s) all += drive.scan(s).size();
    return static_cast<double>(std::min<std::size_t>(3, all));
  };
  EXPECT_THAT((std::vector{mean[0], mean[9], mean[18]}), ElementsAre(seen(1), seen(3), seen(5)));
  EXPECT_EQ(mean[17], 8.0);
  EXPECT_EQ(covariance[81 + 8], 0.5);
  EXPECT_EQ(covariance[81 + 10], 1.0);
  EXPECT_THAT(record.column<std::uint32_t>(*layout.find("numerical_faults")),
              ElementsAre(0u, 1u, 0u, 1u, 0u, 1u));
}

TEST(JointScans, AreTheLastOfEqualParts) {
  EXPECT_THAT(joint_scans_of(10, 3), ElementsAre(2, 5, 9));
  EXPECT_THAT(joint_scans_of(2, 16), ElementsAre(0, 1));
  EXPECT_THAT(joint_scans_of(0, 16), IsEmpty());
}

TEST(RunRecord, FingerprintTellsEveryBitApart) {
  const StudyPlan plan = small_result_plan();
  const RecordLayout layout(plan.cells[0], plan.columns, plan.drives->itinerary());
  RunRecord record(layout);
  Drive drive;
  plan.drives->generate(0, drive);
  fill_record(plan, 0, 0, drive, record);
  const std::uint64_t whole = record.fingerprint();
  for (std::size_t c = 0; c < layout.columns().size(); ++c) {
    auto* last = const_cast<std::byte*>(&record.bytes(c).back());
    *last ^= std::byte{1};
    EXPECT_NE(record.fingerprint(), whole) << layout.columns()[c].name;
    *last ^= std::byte{1};
  }
  EXPECT_EQ(record.fingerprint(), whole);
  record.mark_failed(1, "", 0.0);
  EXPECT_NE(record.fingerprint(), whole);
}

}  // namespace
}  // namespace montecarta::engine
