// SPDX-License-Identifier: BSD-3-Clause
// Estimates of another program: verdicts on position, rotation and velocity by themselves.
#include "analysis/run/imported_state.hpp"
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/block_errors.hpp"
#include "analysis/verdict/sentence.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

class BlocksOverRuns final : public MergedSums<BlocksOverRuns> {
 public:
  explicit BlocksOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {
    const bool is_state = criteria.innovation_components == 0;
    if (is_state) blocks_ = blocks_of(criteria.components, criteria.units);
  }
  void add(const MeasuredRun& run) override {
    if (blocks_.empty() || run.rows.error.value.empty()) return;
    if (!sums_) sums_.emplace(blocks_, criteria_->times.size());
    sums_->add(run.rows.error, run.rows.run, blocks_);
  }
  void put(CellAnalysis& cell) override {
    if (!sums_) return;
    std::vector<BlockVerdict> found =
        sums_->result(blocks_, {criteria_->components, criteria_->times}, criteria_->level,
                      criteria_->within, cell.complete);
    if (has_bounds(cell.settings)) {
      for (BlockVerdict& block : found) take_for_upper_bounds(block.verdict);
    }
    cell.findings.put(std::move(found));
  }
  static constexpr auto parts() { return std::tuple(added(&BlocksOverRuns::sums_)); }

 private:
  const RunCriteria* criteria_;
  std::vector<StateBlock> blocks_;
  std::optional<BlockErrors> sums_;
};

TextTable block_table(const StudyAnalysis& study) {
  TextTable table{.keys = 2};
  for (const CellAnalysis& cell : study.cells) {
    for (const BlockVerdict& block : cell.get<std::vector<BlockVerdict>>()) {
      table.add({{"cell", cell.label, Align::left},
                 {"block", block.name, Align::left},
                 {"verdict", in_words(block.verdict), Align::left, tone_of(block.verdict)},
                 {ratio_heading(study), ratio_text_of(block.verdict)}});
    }
  }
  return table;
}

Frame blocks_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (const BlockVerdict& block : cell.get<std::vector<BlockVerdict>>()) {
      const Verdict& found = block.verdict;
      frame.add({{"cell", cell.label}, {"block", block.name}, {"verdict", name_of(found.answer)}},
                {{"nees_ratio", "1", found.ratio_estimate()},
                 {"nees_ratio_lower", "1", found.ratio().lower},
                 {"nees_ratio_upper", "1", found.ratio().upper}});
    }
  }
  return frame;
}

std::vector<Section> blocks_sections(const StudyAnalysis& study) {
  const CellNumber largest = [](const CellAnalysis& cell) {
    double ratio = kNaN;
    for (const BlockVerdict& block : cell.get<std::vector<BlockVerdict>>())
      ratio = std::fmax(ratio, block.verdict.ratio_estimate());
    return ratio;
  };
  return table_section(section_of("blocks", {{"ratio", range_over_cells(study, largest)}}),
                       block_table(study), {{"error", level_text(1.0 - study.level)}});
}

}  // namespace

Metric blocks_metric() {
  return {.sums = make_sums<BlocksOverRuns>,
          .sections = blocks_sections,
          .files = {{"blocks.csv", blocks_frame}}};
}

}  // namespace montecarta::analysis
