// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/work_claim.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/runs/progress.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <unistd.h>
#include <utility>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLeftText = "left";
constexpr const char* kFailedText = "failed";
constexpr double kSignsOfLife = 6.0;  ///< in the time after which a worker counts as dead

fs::path claim_file(fs::path file, std::uint64_t number) {
  return file += ".claim." + std::to_string(number);
}

/// The text of a file that another process may be writing; empty if it is gone.
std::string text_in(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Replaces the text of a file that is there. A failure only makes this worker look dead.
void replace_text(const fs::path& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "r+e");
  if (file == nullptr) return;
  std::fwrite(text.data(), 1, text.size(), file);
  std::fflush(file);
  if (::ftruncate(::fileno(file), static_cast<off_t>(text.size())) != 0) errno = 0;
  std::fclose(file);
}

/// Creates a file, unless it is there. Returns whether this process was the one.
bool create(const fs::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "wxe");
  if (file == nullptr && errno == EEXIST) return false;
  if (file == nullptr)
    throw StudyError("{}: cannot be made ({}): choose a folder where you may write", path,
                     std::strerror(errno));
  std::fclose(file);
  return true;
}

}  // namespace

bool ClaimState::is_free() const { return claims == 0 || text.starts_with(kLeftText); }
bool ClaimState::has_failed() const { return text.starts_with(kFailedText); }

ClaimState claims_on(const fs::path& file) {
  ClaimState state;
  while (is_there(claim_file(file, state.claims + 1))) {
    if (!state.is_free()) ++state.losses;
    state.text = text_in(claim_file(file, ++state.claims));
  }
  return state;
}

void remove_claims(const fs::path& file) {
  std::error_code ignored;
  for (std::uint64_t last = claims_on(file).claims; last > 0; --last)
    fs::remove(claim_file(file, last), ignored);
}

std::unique_ptr<WorkClaim> WorkClaim::make(const fs::path& file, std::uint64_t number,
                                           double patience) {
  fs::path claim = claim_file(file, number);
  if (!create(claim)) return nullptr;
  return std::unique_ptr<WorkClaim>(new WorkClaim(file, std::move(claim), patience));
}

WorkClaim::WorkClaim(fs::path file, fs::path claim, double patience)
    : file_(std::move(file)),
      claim_(std::move(claim)),
      thread_([this, patience] { keep_alive(patience / kSignsOfLife); }) {}

WorkClaim::~WorkClaim() { stop(); }

void WorkClaim::keep_alive(double period) {
  const std::string me = name_of_process();
  std::unique_lock lock(mutex_);
  for (std::uint64_t sign = 1; !over_; ++sign) {
    replace_text(claim_, formatted("at work: {} {}\n", me, sign));
    wake_.wait_for(lock, std::chrono::duration<double>(period));
  }
}

void WorkClaim::stop() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void WorkClaim::leave() {
  stop();
  left_ = true;
  replace_text(claim_, formatted("{} by {}\n", kLeftText, name_of_process()));
}

void WorkClaim::withdraw() {
  stop();
  left_ = true;
  std::error_code ignored;
  fs::remove(claim_, ignored);
}

void WorkClaim::fail(const std::string& reason) {
  if (left_) return;
  stop();
  replace_text(claim_, formatted("{} on {}: {}\n", kFailedText, name_of_process(), reason));
}

namespace {

/// A file that another worker makes, as this one has seen it.
struct Watched {
  fs::path file;
  ClaimState first;       ///< its claims when the watch began
  bool is_alive = false;  ///< whether the worker has shown a sign of life since
};

bool may_be_begun(const ClaimState& state) {
  return state.is_free() || (state.has_failed() && state.losses + 1 < kMostLosses);
}

/// Claims a file whose last claim is `state`; nullptr if another worker was faster.
std::unique_ptr<WorkClaim> claim_after(const ClaimState& state, const fs::path& file,
                                       double patience) {
  return WorkClaim::make(file, state.claims + 1, patience);
}

/// Looks at all files once. Claims one that is free now or, at the end of the watch, one whose
/// worker showed no sign of life.
std::unique_ptr<WorkClaim> look(std::vector<Watched>& files, bool is_end, double patience) {
  for (Watched& watched : files) {
    if (is_there(watched.file)) watched.is_alive = true;
    if (watched.is_alive) continue;
    const ClaimState now = claims_on(watched.file);
    watched.is_alive = now.claims != watched.first.claims || now.text != watched.first.text;
    const bool is_lost = is_end && !watched.is_alive && now.losses + 1 < kMostLosses;
    if (!is_lost && !may_be_begun(now)) continue;
    if (auto claim = claim_after(now, watched.file, patience)) return claim;
    watched.is_alive = true;
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<WorkClaim> claim_free(const std::vector<fs::path>& files, double patience) {
  // Workers that start at the same time begin at different files.
  const std::size_t first = std::hash<std::string>()(name_of_process()) % files.size();
  for (std::size_t i = 0; i < files.size(); ++i) {
    const fs::path& file = files[(first + i) % files.size()];
    const ClaimState state = claims_on(file);
    if (!may_be_begun(state)) continue;
    if (auto claim = claim_after(state, file, patience)) return claim;
  }
  return nullptr;
}

ClaimSearch watch_others(const std::vector<fs::path>& files, double patience) {
  std::vector<Watched> others;
  for (const fs::path& file : files) others.push_back({file, claims_on(file)});
  const Stopwatch stopwatch;
  const auto pause = std::chrono::duration<double>(std::clamp(patience / 50.0, 0.01, 1.0));
  for (bool is_end = false;; is_end = stopwatch.seconds() >= patience) {
    if (auto claim = look(others, is_end, patience)) return {std::move(claim), {}};
    if (is_end || std::ranges::all_of(others, &Watched::is_alive)) break;
    std::this_thread::sleep_for(pause);
  }
  ClaimSearch found;
  for (const Watched& watched : others) {
    if (!watched.is_alive) found.given_up.push_back(watched.file);
  }
  return found;
}

}  // namespace montecarta::experiments
