// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/imported_plan.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

namespace montecarta::experiments {
namespace {

/// A source of drives that has only the times of the estimates.
class ImportedDrives final : public DriveSource {
 public:
  ImportedDrives(std::vector<double> times, bool has_truth) {
    itinerary_.step_time = std::move(times);
    itinerary_.scan_step.resize(itinerary_.step_time.size());
    std::iota(itinerary_.scan_step.begin(), itinerary_.scan_step.end(), 0U);
    itinerary_.has_truth = has_truth;
  }
  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t /*run*/, Drive& /*drive*/) const override {
    expect(false, "the drive of an imported estimate was asked for");
  }

 private:
  Itinerary itinerary_;
};

TextPairs import_settings(const StateShape& shape, const JudgingOptions& options) {
  if (shape.dimension() == 0) {
    return {{"state", "innovations"}};
  }
  std::vector<std::string> components, units;
  for (const Eigen::Index k : judged_components(shape, options.components)) {
    components.push_back(shape.components[static_cast<std::size_t>(k)]);
    units.push_back(shape.units[static_cast<std::size_t>(k)]);
  }
  const bool is_whole = components.size() == shape.dimension();
  const std::string state = name_of(is_whole ? shape.kind : StateKind::vector);
  TextPairs settings = {{"state", options.are_innovations ? "innovations" : state},
                        {"error", name_of(*options.convention)},
                        {"components", joined(components)},
                        {"units", joined(units)}};
  if (!options.windows.empty()) {
    std::vector<std::string> windows;
    for (const double window : options.windows) windows.push_back(to_text(window));
    settings.emplace_back("windows", joined(windows));
  }
  if (options.anchor) {
    settings.emplace_back("anchor", name_of(*options.anchor));
    settings.emplace_back("moved", moved_by(*options.anchor));
  }
  if (!options.pair.empty()) settings.emplace_back("pair", options.pair);
  if (options.adds_truth_covariance) settings.emplace_back("truth_covariance", "added");
  return settings;
}

std::string import_text(const EstimateSource& source, const TextPairs& settings) {
  const std::vector<std::uint64_t>& runs = source.runs();
  TextPairs all = settings;
  all.emplace_back("runs", formatted("{}:{}", runs.front(), runs.back() + 1));
  std::ranges::copy(source.contents(), std::back_inserter(all));
  std::string text = std::string(kImportedSection) + "\n";
  for (const auto& [name, value] : all) text += formatted("{} = {}\n", name, value);
  return text;
}

Cell imported_cell(const std::string& label, const StateRows& first, std::size_t components,
                   TextPairs settings) {
  const bool is_whole = components == first.shape.dimension();
  const std::size_t known = conventions_of(first.shape.kind).size();
  const std::size_t conventions = is_whole && known > 1 ? known : 0;
  Cell cell;
  cell.label = label;
  cell.filter = "imported";
  cell.long_name = label + " (imported)";
  cell.imported = ImportedError{.components = components,
                                .has_innovations = !first.nis.empty(),
                                .conventions = conventions,
                                .has_pose = is_whole && first.shape.kind == StateKind::pose};
  cell.settings = std::move(settings);
  return cell;
}

}  // namespace

std::vector<Eigen::Index> judged_components(const StateShape& shape,
                                            const std::vector<std::string>& wanted) {
  std::vector<Eigen::Index> judged;
  for (const std::string& name : wanted.empty() ? shape.components : wanted) {
    const auto found = std::ranges::find(shape.components, name);
    if (found == shape.components.end()) {
      throw StudyError("--components: no component '{}' (the state has {}): choose among them",
                       excerpt(name), joined(shape.components, ","));
    }
    judged.push_back(found - shape.components.begin());
  }
  std::ranges::sort(judged);
  judged.erase(std::unique(judged.begin(), judged.end()), judged.end());
  return judged;
}

StudyPlan imported_plan(const EstimateSource& source, const StateRows& first,
                        std::vector<double> times, const JudgingOptions& options) {
  const TextPairs settings = import_settings(first.shape, options);
  const std::size_t components = judged_components(first.shape, options.components).size();
  StudyPlan plan;
  plan.name = options.output.stem().string();
  plan.title = "Imported estimates: " + plan.name;
  plan.first_run = source.runs().front();
  plan.last_run = plan.runs = source.runs().back() + 1;
  plan.columns = {.ancestry = false, .scans_only = true};
  for (std::size_t c = 0; c < source.cells().size(); ++c) {
    TextPairs all = settings;
    if (!options.bounds_anchored.empty() && options.bounds_anchored[c])
      all.emplace_back("anchored", "bounded");
    if (!options.bounds_increments.empty() && options.bounds_increments[c])
      all.emplace_back("increments", "bounded");
    std::ranges::copy(source.settings(c), std::back_inserter(all));
    plan.cells.push_back(imported_cell(source.cells()[c], first, components, std::move(all)));
  }
  plan.drives =
      std::make_shared<ImportedDrives>(std::move(times), plan.cells.front().imported->has_pose);
  plan.scenario = {{"kind", "imported"},
                   {"tolerance", to_text(options.match.tolerance)},
                   {"interpolate", options.match.interpolate ? "yes" : "no"}};
  if (options.equal_times != EqualTimes::refuse) {
    plan.scenario.emplace_back("keep",
                               options.equal_times == EqualTimes::keep_first ? "first" : "last");
  }
  TextPairs all = settings;
  if (options.gates) all.emplace_back("gate", options.gates->text());
  all.insert(all.end(), plan.scenario.begin() + 1, plan.scenario.end());
  plan.resolved_text = import_text(source, all);
  if (options.within)
    plan.resolved_text += formatted("[study]\nwithin = {}\n", to_text(*options.within));
  return plan;
}

}  // namespace montecarta::experiments
