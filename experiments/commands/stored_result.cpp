// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/stored_result.hpp"

#include "engine/records/posix_file.hpp"
#include "experiments/commands/arguments.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace montecarta::experiments {

ResultFile open_stored(const std::string& name) {
  const std::filesystem::path part = part_of(name);
  if (is_there(name) || !is_there(part)) return ResultFile(name);
  std::cerr << "montecarta: " << name << " is unfinished; reading " << part.string() << "\n";
  return ResultFile(part);
}

void tell_what_explains(const std::string& name) {
  const std::string file = shell_quoted(name);
  std::cout << "How to read this: montecarta analyze " << file << " --explain\n"
            << "With figures:     montecarta report " << file << " -o DIR\n";
}

StatusCounts count_status(const std::vector<RunStatus>& status) {
  const auto count = [&](RunStatus wanted) {
    return static_cast<std::size_t>(std::ranges::count(status, wanted));
  };
  return {count(RunStatus::complete), count(RunStatus::failed), count(RunStatus::missing),
          count(RunStatus::spared)};
}

std::vector<TableRow> without_idle_spared(std::vector<TableRow> rows) {
  const auto is_idle = [](const TableRow& row) {
    return row.back() == "0" || row.back() == "spared";
  };
  if (!std::ranges::all_of(rows, is_idle)) return rows;
  for (TableRow& row : rows) row.pop_back();
  return rows;
}

}  // namespace montecarta::experiments
