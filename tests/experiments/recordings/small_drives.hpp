// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/recordings/drive_log.hpp"
#include "experiments/text/words.hpp"

#include <matio.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

// Small drives of our own making, in the formats of the published ones.
namespace montecarta::experiments {

using Ranges = std::array<double, 361>;

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Adds a matrix, column by column, to a MATLAB file, which is made where it is missing.
template <class Number>
void add_matrix(const std::filesystem::path& path, const char* name, std::vector<Number> values,
                std::size_t rows, matio_classes kind, matio_types type,
                matio_compression compression = MAT_COMPRESSION_NONE) {
  mat_t* file = std::filesystem::exists(path) ? Mat_Open(path.c_str(), MAT_ACC_RDWR)
                                              : Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
  std::size_t sides[2] = {rows, values.size() / rows};
  matvar_t* variable = Mat_VarCreate(name, kind, type, 2, sides, values.data(), 0);
  Mat_VarWrite(file, variable, compression);
  Mat_VarFree(variable);
  Mat_Close(file);
}

inline void add_doubles(const std::filesystem::path& path, const char* name,
                        const std::vector<double>& values, std::size_t rows) {
  add_matrix(path, name, values, rows, MAT_C_DOUBLE, MAT_T_DOUBLE);
}

inline void add_times(const std::filesystem::path& path, const char* name,
                      const std::vector<std::int32_t>& values) {
  add_matrix(path, name, values, values.size(), MAT_C_INT32, MAT_T_INT32);
}

/// A sweep in which nothing comes back, but for a tree of three beams at 10 m around `beam`.
inline Ranges sweep_of_tree(std::size_t beam) {
  Ranges ranges;
  ranges.fill(81.91);
  for (std::size_t k = beam - 1; k <= beam + 1; ++k) ranges[k] = 10.0;
  return ranges;
}

inline std::string laser_record(double time, const Ranges& ranges) {
  std::string text = to_text(time);
  for (const double range : ranges) text.append("\t").append(to_text(range));
  return text + "\t";
}

/// Three odometry records, two scans of one tree each and three fixes.
inline void write_small_park(const std::filesystem::path& folder) {
  write_text(folder / "DRS.txt", "0.975\t1.5\t-0.01\r\n1\t1.5\t0\r\n1.025\t1.6\t0.02\r\n");
  write_text(folder / "LASER.txt",
             laser_record(0.98, sweep_of_tree(180)) + laser_record(1.02, sweep_of_tree(200)));
  write_text(folder / "GPS.txt", "0\t0\t0\n1\t-2\t3\n2\t-4\t6.5\n");
  write_text(folder / "Sensors_manager.txt",
             "0 1 1\n0.975 2 1\n0.98 3 1\n1 1 2\n1 2 2\n1.02 3 2\n1.025 2 3\n2 1 3\n");
}

/// The same drive as the .mat release has it, with another steering and one fix more.
inline void add_small_park_mat(const std::filesystem::path& folder) {
  const auto wheel = folder / "aa3_dr.mat";
  add_times(wheel, "time", {21942, 21967, 21992});
  add_doubles(wheel, "speed", {1.5, 1.5, 1.6}, 3);
  add_doubles(wheel, "steering", {-0.0125, -0.003, 0.018}, 3);
  const auto gps = folder / "aa3_gpsx.mat";
  add_times(gps, "timeGps", {20967, 21967, 22467, 22967});
  add_doubles(gps, "La_m", {-41, -43, -44, -45}, 4);
  add_doubles(gps, "Lo_m", {-67, -64, -62, -60.5}, 4);
}

/// The same two sweeps in centimetres, with intensities in the upper three bits.
inline void add_small_laser_mat(const std::filesystem::path& folder) {
  const auto laser = folder / "aa3_lsr2.mat";
  add_times(laser, "TLsr", {21947, 21987});
  std::vector<std::uint16_t> echoes;  // column by column
  const std::array<Ranges, 2> sweeps = {sweep_of_tree(180), sweep_of_tree(200)};
  for (std::size_t beam = 0; beam < 361; ++beam) {
    for (const Ranges& sweep : sweeps) {
      const auto centimetres = static_cast<unsigned>(sweep[beam] * 100 + 0.5);
      echoes.push_back(static_cast<std::uint16_t>(centimetres | (beam % 8) << 13U));
    }
  }
  add_matrix(laser, "LASER", echoes, 2, MAT_C_UINT16, MAT_T_UINT16);
}

/// Three odometry records, two scans (one pole, nothing), two fixes, two surveyed poles.
inline void write_small_car_park(const std::filesystem::path& folder) {
  const auto path = folder / "data_set.mat";
  const Ranges tree = sweep_of_tree(200);
  std::vector<double> ranges, levels;
  for (std::size_t beam = 0; beam < 361; ++beam) {
    ranges.insert(ranges.end(), {tree[beam], 5.0});
    levels.insert(levels.end(), {tree[beam] < 80 ? 8192.0 : 0.0, 0.0});
  }
  add_doubles(path, "Time_VS", {45.0, 45.025, 45.05}, 1);
  add_doubles(path, "Velocity", {2.0, 2.1, 2.2}, 1);
  add_doubles(path, "Steering", {0.1, 0.2, 0.3}, 1);
  add_doubles(path, "TimeLaser", {45.02, 45.04}, 1);
  add_doubles(path, "Laser", ranges, 2);
  add_doubles(path, "Intensity", levels, 2);
  add_doubles(path, "TimeGPS", {45.01, 45.22}, 1);
  add_doubles(path, "GPSLon", {5.0, 5.5}, 1);
  add_doubles(path, "GPSLat", {4.0, 3.5}, 1);
  add_doubles(path, "Time", {45.0, 45.01, 45.02, 45.025, 45.04, 45.05, 45.22}, 1);
  add_doubles(path, "Sensor", {2, 1, 3, 2, 3, 2, 1}, 1);
  add_doubles(path, "Index", {1, 1, 1, 2, 2, 3, 2}, 1);
  add_doubles(folder / "beac_juan3.mat", "estbeac", {1, 2, 10, 20}, 2);
}

/// A log that uses everything a log can hold, with numbers that do not end in decimals.
inline DriveLog full_log() {
  DriveLog log;
  log.start_time = 1.0 / 11;
  log.start = {.x = 1.0 / 3, .y = -0.0, .heading = -2.0 / 3};
  log.odometry = {{0.1, {1.0 / 7, -1e-17}}, {0.30000000000000004, {-0.5, 1.0 / 9}}};
  log.scans = {{0.1, {}},
               {0.2, {{10.0 / 3, -1.0 / 3, 1}, {20.1, 0.7, Detection::kClutter}}},
               {0.3, {{5e-324, 0.0, 0}}}};
  log.references = {{"reference", {0.0, 1.0}, {{0, 0}, {1.0 / 3, 2}}, {0.1, 1.0 / 7}},
                    {"gps", {0.5}, {{1e5, -1e-5}}, {}}};
  log.references[0].covariance = {Eigen::Vector3d(1.0 / 3, 0.1, 1.0 / 7).asDiagonal(),
                                  Eigen::Matrix3d{{2, 0.1, -0.2}, {0.1, 1, 0}, {-0.2, 0, 1.0 / 9}}};
  log.landmarks = {{1.0 / 3, 2}, {-3, 4.0 / 7}};
  return log;
}

}  // namespace montecarta::experiments
