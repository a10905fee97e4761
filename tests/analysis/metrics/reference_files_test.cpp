// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/reference_report.hpp"
#include "analysis/metrics/reference_scores.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/records/h5.hpp"
#include "tests/analysis/recorded_result.hpp"
#include "tests/analysis/synthetic_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace montecarta::analysis {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class ReferenceFiles : public ::testing::Test {
 protected:
  ReferenceFiles() : study_(recorded()) {}
  StudyAnalysis recorded() const {
    write_recorded_result(folder_ / "out.h5", 4, 400);
    return analyze(ResultFile(folder_ / "out.h5"));
  }
  ScratchFolder folder_;
  StudyAnalysis study_;
};

TEST_F(ReferenceFiles, HoldARowForEachCellAndReferenceAndForEachFix) {
  write_csv(study_, folder_ / "csv");
  const std::string rows = text_in(folder_ / "csv/references.csv");
  EXPECT_THAT(rows, StartsWith("cell,filter,reference,runs_failed,runs_complete,runs_lost,"
                               "rms_mean [m],rms_standard_error [m],rms_median [m],"
                               "rms_least [m],rms_greatest [m],"));
  EXPECT_EQ(std::ranges::count(rows, '\n'), 9);
  EXPECT_THAT(rows, HasSubstr("\nufastslam_m3,ufastslam,coarse,1,3,1,"));
  EXPECT_THAT(rows, HasSubstr("beacons_found_mean"));
  const std::string errors = text_in(folder_ / "csv/reference_errors.csv");
  EXPECT_THAT(errors, StartsWith("time [s],ekf_slam [m],fastslam2_m3 [m],"));
  EXPECT_EQ(std::ranges::count(errors, '\n'), 101);
  EXPECT_THAT(text_in(folder_ / "csv/series_ekf_slam.csv"),
              StartsWith("time [s],map_landmarks,nis_per_component,nis_lower,nis_upper\n"));
  const auto names = csv_names({"ekf_slam"});
  EXPECT_THAT(names, testing::IsSupersetOf({"references.csv", "reference_errors.csv"}));
}

TEST_F(ReferenceFiles, AreNotThereWhereTheTruthIsKnown) {
  write_synthetic_result(folder_ / "true.h5", 3, 80);
  write_csv(analyze(ResultFile(folder_ / "true.h5")), folder_ / "csv");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "csv/references.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "csv/reference_errors.csv"));
  EXPECT_THAT(text_in(folder_ / "csv/cells.csv"), Not(HasSubstr("reference")));
  const std::string series = text_in(folder_ / "csv/series_scripted_m4.csv");
  EXPECT_THAT(series, StartsWith("time [s],position_rmse [m],heading_rmse [rad],anees"));
  EXPECT_THAT(series, Not(HasSubstr("map_landmarks")));
}

TEST_F(ReferenceFiles, AreGroupsOfTheAnalysisFile) {
  study_.references[1].fixes = 0;
  study_.references[1].times.clear();  // as if no fix lay within the drive
  write_analysis_file(study_, folder_ / "analysis.h5");
  const auto file = h5::open_file(folder_ / "analysis.h5");
  const std::string group = "cells/fastslam2_m20/references/";
  std::vector<double> errors(100), mean(1);
  h5::read(h5::open_dataset(file, group + "gps/error_over_time"), Element::f64,
           std::as_writable_bytes(std::span(errors)));
  EXPECT_EQ(errors, study_.cells[2].get<ReferenceAnalyses>()[0].error_over_time);
  h5::read(h5::open_dataset(file, group + "gps/aligned_rms_mean"), Element::f64,
           std::as_writable_bytes(std::span(mean)));
  EXPECT_EQ(mean[0], study_.cells[2]
                         .get<ReferenceAnalyses>()[0]
                         .over_runs(&ReferenceScores::aligned_rms)
                         .summary.mean);
  EXPECT_FALSE(h5::has(h5::open_group(file, group + "coarse"), "error_over_time"));
  EXPECT_EQ(h5::text(h5::open_group(file, "cells/ekf_slam"), "verdict"), "not tested");
}

}  // namespace
}  // namespace montecarta::analysis
