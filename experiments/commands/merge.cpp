// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/merge.hpp"

#include "engine/records/posix_file.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/output_path.hpp"

#include <iostream>

namespace montecarta::experiments {

int merge_command(const Arguments& arguments) {
  const std::vector<std::string>& names = arguments.operands();
  const std::vector<std::filesystem::path> shards(names.begin() + 1, names.end());
  const Existing existing = arguments.has("force") ? Existing::replace : Existing::refuse;
  require_place_for_result(names.front());
  const MergeSummary summary = merge_results(names.front(), shards, existing);
  for (const std::string& note : summary.notes) std::cerr << "montecarta: " << note << "\n";
  std::cerr << "montecarta: " << summary.runs << " runs of " << summary.cells << " cells out of "
            << shards.size() << " files, " << bytes_text(static_cast<double>(summary.bytes))
            << ", stored in " << names.front() << "\n";
  return kDone;
}

}  // namespace montecarta::experiments
