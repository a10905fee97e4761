// SPDX-License-Identifier: BSD-3-Clause
// Law: one estimator has one ANEES if its estimates are judged, if it is a cell, and if it is a
// cell on recorded drives with the truth as reference.
#include "analysis/study/study_analysis.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/text/words.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/reader_program.hpp"
#include "tests/experiments/commands/program.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

constexpr double kLeastVariance = 1.001e-18;  // of a fix [m2, rad2]
const std::string kBeliefOfAll = R"(wheelbase = 4
sigma_speed = 0.3
sigma_steer_deg = 3
sigma_range = 0.1
sigma_bearing_deg = 1
)";

class SlowThreeWays : public Program {
 protected:
  SlowThreeWays() { write("blink.csv", kBlinkWorld); }

  /// The study of a cell, simulated or on logs.
  std::string study(const std::string& scenario, const std::string& cell) const {
    return "[study]\nname = ways\nruns = 3\n[scenario]\n" + scenario + "[belief]\n" + kBeliefOfAll +
           "[association]\nkind = known\n[record]\nrate = scan\ncolumns = pose, covariance\n" +
           "[cells]\ncell = " + cell + "\n";
  }
  /// Exported drives become logs with fixes at the scans that are the truth.
  void make_logs() const {
    for (const std::string run : {"run_0000", "run_0001", "run_0002"}) {
      const std::filesystem::path from = folder_ / "drives/runs" / run;
      std::filesystem::create_directories(folder_ / "logs");
      std::filesystem::copy(from, folder_ / "logs" / run);
      std::filesystem::copy(folder_ / "drives/truth" / run / "reference.csv",
                            folder_ / "logs" / run);
      DriveLog log = read_log_csv(folder_ / "logs" / run);
      std::filesystem::remove_all(folder_ / "logs" / run);
      ReferencePath truth = log.references.front(), fixes{truth.name, {}, {}, {}};
      for (std::size_t f = 0; f < truth.time.size(); ++f) {
        if (std::ranges::count(log.scans, truth.time[f], &LoggedScan::time) == 0) continue;
        fixes.time.push_back(truth.time[f]);
        fixes.position.push_back(truth.position[f]);
        fixes.heading.push_back(truth.heading[f]);
        fixes.covariance.emplace_back(kLeastVariance * Eigen::Matrix3d::Identity());
      }
      log.references = {fixes};
      log.landmarks.clear();
      write_log_csv(log, folder_ / "logs" / run);
    }
  }
  double anees_in(const std::string& file) const {
    return analysis::analyze(ResultFile(folder_ / file)).cells.front().nees.front().mean;
  }
  /// The ANEES in the table of drives, over the three components.
  double anees_of_drives(const std::string& file) const {
    EXPECT_EQ(call({"analyze", file, "--csv", "tables", "--force"}).code, 0);
    const auto rows = engine::read_csv(folder_ / "tables/drive.csv");
    return 3.0 * to_number(rows.front().at("pose_nees_ratio")).value();
  }
  void run(const std::string& text, const std::string& output) const {
    write("study.ini", text);
    const Called called =
        call({"run", "study.ini", "-o", output, "--quiet", "--force", "--allow-external"});
    ASSERT_EQ(called.code, 0) << called.err;
  }
};

TEST_F(SlowThreeWays, AnEstimatorInPython) {
  if (!python_has("numpy")) GTEST_SKIP() << "numpy (python3-numpy) is not installed";
  const std::string command =
      "/usr/bin/python3 -B " MONTECARTA_SOURCE_DIR "/experiments/external/python/ekf_slam.py";
  const std::string cell = "external command=\"" + command + "\" label=mine answer_limit=300";
  const std::string simulated = "world = blink.csv\nnoise = matched\n";
  run(study(simulated, cell), "cell.h5");
  ASSERT_EQ(call({"export", "study.ini", "-o", "drives"}).code, 0);
  const double as_cell = anees_in("cell.h5");
  EXPECT_GT(as_cell, 0.1);

  const std::string outside_py = MONTECARTA_SOURCE_DIR "/tests/experiments/external/outside.py";
  const Called outside = call({"help"}, "/usr/bin/python3 -B " + outside_py + " '" + command +
                                            "' estimate drives/runs/run_000[0-2] && ");
  ASSERT_EQ(outside.code, 0) << outside.err;
  const Called judged =
      call({"judge", "drives/runs/run_0000/estimate.csv", "drives/runs/run_0001/estimate.csv",
            "drives/runs/run_0002/estimate.csv", "--truth", "drives", "--error", "world", "-o",
            "judged.h5", "--force"});
  ASSERT_EQ(judged.code, 0) << judged.err;
  EXPECT_NEAR(anees_in("judged.h5") / as_cell, 1.0, 1e-12);

  make_logs();
  run(study("kind = log\npath = logs/run_0000, logs/run_0001, logs/run_0002\n", cell), "logs.h5");
  // The variance of the fixes, though the least that a reference may have, is part of the NEES.
  EXPECT_NEAR(anees_of_drives("logs.h5") / as_cell, 1.0, 1e-11);
}

}  // namespace
}  // namespace montecarta::experiments
