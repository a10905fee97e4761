// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/stored_result.hpp"

#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/study_analysis.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/provenance.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/sum_groups.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/visible_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/judging/imported_plan.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/text/words.hpp"

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

namespace {

/// [byte] Size of a result above which its verdict is not computed unasked.
constexpr std::uintmax_t kLargestVerdict = 2'000'000'000;

}  // namespace

bool print_verdict(const std::filesystem::path& result, const Parallel& parallel) {
  if (std::filesystem::file_size(result) > kLargestVerdict) {
    std::cout << "The verdict: montecarta analyze " << shell_quoted(result.string()) << "\n";
    return false;
  }
  const ResultFile file(result);
  print_summary(std::cout, analyze(file, kUsualLevel, parallel), output_width());
  std::cout << std::flush;
  return true;
}

void print_where_to_look(const std::string& name, const std::string& page) {
  const std::string file = shell_quoted(name);
  std::cout << "Page: " << (page.empty() ? formatted("montecarta report {} -o DIR", file) : page)
            << "\n"
            << "More: montecarta analyze " << file << " --all (or --table NAME)\n";
}

RunCounts count_status(const std::vector<RunStatus>& status) {
  RunCounts counts;
  for (const RunStatus each : status) counts.add(each);
  return counts;
}

RunCounts count_status(const ResultFile& file, const StoredCell& cell) {
  if (!file.has_sums()) return count_status(file.status(cell));
  RunCounts counts;
  for (const SumGroup& group : file.sum_groups(cell)) {
    counts.complete += group.complete;
    counts.failed += group.failed;
  }
  return counts;
}

std::vector<TableRow> without_idle_not_needed(std::vector<TableRow> rows) {
  const auto is_idle = [](const TableRow& row) {
    return row.back() == "0" || row.back() == "not needed";
  };
  if (!std::ranges::all_of(rows, is_idle)) return rows;
  for (TableRow& row : rows) row.pop_back();
  return rows;
}

Study study_in(const ResultFile& file, const Arguments& arguments) {
  if (file.study_text().starts_with(kImportedSection)) {
    throw StudyError(file.path().string() +
                     ": holds estimates that another program computed (nothing here can compute "
                     "them again): judge the same files again with 'montecarta judge'");
  }
  std::vector<std::string> overrides;
  if (const auto folders = arguments.text("data")) {
    std::vector<std::string> paths = recordings_in(*folders, {});
    for (std::string& path : paths) path = std::filesystem::absolute(path).string();
    overrides.push_back("scenario.path=" + joined(paths));
  }
  const std::string name = file.path().string() + " (the study in it)";
  Study study =
      parse_study(file.study_text(), name, file.path().parent_path(), known_filters(), overrides);
  if (sha256(resolved_text(study)) != file.study_sha256())
    std::cerr << "montecarta: another version of montecarta made " << file.path().string()
              << "; settings that it did not know have their defaults\n";
  for (const std::string& note : build_differences(file.provenance(), collect_provenance()))
    std::cerr << "montecarta: " << note << "\n";
  return study;
}

}  // namespace montecarta::experiments
