// SPDX-License-Identifier: BSD-3-Clause
// A filter that the laws must refuse: dead reckoning that forgets nothing of the run before.
#include "filters/dead_reckoning.hpp"
#include "filters/factory.hpp"
#include "filters/setup/filter_setup.hpp"

namespace {

using namespace montecarta::filters;

class Remembering final : public SlamFilter {
 public:
  explicit Remembering(const FilterSetup& setup) : inner_(dead_reckoning_kind().make(setup)) {}
  void start(const Pose& start) override {
    if (!started_) inner_->start(start);
    started_ = true;
  }
  void predict(const StepContext& context, const Control& control, double duration) override {
    inner_->predict(context, control, duration);
  }
  void update(const StepContext& context, Scan scan) override { inner_->update(context, scan); }
  PoseEstimate estimate() const override { return inner_->estimate(); }
  const ScanReport& report() const override { return inner_->report(); }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override {
    inner_->map(landmarks);
  }

 private:
  std::unique_ptr<SlamFilter> inner_;
  bool started_ = false;
};

FilterKind remembering_kind() {
  FilterKind kind = dead_reckoning_kind();
  kind.name = "remembering";
  kind.make = [](const FilterSetup& setup) { return std::make_unique<Remembering>(setup); };
  return kind;
}

const bool kAdded = add_filter(remembering_kind);

}  // namespace
