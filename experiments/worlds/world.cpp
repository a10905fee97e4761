// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/worlds/world.hpp"

#include "engine/errors.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/files/files.hpp"
#include "experiments/files/mat_file.hpp"
#include "experiments/text/words.hpp"

#include <array>
#include <cmath>
#include <string>

namespace montecarta::experiments {
namespace {

void check_points(const std::vector<Eigen::Vector2d>& points, const std::string& place,
                  const std::string& noun) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite() && points[i].cwiseAbs().maxCoeff() <= kFarthestCoordinate) continue;
    throw StudyError(place + ": " + noun + " " + std::to_string(i + 1) +
                     " is no place (a coordinate is not finite or beyond 1e6 m): correct it");
  }
}

namespace fs = std::filesystem;

bool is_path(const std::string& name) {
  return name.find('/') != std::string::npos || name.ends_with(".csv") || name.ends_with(".mat");
}

/// Where a path that a study gives leads, or the path itself where there is nothing.
fs::path resolved_path(const std::string& name, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    if (fs::exists(folder / name)) return folder / name;
  }
  return name;
}

const std::array<std::string, 2> kKinds = {"landmark", "waypoint"};

void read_row(const CsvRows& rows, World& world) {
  const std::string kind(rows.field(0));
  if (kind != kKinds[0] && kind != kKinds[1]) {
    throw StudyError(rows.place() + ": unknown kind '" + excerpt(kind) +
                     "' (a row is a landmark or a waypoint): " + nearest_spelling(kind, kKinds));
  }
  auto& points = kind == kKinds[0] ? world.landmarks : world.waypoints;
  if (kind == kKinds[1]) world.waypoint_places.push_back(rows.place());
  points.emplace_back(rows.number(1, "coordinate"), rows.number(2, "coordinate"));
}

/// Rows (2 x N) are preferred where both sides are 2, as the published maps are stored.
std::vector<Eigen::Vector2d> points_of(const MatFile& file, const std::string& name) {
  const Eigen::MatrixXd& matrix = file.matrix(name);
  if (matrix.rows() != 2 && matrix.cols() != 2) {
    throw StudyError(file.place() + ": '" + name +
                     "' has the wrong shape (2 x N or N x 2 is needed): save x and y [m]");
  }
  std::vector<Eigen::Vector2d> points;
  if (matrix.rows() == 2) {
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) points.emplace_back(matrix.col(i));
  } else {
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) points.emplace_back(matrix.row(i).transpose());
  }
  return points;
}

}  // namespace

void check_world(const World& world, const std::string& place) {
  if (world.waypoints.size() < 2) {
    throw StudyError(place + ": " + std::to_string(world.waypoints.size()) +
                     " way-points (a drive needs at least two): add way-points");
  }
  if (world.landmarks.empty()) {
    throw StudyError(place + ": no landmarks (there is nothing to map): add at least one");
  }
  check_points(world.waypoints, place, "way-point");
  check_points(world.landmarks, place, "landmark");
}

World read_world_file(const fs::path& path) {
  if (!fs::exists(path)) {
    throw StudyError(path.string() +
                     ": no such world file (looked from here and from the study's folder): " +
                     "correct the path, or name a shipped world: " + joined(shipped_worlds()));
  }
  if (path.extension() == ".csv") return read_world_csv(path);
  if (path.extension() == ".mat") return read_world_mat(path);
  throw StudyError(
      path.string() +
      ": unknown kind of world file (known: .csv and .mat): convert it to one of them");
}

World find_world(const std::string& name, const std::vector<fs::path>& folders) {
  if (is_path(name)) return read_world_file(resolved_path(name, folders));
  if (const auto shipped = shipped_file("worlds", name + ".csv")) return read_world_csv(*shipped);
  throw StudyError("unknown world '" + name + "' (neither shipped nor a path to .csv or .mat): " +
                   nearest_spelling(name, shipped_worlds()));
}

std::vector<std::string> shipped_worlds() { return shipped_names("worlds", ".csv"); }

World read_world_csv(const std::filesystem::path& path) {
  World world{.name = path.stem().string(), .waypoints = {}, .landmarks = {}};
  CsvRows rows(path, std::array<std::string, 1>{"kind,x,y"});
  while (rows.next()) read_row(rows, world);
  check_world(world, path.string());
  return world;
}

World read_world_mat(const std::filesystem::path& path) {
  const MatFile file(path);
  World world{.name = path.stem().string(),
              .waypoints = points_of(file, "wp"),
              .landmarks = points_of(file, "lm")};
  check_world(world, path.string());
  return world;
}

}  // namespace montecarta::experiments
