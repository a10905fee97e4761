// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Throws StudyError where writing `output` would destroy one of `inputs`, or the unfinished work
/// (.part) beside it, under whatever name, symbolic or hard link. --force does not help.
void refuse_input_as_output(const std::filesystem::path& output,
                            const std::vector<std::string>& inputs);

/// Throws StudyError if no result may be written to `output`: the name is empty, it is a link to
/// nothing, or it or the unfinished work beside it is there and is anything but a regular HDF5
/// file.
/// --force replaces results, never a study, a device, a pipe or a letter.
void expect_place_for_result(const std::filesystem::path& output);

/// Throws StudyError naming the first of `names` that is in `folder` already.
void refuse_existing(const std::filesystem::path& folder, const std::vector<std::string>& names);

/// While one lives, what is written to a stream reaches it with control characters written out, but
/// for line breaks and tabs: text of a file or of another program cannot command the terminal.
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
  std::string waiting_;  ///< not yet passed on: at most the beginning of a character
};

}  // namespace montecarta::experiments
