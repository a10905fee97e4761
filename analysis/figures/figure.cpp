// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/figures/figure.hpp"

#include "analysis/figures/gnuplot.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"

#include <array>

namespace montecarta {
namespace {

/// Common to all figures. What is black here takes the colour of the text where the page is dark.
constexpr const char* kStyle = R"(set encoding utf8
set datafile separator comma
set datafile missing 'nan'
set datafile columnheaders
set border 3 linewidth 0.8 linecolor rgb 'black'
set tics nomirror out scale 0.6
set grid linecolor rgb '#bbbbbb' linewidth 0.4 dashtype (2,4)
set key noenhanced samplen 1.6 spacing 1.15 width 1
set style fill transparent solid 0.25 noborder
)";

constexpr std::array kColours = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"};

void write_data(const FigureData& data, const std::filesystem::path& directory) {
  CsvFile file(directory / data.name);
  file.row(data.headings);
  for (const auto& row : data.rows) file.row(row);
  file.close();
}

/// The whole script: the same figure for the page and for print.
std::string script_of(const Figure& figure) {
  const std::string size = std::to_string(figure.width) + "," + std::to_string(figure.height);
  const auto centimetres = [](std::size_t pixels) {
    return readable(static_cast<double>(pixels) * 0.02, 3) + "cm";
  };
  return std::string("# Drawn again by: gnuplot ") + figure.name + ".gp\n" +
         "set terminal svg size " + size +
         " dynamic background rgb '#ffffff' font 'sans-serif,13' linewidth 1.3\n" + "set output '" +
         figure.name + ".svg'\n" + kStyle + figure.script +
         "unset output\nreset\nset terminal pdfcairo size " + centimetres(figure.width) + "," +
         centimetres(figure.height) + " font 'sans,8' linewidth 1.3\nset output '" + figure.name +
         ".pdf'\n" + kStyle + figure.script + "unset output\n";
}

}  // namespace

void draw(const Figure& figure, const std::filesystem::path& directory) {
  make_directory(directory / "data");
  make_directory(directory / "figures");
  for (const FigureData& data : figure.data) write_data(data, directory / "data");
  const std::string script = figure.name + ".gp";
  write_text(directory / "figures" / script, script_of(figure));
  run_gnuplot(directory / "figures", script);
}

std::string line_colour(std::size_t i) {
  if (i == kTruthStyle) return "#999999";
  return i == kYardstickStyle ? "black" : kColours[i % kColours.size()];
}

std::size_t line_dashes(std::size_t i) {
  if (i == kTruthStyle) return 1;
  return i == kYardstickStyle ? 2 : 1 + i / kColours.size();
}

std::string line_style(std::size_t i) {
  if (i == kYardstickStyle) return "linewidth 1.6 linecolor rgb 'black' dashtype (6,4)";
  return "linewidth 1.4 linecolor rgb '" + line_colour(i) + "' dashtype " +
         std::to_string(line_dashes(i));
}

FigureData data_of(const std::string& name, const std::string& heading,
                   const ThinnedSeries& thinned) {
  FigureData data{name, {heading}, {}};
  for (const NamedSeries& one : thinned.series) {
    data.headings.push_back(one.units == "1" ? one.name : one.name + " [" + one.units + "]");
  }
  for (std::size_t k = 0; k < thinned.times.size(); ++k) {
    std::vector<double> row = {thinned.times[k]};
    for (const NamedSeries& one : thinned.series) row.push_back(one.values[k]);
    data.rows.push_back(std::move(row));
  }
  return data;
}

}  // namespace montecarta
