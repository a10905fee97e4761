// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/stored_study.hpp"

#include "engine/errors.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/provenance.hpp"
#include "engine/records/sha256.hpp"
#include "experiments/judging/imported_plan.hpp"
#include "experiments/recordings/find_recording.hpp"
#include "experiments/text/words.hpp"

#include <iostream>

namespace montecarta::experiments {

OptionSpec data_option() {
  return {"data", "", {"FOLDER[,...]"}, "where the recorded drives of the study lie, in its order"};
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
  Study study = parse_study(file.study_text(), name, file.path().parent_path(), overrides);
  if (sha256(resolved_text(study)) != file.study_sha256())
    std::cerr << "montecarta: another version of montecarta made " << file.path().string()
              << "; settings that it did not know have their defaults\n";
  for (const std::string& note : build_differences(file.provenance(), collect_provenance()))
    std::cerr << "montecarta: " << note << "\n";
  return study;
}

}  // namespace montecarta::experiments
