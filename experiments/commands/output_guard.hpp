// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Throws StudyError if writing `output` would overwrite one of `inputs` or the unfinished work
/// (.part) beside it, also through a symbolic or hard link. --force does not change this.
void refuse_input_as_output(const std::filesystem::path& output,
                            const std::vector<std::string>& inputs);

/// Throws StudyError if no result may be written to `output`: its name is empty, it is a link to
/// nothing, or it or the unfinished work beside it exists and is not a regular HDF5 file. --force
/// replaces results only, so that it cannot destroy a study, a device or a text.
void require_place_for_result(const std::filesystem::path& output);

/// Throws StudyError with the first of `names` that exists in `folder`.
void refuse_existing(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// While the object exists, control characters that are written to the stream, other than line
/// breaks and tabs, are replaced by visible text, so that the contents of a file or the messages of
/// another program cannot control the terminal.
class VisibleOutput final : public std::streambuf {
 public:
  explicit VisibleOutput(std::ostream& stream);
  ~VisibleOutput() override;
  VisibleOutput(const VisibleOutput&) = delete;
  VisibleOutput& operator=(const VisibleOutput&) = delete;

 protected:
  int_type overflow(int_type c) override;
  std::streamsize xsputn(const char* text, std::streamsize length) override;
  int sync() override;

 private:
  bool pass_on();

  std::ostream& stream_;
  std::streambuf* target_;
  std::string waiting_;  ///< bytes not passed on yet: the beginning of a character at most
};

}  // namespace montecarta::experiments
