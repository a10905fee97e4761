// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "experiments/judging/state_rows.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class InnovationFiles : public testing::Test {
 protected:
  StateRows read(const std::string& text, double tolerance = 1e-6) const {
    StateRows rows;
    rows.time = {1.0, 2.0, 3.0};
    std::ofstream(folder_ / "innovation.csv") << text;
    read_innovations(folder_ / "innovation.csv", "estimate.csv", tolerance, rows);
    return rows;
  }
  std::string complaint(const std::string& text) const {
    try {
      read(text);
    } catch (const StudyError& error) {
      return error.what();
    }
    return "";
  }
  ScratchFolder folder_;
};

TEST_F(InnovationFiles, HaveNisOfTimesThatAddUp) {
  const StateRows rows = read("time_s,nis,nis_dof\n1,2.5,2\n1,1.5,2\n3,4,1\n");
  EXPECT_THAT(rows.nis, ElementsAre(4.0, 0.0, 4.0));
  EXPECT_THAT(rows.nis_dof, ElementsAre(4U, 0U, 1U));
}

TEST_F(InnovationFiles, HaveInnovationsAndTheirCovariance) {
  const StateRows rows = read(
      "time_s,range_m,bearing_rad,cov_0_0,cov_0_1,cov_1_1\n2.2,2,0.1,4,0,0.01\n"
      "3,1,1,1,2,1\n",
      0.3);
  EXPECT_NEAR(rows.nis[1], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(rows.nis[2])) << "that is no covariance";
  EXPECT_THAT(rows.nis_dof, ElementsAre(0U, 2U, 2U));
}

TEST_F(InnovationFiles, AreRefusedWithFileLineAndRemedy) {
  const std::string header = "time_s,nis,nis_dof\n";
  EXPECT_THAT(complaint(header + "1.5,1,1\n"),
              HasSubstr("innovation.csv:2: no estimate in estimate.csv is of time 1.5 s"));
  EXPECT_THAT(complaint(header + "2,1,1\n1,1,1\n"), HasSubstr(":3: time 1 s is before"));
  EXPECT_THAT(complaint(header + "2,-1,1\n"), HasSubstr(":2: nis -1 with nis_dof 1"));
  EXPECT_THAT(complaint("time_s,nis\n1,1\n"), HasSubstr("write time_s,nis,nis_dof"));
  EXPECT_THAT(complaint("time_s,a_m\n1,1\n"), HasSubstr("no cov_a_a"));
}

TEST_F(InnovationFiles, LieBesideTheirEstimates) {
  std::ofstream(folder_ / "innovation_ekf.csv") << "time_s,nis,nis_dof\n";
  EXPECT_EQ(innovations_beside(folder_ / "estimate_ekf.csv"), folder_ / "innovation_ekf.csv");
  EXPECT_EQ(innovations_beside(folder_ / "estimate_ekf.txt"), folder_ / "innovation_ekf.csv");
  EXPECT_EQ(innovations_beside(folder_ / "estimate.csv"), std::nullopt);
  EXPECT_EQ(innovations_beside(folder_ / "ekf.csv"), std::nullopt);
}

}  // namespace
}  // namespace montecarta::experiments
