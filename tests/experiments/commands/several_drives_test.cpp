// SPDX-License-Identifier: BSD-3-Clause
// Several recorded drives of one scenario, each a run, through every command.
#include "analysis/study/study_analysis.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "engine/records/result_file.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "tests/doubles/csv_table.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/same_results.hpp"
#include "tests/experiments/commands/program.hpp"

namespace montecarta::experiments {
namespace {

const std::string kDrives = R"([study]
name = drives
runs = 3
[scenario]
kind = log
path = long, short, middle
[belief]
wheelbase = 4
sigma_speed = 0.3
sigma_steer_deg = 3
sigma_range = 0.1
sigma_bearing_deg = 1
[cells]
cell = ekf_slam
cell = fastslam2 particles=10
)";

class SeveralDrives : public BlinkProgram {
 protected:
  /// Three simulated drives, cut to lengths of their own, with fixes that tell their errors.
  SeveralDrives() {
    write("drives.ini", kDrives);
    call({"export", "blink.ini", "-o", "exported"});
    make("long", "run_0000", 1.0);
    make("short", "run_0001", 0.5);
    make("middle", "run_0002", 0.8);
  }

  void make(const std::string& name, const std::string& run, double share) const {
    const std::filesystem::path from = folder_ / "exported";
    std::filesystem::copy(from / "truth" / run / "reference.csv", from / "runs" / run);
    DriveLog log = read_log_csv(from / "runs" / run);
    log.landmarks.clear();
    log.scans.resize(static_cast<std::size_t>(share * static_cast<double>(log.scans.size())));
    std::erase_if(log.odometry, [&](const Odometry& o) { return o.time > log.scans.back().time; });
    for (LoggedScan& scan : log.scans) {
      for (Detection& detection : scan.detections) detection.identity = Detection::kUnidentified;
    }
    ReferencePath& path = log.references.front();
    path.covariance.assign(path.time.size(), 0.01 * Eigen::Matrix3d::Identity());
    for (std::size_t f = 0; f < path.time.size(); ++f) path.position[f].x() += f % 2 ? 0.1 : -0.1;
    write_log_csv(log, folder_ / name);
  }

