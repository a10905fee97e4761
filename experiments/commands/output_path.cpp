// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/output_path.hpp"

#include "engine/errors.hpp"
#include "engine/records/h5.hpp"

#include <fstream>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Returns the reason why no result may replace `path`, e.g. "is a folder"; empty if it may be
/// written.
std::string obstacle_at(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_symlink(path, ignored) && !fs::exists(status)) return "is a link to nothing";
  if (!fs::exists(status)) return "";
  if (fs::is_directory(status)) return "is a folder";
  if (!fs::is_regular_file(status)) return "is a device, a pipe or a socket";
  if (fs::is_empty(path, ignored)) return "";
  if (!std::ifstream(path)) return "";  // opening it for writing will report the reason
  return h5::is_hdf5(path) ? "" : "is no HDF5 file";
}

}  // namespace

void refuse_input_as_output(const fs::path& output, const std::vector<std::string>& inputs) {
  std::error_code ignored;
  for (const std::string& input : inputs) {
    for (const std::string& name : {input, input + ".part"}) {
      if (!fs::equivalent(output, name, ignored)) continue;
      throw StudyError(
          "{}: is the same file as {} (the input would be overwritten, even with --force): choose "
          "another name",
          output, name);
    }
  }
}

void require_place_for_result(const fs::path& output) {
  if (output.empty()) {
    throw StudyError("the name of the result is empty (it needs one): name a file, e.g. out.h5");
  }
  for (const fs::path& path : {output, fs::path(output.string() + ".part")}) {
    const std::string obstacle = obstacle_at(path);
    if (obstacle.empty()) continue;
    throw StudyError("{}: {} (nothing but a result is ever replaced): choose another name", path,
                     obstacle);
  }
}

void refuse_existing(const fs::path& folder, const std::vector<std::string>& names) {
  std::error_code ignored;
  for (const std::string& name : names) {
    if (!fs::exists(folder / name, ignored)) continue;
    throw StudyError((folder / name).string() +
                     ": is there already (nothing is overwritten unasked): choose another name, or "
                     "add --force");
  }
}

}  // namespace montecarta::experiments
