// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <streambuf>
#include <string>

namespace montecarta::experiments {

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
