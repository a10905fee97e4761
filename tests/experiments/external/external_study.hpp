// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/text/words.hpp"
#include "tests/analysis/studied_result.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace montecarta::experiments {

/// Studies of the tiny loop whose cell is a program.
class ExternalStudy : public testing::Test {
 protected:
  /// The line of a cell that runs the scripted program (tests/doubles/scripted_program.cpp).
  static std::string scripted(const std::string& arguments, const std::string& options = "") {
    return "external command=" + in_quotes(MONTECARTA_SCRIPTED_PROGRAM " " + arguments) +
           " label=mine " + options;
  }

  StudyPlan plan_of(const std::string& cell, std::vector<std::string> overrides = {}) const {
    overrides.push_back("cells.cell=" + cell);
    return make_plan(parse_study(kTinyLoop, "tiny.ini", ".", overrides), std::nullopt,
                     ExternalPrograms::allowed);
  }

  /// The result of all runs.
  ResultFile result_of(const std::string& cell, const std::vector<std::string>& overrides = {},
                       int threads = 1) const {
    const std::filesystem::path path = folder_ / ("out" + std::to_string(++files_) + ".h5");
    run_study(plan_of(cell, overrides),
              {.output = path, .parallel = Parallel(Backend::tbb, threads), .quiet = true});
    return ResultFile(path);
  }

  /// Column of run index i of the only cell.
  static std::vector<double> values(const ResultFile& file, const std::string& name,
                                    std::size_t i) {
    const StoredCell& cell = file.cells().front();
    for (const Column& column : cell.columns) {
      if (column.name != name) continue;
      std::vector<double> numbers(column.elements());
      file.read(cell, name, i, numbers);
      return numbers;
    }
    return {};
  }
  /// x of the last pose.
  static double last_x(const ResultFile& file, std::size_t i) {
    const std::vector<double> mean = values(file, "pose_mean", i);
    return mean[mean.size() - 3];
  }

  ScratchFolder folder_;
  mutable int files_ = 0;
};

}  // namespace montecarta::experiments
