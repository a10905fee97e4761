// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/formatted.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/shared_work.hpp"
#include "experiments/study/study.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace montecarta::experiments {

/// One filter in one world, with the file that says that it is done.
struct BenchmarkTask {
  BenchmarkFilter filter;
  std::string world;
  std::filesystem::path entry;

  std::filesystem::path result() const {
    return std::filesystem::path(entry).replace_extension(".h5");
  }
  std::string name() const { return formatted("{} in {}", filter.label, world); }
};

/// The options of one process, perhaps beside others, and the folder of its results.
struct BenchmarkWorker {
  SharedWork work;
  std::filesystem::path folder;

  const Arguments& arguments() const { return work.arguments(); }
  std::optional<std::uint64_t> runs() const { return arguments().count("runs", 3, 1'000'000); }
  Study study(const BenchmarkTask& task) const {
    return benchmark_study(task.world, task.filter.cell, runs());
  }
};

}  // namespace montecarta::experiments