  Called run(const std::string& output, const std::vector<std::string>& more = {}) const {
    return call_with({"run", "drives.ini", "-o", output, "--quiet"}, more);
  }
};

TEST_F(SeveralDrives, EachIsARunThatIsCompleteAndJudgedAsIndependent) {
  const Called called = run("out.h5");
  ASSERT_EQ(called.code, 0) << called.err;
  const ResultFile file(folder_ / "out.h5");
  ASSERT_EQ(file.description().drives.size(), 3U);
  EXPECT_EQ(file.description().drives[0].scan_times, file.scan_times());
  EXPECT_LT(file.description().drives[1].scan_times.size(), file.scan_times().size());
  EXPECT_TRUE(file.references().empty());
  for (const StoredCell& cell : file.cells()) {
    EXPECT_THAT(file.status(cell), testing::Each(RunStatus::complete)) << cell.label;
    std::vector<double> mean(3 * file.scan_times().size());
    file.read(cell, "pose_mean", 1, std::span(mean));
    const std::size_t scans = file.description().drives[1].scan_times.size();
    EXPECT_FALSE(std::isnan(mean[3 * scans - 1]));
    EXPECT_TRUE(std::isnan(mean[3 * scans]));
    std::vector<double> seen(
        *std::ranges::find(cell.columns, "final_map_seen", &Column::name)->shape.begin());
    file.read(cell, "final_map_seen", 1, std::span(seen));
    EXPECT_GT(std::ranges::count(seen, 1.0), 0) << "the map is that after its own last scan";
  }
  const Called judged = call({"analyze", "out.h5", "--table", "drive", "--csv", "tables"});
  EXPECT_EQ(judged.code, 0) << judged.err;
  EXPECT_THAT(judged.out, HasSubstr("Every run processes a drive of its own"));
  EXPECT_THAT(judged.out, Not(HasSubstr("process the same drive")));
  EXPECT_THAT(text_of("tables/drive.csv"), HasSubstr("drives"));
  EXPECT_FALSE(exists("tables/reference_errors.csv")) << "fixes of three drives have no mean";
  EXPECT_THAT(call({"analyze", "out.h5", "--table", "reference"}).out,
              HasSubstr("no figures over time"));
  EXPECT_EQ(text_of("tables/series_ekf_slam.csv"), "time [s]\n") << "nor have their scans";
  EXPECT_EQ(call({"report", "out.h5", "-o", "page"}).code, 0);
  EXPECT_FALSE(exists("page/figures/map_size.svg"));
  EXPECT_EQ(call({"compare", "out.h5", "--baseline", "ekf_slam"}).code, 0);
  EXPECT_EQ(call({"check", "drives.ini"}).code, 0);
}

TEST_F(SeveralDrives, AreShownEachByItself) {
  ASSERT_EQ(run("out.h5").code, 0);
  const Called shown = call({"analyze", "out.h5", "--csv", "all"});
  EXPECT_THAT(shown.out, HasSubstr("drive  raw RMS"));
  const auto all = engine::read_csv(folder_ / "all/own_drives.csv");
  ASSERT_EQ(all.size(), 6U);
  std::size_t number = 0;
  for (const std::string drive : {"long", "short", "middle"}) {
    SCOPED_TRACE(drive);
    ASSERT_EQ(run(drive + ".h5", {"--set", "scenario.path=" + drive, "--set", "study.runs=1"}).code,
              0);
    call({"analyze", drive + ".h5", "--csv", drive + "_alone"});
    const auto alone = [&](const std::string& file, const std::string& column) {
      return engine::read_csv(folder_ / (drive + "_alone") / file).at(0).at(column);
    };
    auto among_all = all[number++];
    EXPECT_EQ(among_all["cell"], "ekf_slam");
    EXPECT_EQ(among_all["rms [m]"], alone("runs.csv", "reference_rms [m]"));
    EXPECT_EQ(among_all["nees_ratio"], alone("drive.csv", "pose_nees_ratio"));
    EXPECT_EQ(among_all["nis_per_component"], alone("cells.csv", "nis_per_component"));
  }
  EXPECT_FALSE(exists("long_alone/own_drives.csv")) << "one drive is no drive among several";
}

// A robot that saw no landmark on one of its drives has a log without identities.
TEST_F(SeveralDrives, OfWhichOneSawNoLandmarkAreRun) {
  for (const std::string drive : {"long", "short", "middle"}) {
    DriveLog log = read_log_csv(folder_ / drive);
    for (LoggedScan& scan : log.scans) {
      if (drive == "short") scan.detections.clear();
      if (scan.detections.size() > 1) scan.detections.resize(1);
      for (Detection& detection : scan.detections) detection.identity = 0;
    }
    std::filesystem::remove_all(folder_ / drive);
    write_log_csv(log, folder_ / drive);
  }
  const Called called = run("out.h5");
  ASSERT_EQ(called.code, 0) << called.err;
  EXPECT_THAT(call({"analyze", "out.h5"}).out, HasSubstr("in 1 of 3 runs"));
}

TEST_F(SeveralDrives, StorePosesBetweenScansAsEachDriveAlone) {
  const std::vector<std::string> control = {"--set", "record.rate=control"};
  ASSERT_EQ(run("out.h5", control).code, 0);
  const ResultFile all(folder_ / "out.h5");
  const auto scores_of = [](const ResultFile& file) {
    return analysis::analyze(file).cells[0].get<analysis::DriveConsistencies>()[0].mean;
  };
  std::size_t run_number = 0, fixes = 0;
  double mean = 0.0;
  for (const std::string drive : {"long", "short", "middle"}) {
    std::vector<std::string> alone = control;
    alone.insert(alone.end(), {"--set", "scenario.path=" + drive, "--set", "study.runs=1"});
    ASSERT_EQ(run(drive + ".h5", alone).code, 0);
    const ResultFile one(folder_ / (drive + ".h5"));
    EXPECT_EQ(all.description().drives[run_number].step_times, one.times());
    std::vector<double> expected(3 * one.times().size()), found(3 * all.times().size());
    one.read(one.cells()[0], "pose_mean", 0, std::span(expected));
    all.read(all.cells()[0], "pose_mean", run_number++, std::span(found));
    EXPECT_TRUE(found.size() == expected.size() || std::isnan(found[expected.size()]));
    found.resize(expected.size());
    EXPECT_EQ(found, expected) << drive;
    const analysis::DriveScores judged = scores_of(one);
    EXPECT_EQ(judged.in_gaps, 0U);
    fixes += judged.fixes;
    mean += judged.leads().mean / 3.0;
  }
  EXPECT_EQ(scores_of(all).fixes, fixes);
  EXPECT_NEAR(scores_of(all).leads().mean, mean, 1e-12 * mean) << "STATISTICS (20.6)";
  EXPECT_EQ(call({"verify", "out.h5", "--sample", "6", "--data", "long,short,middle"}).code, 0);
  EXPECT_EQ(call({"report", "out.h5", "-o", "page"}).code, 0);
  EXPECT_EQ(call({"check", "drives.ini", "--set", "record.rate=control"}).code, 0);
}

TEST_F(SeveralDrives, ShardsThreadsResumptionVerifyAndReplayGiveTheSameBits) {
  ASSERT_EQ(run("out.h5", {"--threads", "1"}).code, 0);
  ASSERT_EQ(run("a.h5", {"--runs", "0:1"}).code, 0);
  ASSERT_EQ(run("b.h5", {"--runs", "1:3", "--threads", "2"}).code, 0);
  ASSERT_EQ(call({"merge", "merged.h5", "b.h5", "a.h5"}).code, 0);
  EXPECT_EQ(engine::difference(ResultFile(folder_ / "out.h5"), ResultFile(folder_ / "merged.h5")),
            "");
  EXPECT_EQ(run("out.h5", {"--resume"}).code, 0);
  const std::vector<std::string> verify = {"verify", "out.h5", "--sample", "6"};
  std::vector<std::string> words = verify;
  words.insert(words.end(), {"--data", "long,short,middle"});
  const Called called = call(words);
  EXPECT_THAT(called.out, StartsWith("6 of 6 runs are reproduced byte for byte")) << called.err;
  std::filesystem::rename(folder_ / "short", folder_ / "short, cut");
  words.back() = "long,short, cut,middle";
  EXPECT_EQ(call(words).code, 0) << "a folder with a comma in its name";
  std::filesystem::rename(folder_ / "short, cut", folder_ / "short");
  words.back() = "short,long,middle";
  EXPECT_THAT(call(words).err, HasSubstr("is another one than the study was made with"));
  words.back() = "long";
  EXPECT_THAT(call(words).err, HasSubstr("3 fingerprints of 1 drives"));
  const Called replay = call({"replay", "out.h5", "--cell", "ekf_slam", "--run", "1", "-o",
                              "again.h5", "--data", "long,short,middle"});
  EXPECT_EQ(replay.code, 0) << replay.err;
}

TEST_F(SeveralDrives, SayWhatDoesNotFitTogether) {
  const auto refused = [&](const std::string& setting, const std::string& words) {
    expect_refused({"run", "drives.ini", "-o", "x.h5", "--quiet", "--set", setting}, words);
  };
  refused("study.runs=2", "set runs = 3");
  refused("scenario.path=long, short, long", "long holds the drive of long again");
  refused("scenario.path=long,,short", "folders are separated by commas");
  std::filesystem::rename(folder_ / "short/reference.csv", folder_ / "short/reference_gps.csv");
  refused("study.runs=3", "drive 2 has the references");
  std::filesystem::rename(folder_ / "short/reference_gps.csv", folder_ / "short/reference.csv");
  write("short/landmarks.csv", "x_m,y_m\n1,2\n");
  refused("study.runs=3", "drive 2 has other surveyed landmarks");
}

const std::string kYard = R"([study]
name = yard
runs = 1
[scenario]
kind = log
path = yard
[belief]
vehicle = differential_drive
sigma_speed = 0.1
sigma_yaw_rate_deg = 1
sigma_range = 0.1
sigma_bearing_deg = 1
[cells]
cell = ekf_slam
)";

