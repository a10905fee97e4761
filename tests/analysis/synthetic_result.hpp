// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_writer.hpp"
#include "tests/analysis/synthetic_runs.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

namespace montecarta::analysis {

/// Overwrites the estimates of a record by the truth plus errors drawn from SyntheticStudy's
/// covariance, made `inflation` times larger than the covariance says.
inline void perturb(const Drive& drive, std::uint64_t run, double inflation, RunRecord& record) {
  const RecordLayout& layout = record.layout();
  const Eigen::Matrix3d P = SyntheticStudy::covariance();
  const Eigen::Matrix3d L = P.llt().matrixL();
  RngStream draw({3, run, 0, 0, Draw::test});
  for (const std::string suffix : {"", "_mixture"}) {
    if (!layout.find("pose_mean" + suffix)) continue;
    const auto mean = record.column<double>(*layout.find("pose_mean" + suffix));
    const auto covariance = record.column<double>(*layout.find("pose_covariance" + suffix));
    for (std::size_t k = 0; k < drive.truth.size(); ++k) {
      const Eigen::Vector3d noise(draw.normal(), draw.normal(), draw.normal());
      const Eigen::Vector3d error = inflation * (L * noise);
      const Pose& truth = drive.truth[k];
      mean[3 * k] = truth.x + error(0);
      mean[3 * k + 1] = truth.y + error(1);
      mean[3 * k + 2] = wrap(truth.heading + error(2));
      std::copy(P.data(), P.data() + 9, covariance.begin() + static_cast<std::ptrdiff_t>(9 * k));
    }
  }
}

/// The worst results of filters, in rows 80 to 199 of the first cell: a covariance of zero in run
/// 2, a mean that is no number in run 3, an infinite covariance in run 4.
inline void spoil_estimates(std::size_t cell, std::uint64_t run, RunRecord& record) {
  if (cell != 0) return;
  const auto rows = [&](const std::string& name, std::size_t width) {
    return record.column<double>(*record.layout().find(name)).subspan(80 * width, 120 * width);
  };
  for (const std::string suffix : {"", "_mixture"}) {
    const auto mean = rows("pose_mean" + suffix, 3),
               covariance = rows("pose_covariance" + suffix, 9);
    if (run == 2) std::ranges::fill(covariance, 0.0);
    if (run == 3) std::ranges::fill(mean, std::numeric_limits<double>::quiet_NaN());
    if (run == 4) std::ranges::fill(covariance, std::numeric_limits<double>::infinity());
  }
}

/// Marks a record as failed at `step`: as FORMAT.md has it, rows behind are not numbers.
inline void fail_at(std::uint32_t step, const std::string& reason, RunRecord& record) {
  for (const char* name : {"pose_mean", "pose_mean_mixture"}) {
    if (!record.layout().find(name)) continue;
    const auto mean = record.column<double>(*record.layout().find(name));
    std::fill(mean.begin() + 3 * (step + 1), mean.end(), std::numeric_limits<double>::quiet_NaN());
  }
  record.mark_failed(step, reason, 1);
}

/// A result with a perfect cell ("scripted_m4") and an overconfident one ("scripted_m3"); the last
/// run of this one failed at step 5. `spoil` may change the record of a (cell, run) before it is
/// stored, `change` the plan.
inline void write_synthetic_result(
    const std::filesystem::path& path, std::uint64_t runs = 12, std::size_t steps = 400,
    const std::function<void(std::size_t, std::uint64_t, RunRecord&)>& spoil = {},
    const std::function<void(StudyPlan&)>& change = {}) {
  StudyPlan plan = small_result_plan(runs, steps);
  if (change) change(plan);
  ResultWriter writer = ResultWriter::create(path, plan, {{"host", "nowhere"}}, Existing::replace);
  Drive drive;
  for (std::uint64_t run = 0; run < runs; ++run) {
    plan.drives->generate(run, drive);
    writer.write_truth(run, drive);
    for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
      const RecordLayout layout(plan.cells[cell], plan.columns, plan.drives->itinerary(),
                                run < plan.columns.full_runs ? Detail::full : Detail::usual);
      RunRecord record(layout);
      fill_record(plan, cell, run, drive, record);
      perturb(drive, run, cell == 0 ? 1.0 : 3.0, record);
      if (spoil) spoil(cell, run, record);
      if (cell == 1 && run + 1 == runs) fail_at(5, "gain is <not> a number & worse", record);
      writer.write(cell, run, record);
    }
  }
  writer.finish();
}

/// Makes a study store every column, so that every test of the analysis applies.
inline void store_everything(StudyPlan& plan) {
  plan.columns = {.covariance = true,
                  .ancestry = true,
                  .particles = true,
                  .association = true,
                  .map = true,
                  .final_map = true,
                  .joint = true};
  plan.scenario = {{"kind", "scripted"}, {"noise", "matched"}, {"association.kind", "known"}};
  for (Cell& cell : plan.cells) cell.reports.joint = true;
}

}  // namespace montecarta::analysis
