// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/orphan_guard.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

constexpr std::size_t kMostGroups = 4096;

/// All of the guarding process. It was forked from a process of many threads, so it calls nothing
/// that may wait for a lock, and it closes what it inherited: locks and pipes are not its own.
[[noreturn]] void guard_until_end_of(int line) {
  ::setsid();  // Ctrl-C in a terminal is not for it
  ::dup2(line, STDIN_FILENO);
  ::syscall(SYS_close_range, 1U, ~0U, 0U);
  const pid_t ready = 0;
  (void)::send(STDIN_FILENO, &ready, sizeof ready, MSG_NOSIGNAL);
  std::array<pid_t, kMostGroups> groups{};
  std::size_t n = 0;
  for (;;) {
    pid_t told = 0;
    const ssize_t bytes = ::recv(STDIN_FILENO, &told, sizeof told, 0);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes != sizeof told) break;
    pid_t* const end = groups.data() + n;
    pid_t* const known = std::find(groups.data(), end, -told);
    if (told < 0 && known != end) {
      *known = groups[--n];
    } else if (told > 0 && n < kMostGroups) {
      groups[n++] = told;
    }
  }
  for (std::size_t i = 0; i < n; ++i) ::kill(-groups[i], SIGKILL);
  ::_exit(0);
}

}  // namespace

OrphanGuard& OrphanGuard::instance() {
  static OrphanGuard guard;
  return guard;
}

/// By way of a process that ends at once, so that the guard is no child that we would wait for.
OrphanGuard::OrphanGuard() {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return;
  const pid_t between = ::fork();
  if (between == 0) {
    ::close(ends[1]);
    if (::fork() == 0) guard_until_end_of(ends[0]);
    ::_exit(0);
  }
  ::close(ends[0]);
  if (between < 0) {
    ::close(ends[1]);
    return;
  }
  while (::waitpid(between, nullptr, 0) < 0 && errno == EINTR) continue;
  // Until the guard has closed what it inherited it would keep pipes of other programs open.
  pid_t ready = 0;
  while (::recv(ends[1], &ready, sizeof ready, 0) < 0 && errno == EINTR) continue;
  line_ = ends[1];
}

void OrphanGuard::tell(pid_t signed_group) const {
  if (line_ < 0) return;
  // No signal where somebody killed the guard.
  while (::send(line_, &signed_group, sizeof signed_group, MSG_NOSIGNAL) < 0 && errno == EINTR) {
    continue;
  }
}

}  // namespace montecarta::experiments
