// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace montecarta::experiments {

/// The state of a file by the claims of workers on it. The K-th claim on FILE is the file
/// FILE.claim.K. While its worker lives, it changes the text of the claim again and again.
struct ClaimState {
  std::uint64_t claims = 0;  ///< number of the last claim; 0: nobody has claimed the file
  /// Number of claims before the last one whose worker was lost or failed.
  std::uint64_t losses = 0;
  std::string text;  ///< text of the last claim

  /// Whether the worker of the last claim stopped at a checkpoint, or nobody has claimed the file.
  bool is_free() const;
  bool has_failed() const;
};

/// Number of workers that may be lost or fail over one file. Then no other begins it, because it
/// would end all workers one by one.
inline constexpr std::uint64_t kMostLosses = 5;

ClaimState claims_on(const std::filesystem::path& file);
/// Removes all claims on a file.
void remove_claims(const std::filesystem::path& file);

/// The claim of this process on a file that it makes. A claim keeps nobody from the file: two
/// workers on one file do no harm, they only compute the same twice. So a claim need not be
/// certain, and no clocks of two machines are compared.
class WorkClaim {
 public:
  /// Makes claim `number`; nullptr if another worker was faster. The text is changed six times in
  /// `patience` seconds, after which another worker may take this one for dead.
  static std::unique_ptr<WorkClaim> make(const std::filesystem::path& file, std::uint64_t number,
                                         double patience);
  ~WorkClaim();
  WorkClaim(const WorkClaim&) = delete;
  WorkClaim& operator=(const WorkClaim&) = delete;

  const std::filesystem::path& file() const { return file_; }
  /// Leaves the file to any other worker, after a checkpoint.
  void leave();
  /// Removes the claim, as if it had not been made.
  void withdraw();
  /// Says why the work failed, unless the file was left.
  void fail(const std::string& reason);

 private:
  WorkClaim(std::filesystem::path file, std::filesystem::path claim, double patience);
  void keep_alive(double period);
  void stop();

  std::filesystem::path file_, claim_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false, left_ = false;
  std::thread thread_;
};

/// Claims one of the files that no living worker makes as far as their claims say; nullptr if there
/// is none.
std::unique_ptr<WorkClaim> claim_free(const std::vector<std::filesystem::path>& files,
                                      double patience);

/// The result of watching other workers.
struct ClaimSearch {
  std::unique_ptr<WorkClaim> claim;  ///< claim on a file whose worker is lost; nullptr: on none
  std::vector<std::filesystem::path> given_up;  ///< files that nobody makes and nobody may begin
};

/// Watches the claims of other workers for at most `patience` seconds, and claims the file of one
/// that shows no sign of life.
ClaimSearch watch_others(const std::vector<std::filesystem::path>& files, double patience);

}  // namespace montecarta::experiments
