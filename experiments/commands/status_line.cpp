// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/status_line.hpp"

#include "engine/records/result_slabs.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/text/numbers.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

/// "run 7 is damaged", of the first stored run that does not fit its fingerprint; empty where all
/// do.
std::string defect_of(const ResultFile& file) {
  const ResultSlabs slabs = find_slabs(file.path(), file.description());
  const PosixFile bytes(file.path(), PosixFile::Mode::read);
  std::vector<std::byte> buffer;
  for (std::size_t c = 0; c < slabs.cells.size(); ++c) {
    const std::vector<RunStatus> status = file.status(file.cells()[c]);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (!is_stored(status[i])) continue;
      if (!truth_is_whole(bytes, slabs, i, buffer) ||
          !run_is_whole(bytes, slabs.cells[c], i, buffer))
        return "run " + std::to_string(file.runs()[i]) + " does not fit its fingerprint";
    }
  }
  return {};
}

std::string line_of(const ResultFile& file, Depth depth) {
  StatusCounts all;
  for (const StoredCell& cell : file.cells()) {
    const StatusCounts counts = count_status(file.status(cell));
    all.complete += counts.complete;
    all.failed += counts.failed;
    all.missing += counts.missing;
  }
  const std::string flaw = depth == Depth::every_byte ? defect_of(file) : "";
  const char* state = !flaw.empty() ? "damaged" : all.missing > 0 ? "unfinished" : "complete";
  return joined(std::vector<std::string>{state, file.study_sha256(), std::to_string(all.complete),
                                         std::to_string(all.failed), std::to_string(all.missing),
                                         to_text(file.wall_seconds()), flaw},
                "\t");
}

}  // namespace

std::string status_line(const std::string& name, Depth depth) {
  std::string line;
  try {
    line = line_of(ResultFile(name), depth);
  } catch (const std::exception& error) {
    line = joined(std::vector<std::string>{"damaged", "", "0", "0", "0", "0", error.what()}, "\t");
  }
  std::ranges::replace(line, '\n', ' ');
  return name + "\t" + line + "\n";
}

}  // namespace montecarta::experiments
