// SPDX-License-Identifier: BSD-3-Clause
// Estimates of another program: errors and deviations of each component, in the stated convention.
#include "analysis/metrics/imported_estimates.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace montecarta::analysis {
namespace {

/// Root mean squares over runs and scans that have a NEES, in the units of the components.
struct ComponentErrors {
  std::vector<double> error;      ///< {component}
  std::vector<double> deviation;  ///< {component} as the other program believes
};

class ComponentsOverRuns final : public MergedSums<ComponentsOverRuns> {
 public:
  explicit ComponentsOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    const ErrorRows& rows = run.rows.error;
    if (rows.components() == 0) return;
    const std::vector<double>& nees = run.metrics.nees(Moments::spread).value[0];
    squares_.resize(rows.components());
    variances_.resize(rows.components());
    for (std::size_t s = 0; s < rows.scans(); ++s) {
      if (std::isnan(nees[s])) continue;
      add(rows.error(s), rows.covariance_of(s));
    }
  }
  void put(CellAnalysis& cell) override {
    if (squares_.empty()) return;
    const auto root = [&](double sum) { return std::sqrt(sum / samples_); };
    ComponentErrors found;
    std::ranges::transform(squares_, std::back_inserter(found.error), root);
    std::ranges::transform(variances_, std::back_inserter(found.deviation), root);
    cell.findings.put(std::move(found));
  }
  static constexpr auto parts() {
    using Sums = ComponentsOverRuns;
    return std::tuple(added(&Sums::squares_, &Sums::variances_, &Sums::samples_));
  }

 private:
  void add(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    for (std::size_t c = 0; c < squares_.size(); ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      squares_[c] += error(i) * error(i);
      variances_[c] += covariance(i, i);
    }
    samples_ += 1.0;
  }

  std::vector<double> squares_, variances_;  ///< {component} sums
  double samples_ = 0.0;
};

TextTable component_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    const ComponentErrors& found = cell.get<ComponentErrors>();
    const std::size_t named =
        std::min(study.imported.components.size(), study.imported.units.size());
    for (std::size_t c = 0; c < std::min(found.error.size(), named); ++c) {
      table.add({{"cell", cell.label, Align::left},
                 {"component", study.imported.components[c], Align::left},
                 {"unit", study.imported.units[c], Align::left},
                 {"RMS error", readable(found.error[c])},
                 {"RMS sigma", readable(found.deviation[c])},
                 {"ratio", readable(found.error[c] / found.deviation[c])}});
    }
  }
  return table;
}

std::vector<Section> imported_sections(const StudyAnalysis& study) {
  if (!study.imported.is_imported()) return {};
  const CellNumber largest = [](const CellAnalysis& cell) {
    const ComponentErrors& found = cell.get<ComponentErrors>();
    double ratio = kNaN;
    for (std::size_t c = 0; c < found.error.size(); ++c) {
      ratio = std::fmax(ratio, found.error[c] / found.deviation[c]);
    }
    return ratio;
  };
  Section section = section_of("components", {{"ratio", range_over_cells(study, largest)}});
  section.add("components", component_table(study));
  section.add_notes("notes", {{"convention", study.imported.convention}});
  return {section};
}

std::vector<std::string> words_in(const std::string& list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(", ", begin), list.size());
    words.push_back(list.substr(begin, end - begin));
    begin = end + 2;
  }
  return words;
}

std::string sentence_on(const std::string& convention) {
  if (convention == "body") return "in the frame of the estimate";
  if (convention == "right-invariant")
    return "right-invariant: the logarithm of mean times inverse truth";
  return "estimate minus truth in the frame of the map";
}

/// Whether no family rejects it.
bool fits_errors(const Verdict& found) {
  return std::ranges::none_of(found.families, &FamilyTest::is_rejected);
}

std::string comma_joined(const std::vector<std::string>& parts) {
  std::string all;
  for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
  return all;
}

class HintsOverRuns final : public MergedSums<HintsOverRuns> {
 public:
  explicit HintsOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    const ErrorRows& error = run.rows.error;
    if (error.nees_by.front().empty()) return;
    if (!hints_) hints_.emplace(error.components(), criteria_->times.size());
    hints_->add(error.nees_by);
  }
  void put(CellAnalysis& cell) override {
    if (!hints_) return;
    const double level = criteria_->verdict_level(cell.complete + cell.failures.size());
    cell.findings.put(hints_->result(criteria_->times, level, criteria_->within));
  }
  static constexpr auto parts() { return std::tuple(added(&HintsOverRuns::hints_)); }

 private:
  const RunCriteria* criteria_;
  std::optional<ConventionHints> hints_;
};

}  // namespace

