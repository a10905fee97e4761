// SPDX-License-Identifier: BSD-3-Clause
// Law: EKF-SLAM in Python and in Octave, as shipped, is the cell ekf_slam.
#include "tests/doubles/reader_program.hpp"
#include "tests/experiments/external/external_study.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

const std::string kExamples = MONTECARTA_SOURCE_DIR "/experiments/external";

class SlowExternalExample : public ExternalStudy {
 protected:
  /// Every number of every run within 1e-9, relative where it is large.
  void expect_ekf_slam(const std::string& command) const {
    const std::vector<std::string> overrides = {"scenario.noise=matched", "scenario.clutter_rate=1",
                                                "record.columns=pose,covariance,map"};
    const ResultFile ours = result_of("ekf_slam", overrides);
    const ResultFile theirs =
        result_of("external command=" + in_quotes(command) + " answer_limit=300", overrides);
    for (std::size_t i = 0; i < ours.runs().size(); ++i) {
      ASSERT_EQ(theirs.status(theirs.cells().front())[i], RunStatus::complete)
          << theirs.failure_reasons(theirs.cells().front())[i];
      for (const Column& column : ours.cells().front().columns)
        expect_same(ours, theirs, column, i);
    }
  }

 private:
  static void expect_same(const ResultFile& ours, const ResultFile& theirs, const Column& column,
                          std::size_t run) {
    const std::vector<double> a = values(ours, column.name, run);
    const std::vector<double> b = values(theirs, column.name, run);
    ASSERT_EQ(a.size(), b.size()) << column.name;
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (std::isnan(a[k]) && std::isnan(b[k])) continue;
      ASSERT_NEAR(a[k], b[k], 1e-9 * std::max(1.0, std::abs(a[k])))
          << column.name << "[" << k << "], run " << run;
    }
  }
};

TEST_F(SlowExternalExample, Python) {
  if (!python_has("numpy")) GTEST_SKIP() << "numpy (python3-numpy) is not installed";
  expect_ekf_slam("/usr/bin/python3 -B " + kExamples + "/python/ekf_slam.py");
}

TEST_F(SlowExternalExample, Octave) {
  if (!installed("octave-cli")) GTEST_SKIP() << "octave is not installed";
  expect_ekf_slam("octave-cli --quiet --no-init-file --no-history --path " + kExamples +
                  "/octave --eval ekf_slam");
}

}  // namespace
}  // namespace montecarta::experiments
