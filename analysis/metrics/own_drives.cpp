// SPDX-License-Identifier: BSD-3-Clause
// Each recorded drive by itself, where every run processes a drive of its own.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/number_text.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// The findings on one drive alone.
struct JudgedDrive {
  /// By the leading reference; untested if it states no errors.
  DriveConsistency consistency;
  double nis = kNaN;              ///< NIS per component
  std::string innovations = "-";  ///< whiteness and size in words
};

/// The NEES relative to its expectation; nullptr if it could not be judged.
const CorrelatedAverage* judged_nees(const JudgedDrive& drive) {
  const CorrelatedAverage& nees = drive.consistency.mean.leads();
  return nees.effective_samples > 0.0 ? &nees : nullptr;
}

/// {complete run} findings.
using OwnDrives = std::vector<JudgedDrive>;

/// Keeps the findings of each run. Files of sums hold no recorded drives, so nothing is stored.
class OwnDrivesOverRuns final : public MetricSums {
 public:
  explicit OwnDrivesOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    if (criteria_->drives.empty()) return;
    JudgedDrive drive;
    if (!run.drives.empty()) {
      drive.consistency =
          judge_drive(std::span(run.drives).first(1), criteria_->level, criteria_->within);
      drive.consistency.mean.errors = {};  // long lists, which nobody needs any more
    }
    judge_innovations(run, drive);
    drives_.push_back(std::move(drive));
  }
  void merge(MetricSums& next) override {
    append(drives_, static_cast<OwnDrivesOverRuns&>(next).drives_);
  }
  void write(SumWriter& /*words*/) const override {}
  void read(SumReader& /*words*/) override {}
  void add_layout(std::string& /*text*/) const override {}
  void put(CellAnalysis& cell) override {
    if (!drives_.empty()) cell.findings.put(std::move(drives_));
  }

 private:
  void judge_innovations(const MeasuredRun& run, JudgedDrive& drive) const {
    if (run.rows.nis.empty()) return;
    InnovationSums sums(run.times.size());
    sums.add(run.rows.run, run.times, run.rows.nis, run.rows.nis_dof);
    if (sums.empty()) return;
    const Innovations found = sums.result(run.times, criteria_->level, criteria_->within);
    drive.nis = found.ratio;
    drive.innovations = whiteness_in_words(found);
  }

  const RunCriteria* criteria_;
  OwnDrives drives_;
};

/// Calls visit(cell, number of the run, scores by the leading reference, JudgedDrive) for every
/// complete run on a drive of its own.
template <class Visit>
void for_each_run(const StudyAnalysis& study, const Visit& visit) {
  for (const CellAnalysis& cell : study.cells) {
    const ReferenceAnalyses& references = cell.get<ReferenceAnalyses>();
    const OwnDrives& drives = cell.get<OwnDrives>();
    for (std::size_t i = 0; i < drives.size(); ++i) {
      visit(cell, cell.runs[i], references.empty() ? ReferenceScores{} : references[0].runs[i],
            drives[i]);
    }
  }
}

TextTable own_drives_table(const StudyAnalysis& study) {
  TextTable table{.keys = 2};
  for_each_run(study, [&](const auto& cell, auto run, const auto& scores, const auto& drive) {
    const DriveScores& along = drive.consistency.mean;
    const CorrelatedAverage* nees = judged_nees(drive);
    table.add(
        {{"cell", cell.label, Align::left},
         {"drive", std::to_string(run)},
         {"raw RMS [m]", readable(scores.rms)},
         {"heading RMSE [deg]", readable(scores.heading_rmse * 180.0 / kPi)},
         {"verdict", in_words(drive.consistency), Align::left, tone_of(drive.consistency.answer)},
         {"NEES / expected", nees != nullptr ? readable(nees->mean) : "-"},
         {"fixes", std::to_string(along.fixes)},
         {"NIS per component", readable(drive.nis)},
         {"innovations", drive.innovations, Align::left}});
  });
  return table;
}

std::vector<Section> own_drives_sections(const StudyAnalysis& study) {
  const TextTable table = own_drives_table(study);
  if (table.rows.empty()) return {};
  Section section = section_of("own_drives");
  section.add("own_drives", table);
  section.add_notes("notes");
  return {section};
}

Frame own_drives_frame(const StudyAnalysis& study) {
  Frame frame;
  for_each_run(study, [&](const auto& cell, auto run, const auto& scores, const auto& drive) {
    const CorrelatedAverage* nees = judged_nees(drive);
    const Interval ratio = nees != nullptr ? nees->ratio : Interval{kNaN, kNaN};
    frame.add({{"cell", cell.label},
               {"filter", cell.filter},
               {"verdict", in_words(drive.consistency)},
               {"innovations", drive.innovations}},
              {{"run", "1", static_cast<double>(run)},
               {"rms", "m", scores.rms},
               {"heading_rmse", "rad", scores.heading_rmse},
               {"fixes", "1", static_cast<double>(drive.consistency.mean.fixes)},
               {"nees_ratio", "1", nees != nullptr ? nees->mean : kNaN},
               {"nees_ratio_lower", "1", ratio.lower},
               {"nees_ratio_upper", "1", ratio.upper},
               {"nis_per_component", "1", drive.nis}});
  });
  return frame;
}

}  // namespace

Metric own_drives_metric() {
  return {.sums = make_sums<OwnDrivesOverRuns>,
          .sections = own_drives_sections,
          .files = {{"own_drives.csv", own_drives_frame}}};
}

}  // namespace montecarta::analysis
