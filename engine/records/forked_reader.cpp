// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/forked_reader.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <exception>
#include <optional>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

namespace montecarta::engine {
namespace {

enum class Outcome : char { answer, study_error, run_error };

/// Returns false if the other process has ended.
bool send_all(int line, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(line, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

bool receive_all(int line, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t received = ::recv(line, to, size, 0);
    if (received < 0 && errno == EINTR) continue;
    if (received <= 0) return false;
    to += received;
    size -= static_cast<std::size_t>(received);
  }
  return true;
}

/// Sends a message behind its length.
bool send_message(int line, std::string_view message) {
  const std::uint64_t size = message.size();
  std::array<char, sizeof size> head{};
  std::memcpy(head.data(), &size, sizeof size);
  return send_all(line, {head.data(), head.size()}) && send_all(line, message);
}

std::optional<std::string> receive_message(int line) {
  std::uint64_t size = 0;
  std::array<char, sizeof size> head{};
  if (!receive_all(line, head.data(), head.size())) return std::nullopt;
  std::memcpy(&size, head.data(), sizeof size);
  std::string message(size, '\0');
  if (!receive_all(line, message.data(), message.size())) return std::nullopt;
  return message;
}

std::string outcome_of(const ForkedReader::Answer& answer, const std::string& question) {
  const auto marked = [](Outcome outcome, const std::string& text) {
    return std::string(1, static_cast<char>(outcome)) + text;
  };
  try {
    return marked(Outcome::answer, answer(question));
  } catch (const StudyError& error) {
    return marked(Outcome::study_error, error.what());
  } catch (const std::exception& error) {
    return marked(Outcome::run_error, error.what());
  }
}

/// Limits the processor time of the next answer to far more than the reading of all bytes takes.
void limit_time(const std::filesystem::path& path) {
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
  rusage used{};
  rlimit limit{};
  ::getrusage(RUSAGE_SELF, &used);
  ::getrlimit(RLIMIT_CPU, &limit);
  const auto seconds = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  limit.rlim_cur = std::min(limit.rlim_max, seconds + 3 + (ignored ? 0 : bytes >> 20U));
  ::setrlimit(RLIMIT_CPU, &limit);
}

/// The main loop of the copy. It leaves nothing behind, also if it crashes: no core file and no
/// output that this process had not written out yet.
[[noreturn]] void answer_until_end_of(int line, const std::filesystem::path& path,
                                      const ForkedReader::Answer& answer) {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTERM, SIGXCPU}) {
    ::signal(signal, SIG_DFL);
  }
  while (const auto question = receive_message(line)) {
    limit_time(path);
    if (!send_message(line, outcome_of(answer, *question))) break;
  }
  ::_exit(0);
}

}  // namespace

ForkedReader::ForkedReader(std::filesystem::path path, const Answer& answer)
    : path_(std::move(path)) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0) {
    copy_ = ::fork();
    if (copy_ == 0) {
      ::close(ends[0]);
      answer_until_end_of(ends[1], path_, answer);
    }
    line_ = ends[0];
    ::close(ends[1]);
  }
  if (copy_ > 0) return;
  const std::string reason = std::strerror(errno);
  if (line_ >= 0) ::close(line_);
  throw RunError(
      "{}: no process to read it ({}): allow more processes (ulimit -u) and open files (ulimit -n)",
      path_, reason);
}

ForkedReader::~ForkedReader() {
  ::close(line_);
  ::kill(copy_, SIGKILL);  // it may never end, in an endless loop of the library
  while (::waitpid(copy_, nullptr, 0) < 0 && errno == EINTR) continue;
}

std::string ForkedReader::ask(std::string_view question) const {
  std::optional<std::string> message;
  if (send_message(line_, question)) message = receive_message(line_);
  if (!message || message->empty()) {
    throw StudyError(
        path_.string() +
        ": damaged (the HDF5 library crashes on it, or never ends): take a copy that is "
        "whole, or write it again");
  }
  const auto outcome = static_cast<Outcome>(message->front());
  message->erase(0, 1);
  if (outcome == Outcome::study_error) throw StudyError(*message);
  if (outcome == Outcome::run_error) throw RunError(*message);
  return *std::move(message);
}

}  // namespace montecarta::engine