class RecordedLog : public Program {
 protected:
  RecordedLog() {
    write("yard.ini", kYard);
    std::filesystem::create_directory(folder_ / "yard");
    write("yard/start.csv", "time_s,x_m,y_m,heading_rad\n0,0,0,0\n");
    write("yard/odometry.csv", "time_s,speed_mps,yaw_rate_radps\n0,1,0\n1,1,0.1\n2,1,0\n");
    write("yard/reference.csv", "time_s,x_m,y_m\n0.5,0.5,0\n1.5,1.5,0\n");
  }
  /// The kind of association in the resolved study.
  std::string association(const std::vector<std::string>& more = {}) const {
    const Called called = call_with({"check", "yard.ini", "--text"}, more);
    EXPECT_EQ(called.code, 0) << called.err;
    const std::size_t section = called.out.find("[association]\nkind = ");
    return called.out.substr(section + 21, called.out.find('\n', section + 21) - section - 21);
  }
};

TEST_F(RecordedLog, UsesItsIdentitiesUnlessTheStudySaysOtherwise) {
  write("yard/detections.csv", "time_s,range_m,bearing_rad,identity\n0.5,5,0.1,0\n1.5,4,0.2,0\n");
  EXPECT_EQ(association(), "known");
  EXPECT_THAT(call({"check", "yard.ini"}).out, testing::ContainsRegex("association +known"));
  EXPECT_EQ(association({"--set", "association.kind=nearest"}), "nearest");
  write("yard/detections.csv", "time_s,range_m,bearing_rad\n0.5,5,0.1\n1.5,4,0.2\n");
  EXPECT_EQ(association(), "nearest");
}

}  // namespace
}  // namespace montecarta::experiments
