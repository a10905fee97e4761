// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/recordings/find_recording.hpp"

#include "engine/errors.hpp"
#include "engine/records/sha256.hpp"
#include "experiments/text/words.hpp"

#include <cstdlib>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// All numbers of a log, one behind the other, lengths before what has one.
class Bytes {
 public:
  template <class Number>
  void add(Number number) {
    text_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void add(const Pose& pose) { add(pose.x), add(pose.y), add(pose.heading); }
  void add(const Eigen::Vector2d& point) { add(point.x()), add(point.y()); }
  void add(const Odometry& o) { add(o.time), add(o.control.speed), add(o.control.steer); }
  void add(const Detection& d) { add(d.range), add(d.bearing), add(d.identity); }
  void add(const LoggedScan& scan) { add(scan.time), add(scan.detections); }
  void add(const ReferencePath& path) {
    add(std::uint64_t{path.name.size()});
    text_ += path.name;
    add(path.time), add(path.position), add(path.heading);
    if (!path.covariance.empty()) add(path.covariance);  // drives without keep their fingerprint
  }
  void add(const Eigen::Matrix3d& matrix) {
    for (const double element : matrix.reshaped()) add(element);
  }
  template <class Item>
  void add(const std::vector<Item>& items) {
    add(std::uint64_t{items.size()});
    for (const Item& item : items) add(item);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

fs::path find_recording(const std::string& path, const std::vector<fs::path>& folders) {
  std::vector<fs::path> places = folders;
  places.emplace_back();
  if (const char* data = std::getenv("MONTECARTA_DATA")) {
    for (const std::string& folder : split(data, ':')) places.emplace_back(folder);
  }
  for (const fs::path& place : places) {
    std::error_code ignored;  // what cannot be looked at is not there
    if (fs::is_directory(place / path, ignored)) return place / path;
  }
  throw StudyError("no folder '" + path +
                   "' (looked beside the study, here, and in $MONTECARTA_DATA; recorded drives are "
                   "not part of montecarta): correct scenario.path, or set MONTECARTA_DATA to the "
                   "folder that holds it");
}

std::string fingerprint_of(const DriveLog& log) {
  Bytes bytes;
  bytes.add(log.start_time);
  bytes.add(log.start);
  bytes.add(log.odometry);
  bytes.add(log.scans);
  bytes.add(log.references);
  bytes.add(log.landmarks);
  return sha256(bytes.text());
}

}  // namespace montecarta::experiments
