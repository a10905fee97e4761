// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ostream>
#include <streambuf>
#include <string>

namespace montecarta::experiments {

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
