// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/block_errors.hpp"

#include "analysis/run/imported_errors.hpp"
#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"

#include <utility>

namespace montecarta::analysis {

BlockErrors::BlockErrors(std::span<const StateBlock> blocks, std::size_t scans) {
  for (const StateBlock& block : blocks) sums_.emplace_back(block.components.size(), scans);
}

void BlockErrors::add(const ErrorRows& errors, std::uint64_t run,
                      std::span<const StateBlock> blocks) {
  expect(blocks.size() == sums_.size(), "sums of each block");
  std::vector<WhitenedRun> whitened;
  for (const StateBlock& block : blocks)
    whitened.push_back(unknown_errors(block.components.size(), errors.scans(), run));
  std::vector<std::vector<double>> nees(blocks.size(), std::vector<double>(errors.scans(), kNaN));
  for (std::size_t s = 0; s < errors.scans(); ++s) {
    const Eigen::VectorXd error = errors.error(s);
    const Eigen::MatrixXd P = errors.covariance_of(s);
    if (!imported_nees(error, P).is_usable()) continue;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const std::vector<Eigen::Index>& judged = blocks[b].components;
      const Eigen::VectorXd part = error(judged);
      const Eigen::MatrixXd of_part = P(judged, judged);
      nees[b][s] = on_full_scale(imported_nees(part, of_part), judged.size());
      whiten_imported(part, of_part, errors.rounding(), s, whitened[b]);
    }
  }
  for (std::size_t b = 0; b < blocks.size(); ++b) sums_[b].add(whitened[b], nees[b]);
}

std::vector<BlockVerdict> BlockErrors::result(std::span<const StateBlock> blocks,
                                              const ErrorNames& names, double level, double within,
                                              std::uint64_t runs) const {
  expect(blocks.size() == sums_.size(), "sums of each block");
  std::vector<BlockVerdict> all;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    std::vector<std::string> components;
    for (const Eigen::Index k : blocks[b].components)
      components.push_back(names.components[static_cast<std::size_t>(k)]);
    const ErrorNames of_block{components, names.times};
    const double level_of_each = 1.0 - (1.0 - level) / static_cast<double>(blocks.size());
    all.push_back({blocks[b].name, judge(sums_[b].families(level_of_each, of_block), level_of_each,
                                         within, runs, sums_[b].beside_tests(of_block))});
  }
  return all;
}

}  // namespace montecarta::analysis
