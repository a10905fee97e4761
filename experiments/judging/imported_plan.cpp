// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/judged_study.hpp"
#include "experiments/judging/state_rows.hpp"
#include "experiments/text/words.hpp"

#include <memory>
#include <numeric>

namespace montecarta::experiments {
namespace {

/// The times of estimates; what was driven then nobody tells.
class ImportedDrives final : public DriveSource {
 public:
  explicit ImportedDrives(const StateRows& rows) {
    itinerary_.step_time = rows.time;
    itinerary_.scan_step.resize(rows.time.size());
    std::iota(itinerary_.scan_step.begin(), itinerary_.scan_step.end(), 0U);
    itinerary_.has_truth = rows.shape.kind == StateKind::pose;
  }
  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t /*run*/, Drive& /*drive*/) const override {
    expect(false, "the drive of an imported estimate was asked for");
  }

 private:
  Itinerary itinerary_;
};

/// Of all files, in their order, and of what is read beside each.
std::string contents_of(const std::vector<std::filesystem::path>& files) {
  std::string all;
  for (const std::filesystem::path& file : files) {
    all += sha256(whole_file(file)) + "\n";
    if (const auto beside = innovations_beside(file)) all += sha256(whole_file(*beside)) + "\n";
  }
  return sha256(all);
}

TextPairs import_settings(const StateRows& first, const JudgingOptions& options) {
  return {{"state", name_of(first.shape.kind)},
          {"error", name_of(*options.convention)},
          {"components", joined(first.shape.components)},
          {"units", joined(first.shape.units)}};
}

std::string import_text(const JudgedFiles& files, const TextPairs& settings) {
  std::string text = std::string(kImportedSection) + "\n";
  const auto add = [&](const std::string& name, const std::string& value) {
    text += name + " = " + value + "\n";
  };
  for (const auto& [name, value] : settings) add(name, value);
  add("runs", std::to_string(files.runs.front()) + ":" + std::to_string(files.runs.back() + 1));
  add("truth_sha256", contents_of(files.truth));
  for (const EstimatorFiles& cell : files.cells)
    add("sha256 of " + cell.cell, contents_of(cell.of_run));
  return text;
}

Cell imported_cell(const EstimatorFiles& files, const StateRows& first, const TextPairs& settings) {
  Cell cell;
  cell.label = files.cell;
  cell.filter = "imported";
  cell.long_name = files.cell + " (imported)";
  cell.error_components = first.shape.dimension();
  cell.innovations = !first.nis.empty();
  cell.several_conventions = conventions_of(first.shape.kind).size() > 1;
  cell.poses = first.shape.kind == StateKind::pose;
  cell.settings = settings;
  return cell;
}

}  // namespace

StudyPlan imported_plan(const JudgedFiles& files, const StateRows& first,
                        const JudgingOptions& options) {
  const TextPairs settings = import_settings(first, options);
  StudyPlan plan;
  plan.name = options.output.stem().string();
  plan.title = "Imported estimates: " + plan.name;
  plan.first_run = files.runs.front();
  plan.last_run = plan.runs = files.runs.back() + 1;
  plan.columns = {.ancestry = false, .scans_only = true};
  plan.drives = std::make_shared<ImportedDrives>(first);
  plan.scenario = {{"kind", "imported"},
                   {"tolerance", to_text(options.match.tolerance)},
                   {"interpolate", options.match.interpolate ? "yes" : "no"}};
  TextPairs all = settings;
  all.insert(all.end(), plan.scenario.begin() + 1, plan.scenario.end());
  plan.resolved_text = import_text(files, all);
  if (options.within) plan.resolved_text += "[study]\nwithin = " + to_text(*options.within) + "\n";
  for (const EstimatorFiles& cell : files.cells)
    plan.cells.push_back(imported_cell(cell, first, settings));
  return plan;
}

}  // namespace montecarta::experiments
