// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/provenance.hpp"

#include "engine/formatted.hpp"
#include "engine/records/h5.hpp"

#include "git_hash.hpp"
#include <chrono>
#include <ctime>
#include <fstream>
#if defined(__GLIBC__)
#include <gnu/libc-version.h>
#endif
#include <sys/utsname.h>

namespace montecarta::engine {
namespace {

/// The C library that provides exp(), sin() and the like.
std::string libm() {
#if defined(__GLIBC__)
  return std::string("glibc ") + gnu_get_libc_version();
#else
  return "unknown";
#endif
}

std::string date() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::string text(20, '\0');
  std::strftime(text.data(), text.size() + 1, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string cpu() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

}  // namespace

std::string program_version() { return MONTECARTA_VERSION; }

std::string instruction_set() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#elif defined(__SSE2__)
  return "SSE2";
#elif defined(__ARM_NEON)
  return "NEON";
#else
  return "none";
#endif
}

TextPairs collect_provenance() {
  utsname system{};
  const bool known = ::uname(&system) == 0;
  return {
      {"version", program_version()},
      {"git", MONTECARTA_GIT_HASH},
      {"compiler", MONTECARTA_COMPILER},
      {"flags", MONTECARTA_FLAGS},
      {"libm", libm()},
      {"instruction_set", instruction_set()},
      {"hdf5", h5::library_version()},
      {"date", date()},
      {"host", known ? system.nodename : "unknown"},
      {"system", known ? formatted("{} {}", system.sysname, system.release) : "unknown"},
      {"cpu", cpu()},
  };
}

}  // namespace montecarta::engine
