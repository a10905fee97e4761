// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/tables/analysis_file.hpp"

#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/records/h5.hpp"
#include "engine/text/list_text.hpp"

namespace montecarta::analysis {
namespace {

void write_row(const h5::Handle& group, const Frame::Row& row) {
  for (const Frame::Entry& entry : row) {
    const auto dataset = h5::create_dataset(group, entry.name, Element::f64, {1});
    h5::write(dataset, Element::f64, &entry.number);
    h5::put_text(dataset, "units", entry.units);
  }
}

/// Writes columns, and attaches the scale of their rows if there is one.
void write_columns(const h5::Handle& group, const std::vector<Frame::Column>& columns,
                   const h5::Handle* scale) {
  for (const Frame::Column& column : columns) {
    const auto dataset =
        h5::create_dataset(group, column.name, Element::f64, {column.numbers.size()});
    h5::write(dataset, Element::f64, column.numbers.data());
    h5::put_text(dataset, "units", column.units);
    if (scale != nullptr) h5::attach_scale(dataset, *scale, 0);
  }
}

/// Dimension scales for the series of a cell.
struct Times {
  h5::Handle scans;
  std::vector<h5::Handle> fixes;  ///< {reference} scale of its fixes
};

h5::Handle write_times(const h5::Handle& group, const std::string& name,
                       const std::vector<double>& times) {
  auto scale = h5::create_dataset(group, name, Element::f64, {times.size()});
  h5::write(scale, Element::f64, times.data());
  h5::put_text(scale, "units", "s");
  h5::make_scale(scale, name);
  return scale;
}

void write_references(const h5::Handle& cell_group, const StudyAnalysis& study,
                      const CellAnalysis& cell, const Times& times) {
  const auto& all = cell.get<ReferenceAnalyses>();
  if (all.empty()) return;
  const auto references = h5::create_group(cell_group, "references");
  for (std::size_t r = 0; r < all.size(); ++r) {
    const auto group = h5::create_group(references, study.references[r].name);
    write_row(group, reference_numbers(cell, r));
    if (all[r].error_over_time.empty() || study.references[r].times.empty()) continue;
    write_columns(group, {{"error_over_time", "m", all[r].error_over_time}}, &times.fixes[r]);
  }
}

void write_bound(const h5::Handle& file, const CramerRaoBound& bound, const h5::Handle& time) {
  if (bound.empty()) return;
  const auto group = h5::create_group(file, "bound");
  write_columns(group, {{"position", "m", bound.position}, {"heading", "rad", bound.heading}},
                &time);
  write_row(group, {{"map", "m", bound.map},
                    {"runs", "1", static_cast<double>(bound.runs)},
                    {"is_bound", "1", bound.is_bound ? 1.0 : 0.0}});
}

/// Writes every test of the verdict: a group for each family, with columns over its members.
void write_families(const h5::Handle& cell_group, const Verdict& verdict) {
  const auto families = h5::create_group(cell_group, "families");
  for (const FamilyTest& test : verdict.families) {
    const auto group = h5::create_group(families, key_of(test.family));
    std::string names;
    for (const Member& member : test.members) {
      if (!member.name.empty()) append_part(names, member.name, "\n");
    }
    if (!names.empty()) h5::put_text(group, "members", names);
    write_columns(group, family_frame(test).columns, nullptr);
  }
}

void write_cell(const h5::Handle& cells, const StudyAnalysis& study, const CellAnalysis& cell,
                const Times& times) {
  const auto group = h5::create_group(cells, cell.label);
  h5::put_text(group, "filter", cell.filter);
  h5::put_text(group, "long_name", cell.long_name);
  h5::put_text(group, "verdict", in_words(cell.verdict));
  write_row(h5::create_group(group, "numbers"), numbers_of(cell));
  write_families(group, cell.verdict);
  const auto consistency = h5::create_group(group, "consistency");
  for (const NeesResult& nees : cell.nees) {
    write_row(h5::create_group(consistency, name_of(nees.block) + "_" + name_of(nees.moments)),
              numbers_of(cell, nees, study.level));
  }
  write_columns(h5::create_group(group, "series"), series_of(cell), &times.scans);
  write_references(group, study, cell, times);
}

}  // namespace

// HDF5 1.10 crashes at exit when a disk is full, so it makes the file in memory and never writes to
// a disk.
void write_analysis_file(const StudyAnalysis& study, const std::filesystem::path& path) {
  const auto file = h5::create_image(path.string());
  h5::put_text(file, "filetype", "montecarta-analysis");
  h5::put_text(file, "title", study.title);
  h5::put_text(file, "study", study.study_name);
  h5::put_text(file, "study_sha256", study.study_sha256);
  h5::put_text(file, "results", study.file);
  {
    Times times{write_times(file, "time", study.times), {}};
    for (const JudgedReference& reference : study.references) {
      if (reference.times.empty()) {
        times.fixes.emplace_back(-1);  // a reference without times has no scale
        continue;
      }
      times.fixes.push_back(write_times(file, "fix_" + reference.name, reference.times));
    }
    write_bound(file, study.bound, times.scans);
    const auto cells = h5::create_group(file, "cells");
    for (const CellAnalysis& cell : study.cells) write_cell(cells, study, cell, times);
  }
  write_text(path, h5::image_of(file));
}

}  // namespace montecarta::analysis