ImportedState imported_state(const StoredCell& cell) {
  ImportedState found;
  if (!cell.has("error")) return found;
  const auto setting = [&](const char* name) {
    const auto pair = std::ranges::find(cell.settings, name, &TextPairs::value_type::first);
    return pair == cell.settings.end() ? std::string() : pair->second;
  };
  found.state = setting("state");
  found.convention = setting("error");
  found.components = words_in(setting("components"));
  found.units = words_in(setting("units"));
  return found;
}

std::string components_text(const StudyAnalysis& study) {
  std::string all;
  for (const std::string& name : study.imported.components) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::vector<std::string> imported_notes(const StudyAnalysis& study) {
  if (!study.imported.is_imported()) return {};
  const std::string& convention = study.imported.convention;
  std::vector<std::string> notes = {prose("components", "imported",
                                          {{"convention", convention},
                                           {"meaning", sentence_on(convention)},
                                           {"components", components_text(study)}})};
  for (const CellAnalysis& cell : study.cells) {
    const std::string hint = in_words(cell.get<ConventionHint>(), cell.label, convention);
    if (!hint.empty()) notes.push_back(prose("components", "hint", {{"hint", hint}}));
  }
  for (const CellAnalysis& cell : study.cells) {
    const NeesResult* all = cell.find_nees(ErrorBlock::pose, cell.leading);
    if (all == nullptr || all->series.unusable == 0) continue;
    const double share =
        static_cast<double>(all->series.unusable) / static_cast<double>(all->series.samples);
    notes.push_back(prose("components", "unusable",
                          {{"cell", cell.label},
                           {"unusable", std::to_string(all->series.unusable)},
                           {"samples", std::to_string(all->series.samples)},
                           {"share", percent(share)}}));
  }
  return notes;
}

Metric imported_metric() {
  return {.sums = make_sums<ComponentsOverRuns>, .sections = imported_sections};
}

ConventionHints::ConventionHints(std::size_t components, std::size_t scans)
    : components_(static_cast<double>(components)),
      nees_(kErrorConventions.size(), SummedError(scans)) {}

void ConventionHints::add(const std::array<std::vector<double>, kErrorConventions.size()>& nees) {
  ++runs_;
  for (std::size_t k = 0; k < nees_.size(); ++k) {
    if (!nees[k].empty()) nees_[k].add(nees[k], components_);
  }
}

ConventionHint ConventionHints::result(std::span<const double> times, double level,
                                       double within) const {
  ConventionHint hint;
  for (const SummedError& nees : nees_) {
    hint.by_convention.push_back(judge(nees.families(level, times), level, within, runs_));
  }
  return hint;
}

std::string in_words(const ConventionHint& hint, const std::string& cell, const std::string& said) {
  std::vector<std::string> fitting, others;
  bool said_fits = false;
  for (std::size_t k = 0; k < hint.by_convention.size(); ++k) {
    const Verdict& found = hint.by_convention[k];
    if (found.answer == Answer::untested) return "";
    if (said == kErrorConventions[k].name) {
      said_fits = fits_errors(found);
    } else {
      (fits_errors(found) ? fitting : others)
          .push_back(std::string(kErrorConventions[k].name) + " (NEES ratio " +
                     compact(found.ratio_estimate()) + ")");
    }
  }
  if (fitting.empty() && others.empty()) return "";
  std::string words = cell + ": the verdict is by the error " + said + ". ";
  if (fitting.empty())
    return words + "Every other would have been rejected" + (said_fits ? ": " : " as well: ") +
           comma_joined(others);
  words += "The same covariances would not have been rejected as " + comma_joined(fitting);
  if (!others.empty()) words += ", but as " + comma_joined(others);
  return words + (said_fits ? ": this study cannot tell them apart"
                            : ": were they meant so? If not, this is by chance, and no verdict");
}

Metric convention_hints_metric() { return {.sums = make_sums<HintsOverRuns>}; }

}  // namespace montecarta::analysis
