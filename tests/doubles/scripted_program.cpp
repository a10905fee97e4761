// SPDX-License-Identifier: BSD-3-Clause
// A program for cells `external`: `scripted_program MODE [N [TEXT]]` answers every message with the
// same estimate. At message N (from 0, of the process) it misbehaves as MODE names.
#include <csignal>
#include <cstdlib>
#include <dirent.h>
#include <fstream>
#include <iostream>
#include <string>
#include <unistd.h>

namespace {

/// The number of a message: it begins {"id":17,"type":...
std::string id_of(const std::string& line) { return line.substr(6, line.find(',') - 6); }

bool is(const std::string& line, const std::string& type) {
  return line.find("\"type\":\"" + type + "\"") != std::string::npos;
}

std::string answer_to(const std::string& line, const std::string& x) {
  const std::string begin = "{\"id\":" + id_of(line);
  if (is(line, "start")) return begin + "}";
  if (is(line, "map")) return begin + ",\"map\":[[0,1.5,2.5,0.25,0,0.25]]}";
  return begin + ",\"mean\":[" + x + ",0,0],\"covariance\":[[1,0,0],[0,1,0],[0,0,1]],\"nis\":2.5}";
}

/// Besides 0, 1, 2 and that of the folder itself.
int open_descriptors() {
  DIR* folder = ::opendir("/proc/self/fd");
  int others = -2 - 4;  // also . and ..
  while (::readdir(folder) != nullptr) ++others;
  ::closedir(folder);
  return others;
}

void do_at_message(const std::string& mode, const std::string& text) {
  if (mode == "exit") {
    std::cerr << "first words\nlast words\n";
    std::exit(7);
  }
  if (mode == "kill") std::raise(SIGKILL);
  if (mode == "hang") ::pause();
  if (mode == "close") {
    ::close(STDOUT_FILENO);
    ::pause();
  }
  if (mode == "deaf") ::close(STDIN_FILENO);
  if (mode == "flood") {
    while (std::cout << std::string(1 << 16, ' ')) continue;
  }
  if (mode == "say") std::cout << text << std::endl;
  if (mode == "begin") std::cout << text << std::flush;
  if (mode == "scream") std::cerr << std::string(1 << 20, '!');
}

}  // namespace

int main(int argc, char** argv) {
  std::ios::sync_with_stdio(false);
  const std::string mode = argc > 1 ? argv[1] : "";
  const int at = argc > 2 ? std::atoi(argv[2]) : -1;
  const std::string text = argc > 3 ? argv[3] : "";
  if (mode == "orphan") {  // a child of its own that would outlive it
    const pid_t child = ::fork();
    while (child == 0) ::pause();
    std::ofstream(text) << child << std::endl;
  }
  std::string line;
  int starts = 0;
  for (int message = 0; std::getline(std::cin, line); ++message) {
    if (is(line, "start")) ++starts;
    if (mode == "runs" && starts > at) return 5;
    if (message == at) do_at_message(mode, text);
    if (message == at && (mode == "say" || mode == "begin")) continue;
    std::string x = "1.25";
    if (mode == "count") x = std::to_string(starts);
    if (mode == "pid") x = std::to_string(::getpid());
    if (mode == "descriptors") x = std::to_string(open_descriptors());
    std::cout << answer_to(line, x) << std::endl;
    if (message == at && mode == "deaf") ::pause();
    if (message == at && mode == "twice") std::cout << answer_to(line, "-1") << std::endl;
  }
}
