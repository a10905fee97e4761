// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <sys/types.h>

namespace montecarta::engine {

/// A copy of this process that reads one file and answers questions about it. HDF5 libraries crash
/// on some damaged files, or never end; then only the copy is ended. For use by one thread.
class ForkedReader {
 public:
  using Answer = std::function<std::string(std::string_view question)>;

  /// Forks. The copy calls `answer` for each question. `path` is for errors. Throws RunError if the
  /// system has no room for a process.
  ForkedReader(std::filesystem::path path, const Answer& answer);
  ~ForkedReader();
  ForkedReader(const ForkedReader&) = delete;
  ForkedReader& operator=(const ForkedReader&) = delete;

  /// Returns the answer. Throws the StudyError or RunError that the copy has thrown, and StudyError
  /// if the copy crashes, or takes far more processor time than a file of that size can need.
  std::string ask(std::string_view question) const;

 private:
  std::filesystem::path path_;
  int line_ = -1;  ///< socket to the copy
  pid_t copy_ = -1;
};

}  // namespace montecarta::engine
