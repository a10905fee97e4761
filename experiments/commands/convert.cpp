// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/csv_file.hpp"
#include "engine/errors.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/study/study.hpp"

#include <iostream>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

int convert(const Arguments& arguments) {
  const std::string& name = arguments.operands().front();
  const auto directory = arguments.text("output");
  if (!directory) throw StudyError("convert: no folder (-o DIR is where the log goes): add -o DIR");
  const fs::path folder = *directory;
  const Study study = read_study(name, arguments.texts("set"));
  if (study.log == nullptr) {
    throw StudyError(name +
                     ": the drives of this study are simulated (there is nothing to "
                     "convert): give a study of a recorded drive");
  }
  if (!study.own_logs.empty()) {
    throw StudyError(name +
                     ": has several drives (they are plain CSV logs already, and one folder holds "
                     "one): copy their folders");
  }
  write_log_csv(*study.log, folder);
  write_text(folder / "study.ini", study_of_log(study));
  std::cerr << "montecarta: " << study.log->odometry.size() << " odometry records and "
            << study.log->scans.size() << " scans, stored in " << folder.string()
            << "; the same study of them is " << (folder / "study.ini").string() << "\n";
  return kDone;
}

}  // namespace

Command convert_command() {
  return {{.name = "convert",
           .summary = "writes the recorded drive of a study as plain CSV, with a study of it",
           .operands = {{"STUDY.ini"}},
           .options = {{"output", "o", {"DIR"}, "where to; new or empty"},
                       {"set",
                        "",
                        {"SECTION.KEY=VALUE"},
                        "override a setting of the study; repeatable",
                        true}},
           .details =
               "The files are described in experiments/RECORDED_DRIVES.md; the results of the new "
               "study are the same numbers.\n"},
          convert};
}

}  // namespace montecarta::experiments
