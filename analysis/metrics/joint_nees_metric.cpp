// SPDX-License-Identifier: BSD-3-Clause
// Pose and map together.
#include "analysis/metrics/joint_figure.hpp"
#include "analysis/metrics/joint_nees.hpp"
#include "analysis/metrics/joint_table.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/statistics/means.hpp"

namespace montecarta {
namespace {

constexpr Score kJointNeesScores[] = {
    {"joint_nees", "1", "joint NEES of pose and map per component",
     [](const MeasuredRun& run) {
       return run.has_identities ? nees_per_component(run.joint) : kNaN;
     },
     Better::neither}};

class JointNeesOverRuns final : public MetricSums {
 public:
  explicit JointNeesOverRuns(const Yardsticks& sticks) : sticks_(&sticks) {}
  void add(const MeasuredRun& run) override { joint_.add(run.joint); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(joint_.result(sticks_->level, sticks_->map.identities_known));
  }

 private:
  const Yardsticks* sticks_;
  JointNeesSums joint_;
};

/// At the last stored scan.
void joint_nees_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const JointConsistency& joint = cell.get<JointConsistency>();
  const bool known = joint.verdict != Verdict::untested;
  const Interval bounds = known ? joint.bounds.back() : Interval{kNaN, kNaN};
  all.push_back({"joint_components", "1", known ? joint.dimension.back() : kNaN});
  all.push_back({"joint_nees_per_component", "1", known ? joint.average.back() : kNaN});
  all.push_back({"joint_nees_lower", "1", bounds.lower});
  all.push_back({"joint_nees_upper", "1", bounds.upper});
  all.push_back({"joint_undefined", "1", static_cast<double>(joint.undefined)});
}

std::vector<Section> joint_nees_sections(const StudyAnalysis& study) {
  Section section{"joint_nees", "Pose and map together"};
  section.add("joint_nees", joint_table(study));
  section.add(joint_notes(study));
  return {section, figure_section("joint_nees_over_time", {joint_figure(study)})};
}

}  // namespace

Metric joint_nees_metric() {
  return {.scores = kJointNeesScores,
          .sums = [](const Yardsticks& sticks) -> std::unique_ptr<MetricSums> {
            return std::make_unique<JointNeesOverRuns>(sticks);
          },
          .add_numbers = joint_nees_numbers,
          .sections = joint_nees_sections};
}

}  // namespace montecarta
