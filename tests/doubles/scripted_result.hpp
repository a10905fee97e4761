// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/recorder.hpp"
#include "engine/records/result_writer.hpp"
#include "tests/doubles/scripted_study.hpp"

#include <filesystem>

namespace montecarta::engine {

/// Two cells (4 and 3 particles) of a small scripted study with every column.
inline StudyPlan small_result_plan(std::uint64_t runs = 3, std::size_t steps = 24) {
  StudyPlan plan = scripted_study(runs, steps);
  plan.cells = {scripted_cell("scripted_m4", {.particles = 4}),
                scripted_cell("scripted_m3", {.particles = 3})};
  return plan;
}

/// The same study confined to runs [first, last).
inline StudyPlan part_of_plan(StudyPlan plan, std::uint64_t first, std::uint64_t last) {
  plan.first_run = first;
  plan.last_run = last;
  return plan;
}

inline RecordLayout layout_of(const StudyPlan& plan) {
  return {plan.cells[0], plan.columns, plan.drives->itinerary()};
}

/// Takes the filter of a cell through one run; every record of (cell, run) is the same.
inline void fill_record(const StudyPlan& plan, std::size_t cell, std::uint64_t run,
                        const Drive& drive, RunRecord& record) {
  const Itinerary& itinerary = plan.drives->itinerary();
  const auto filter = plan.cells[cell].make_filter();
  Recorder recorder(record);
  record.clear();
  filter->start(itinerary.start);
  for (std::size_t k = 0, s = 0; k < itinerary.steps(); ++k) {
    const StepContext context(plan.seed, run, static_cast<std::uint32_t>(k), Parallel::serial());
    filter->predict(context, drive.controls[k], itinerary.duration(k));
    if (s < itinerary.scans() && itinerary.scan_step[s] == k) {
      filter->update(context, drive.scan(s));
      recorder.after_scan(*filter, s++);
    }
    recorder.after_step(*filter, k);
  }
  record.mark_complete(0.25 + static_cast<double>(run));
}

/// The record of one run of a cell, complete, with the layout and the drive that it is of.
struct FilledRecord {
  FilledRecord(const StudyPlan& plan, std::size_t cell, std::uint64_t run)
      : layout(plan.cells.at(cell), plan.columns, plan.drives->itinerary(),
               run < plan.columns.full_runs ? Detail::full : Detail::usual),
        record(layout) {
    plan.drives->generate(run, drive);
    fill_record(plan, cell, run, drive, record);
  }
  template <class Number>
  auto column(std::string_view name) {
    return record.column<Number>(layout.find(name).value());
  }

  RecordLayout layout;
  Drive drive;
  RunRecord record;
};

/// Computes and stores all cells of one run of the plan (`run` is the number in the study).
inline void store_run(ResultWriter& writer, const StudyPlan& plan, std::uint64_t run) {
  const std::size_t index = run - plan.first_run;
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    const FilledRecord filled(plan, cell, run);
    if (cell == 0) writer.write_truth(index, filled.drive);
    writer.write(cell, index, filled.record);
  }
}

/// A finished result of the plan at `path`.
inline void write_result(const std::filesystem::path& path, const StudyPlan& plan) {
  ResultWriter writer = ResultWriter::create(path, plan, {{"host", "nowhere"}}, Existing::refuse);
  for (std::uint64_t run = plan.first_run; run < plan.last_run; ++run) store_run(writer, plan, run);
  writer.finish();
}

}  // namespace montecarta::engine
