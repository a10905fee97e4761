// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/external_filter.hpp"

#include "experiments/external/answer.hpp"

#include <utility>

namespace montecarta::experiments {

ExternalFilter::ExternalFilter(FilterSetup setup, ExternalCommand command)
    : setup_(std::move(setup)),
      command_(std::move(command)),
      conversation_(std::make_unique<Conversation>()) {}

/// The program hears of it with the first step, which knows the run's number and seed.
void ExternalFilter::start(const Pose& start) {
  start_ = start;
  is_begun_ = false;
  stop_ = nullptr;
  report_ = {};
  conversation_->controls.clear();
  conversation_->pose = {start, Eigen::Matrix3d::Zero()};
}

void ExternalFilter::predict(const StepContext& context, const Control& control, double duration) {
  begin(context);
  conversation_->controls.push_back({control.speed, control.steer, duration});
}

void ExternalFilter::update(const StepContext& context, Scan scan) {
  begin(context);
  converse([&](Conversation& with) {
    const std::uint64_t id = with.next_id++;
    const std::string_view line =
        ask(scan_message(id, with.controls, scan, setup_.association.kind));
    const ProgramEstimate estimate = read_estimate(line, id);
    with.pose = estimate.pose;
    with.controls.clear();
    report_ = estimate.report;
  });
}

PoseEstimate ExternalFilter::estimate() const {
  if (conversation_->controls.empty()) return {conversation_->pose, std::nullopt};
  converse([&](Conversation& with) {
    const std::uint64_t id = with.next_id++;
    with.pose = read_estimate(ask(predict_message(id, with.controls)), id).pose;
    with.controls.clear();
  });
  return {conversation_->pose, std::nullopt};
}

void ExternalFilter::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  converse([&](Conversation& with) {
    const std::uint64_t id = with.next_id++;
    read_map(ask(map_message(id)), id, setup_.association.kind, landmarks);
  });
}

void ExternalFilter::begin(const StepContext& context) {
  if (is_begun_) return;
  is_begun_ = true;
  stop_ = context.stop();
  StreamIdentity identity = context.identity(Draw::external_filter, 0);
  identity.step = 0;  // whichever step is the first with something to say
  const auto seed = static_cast<std::uint32_t>(RngStream(identity).bits() >> 32U);
  const RunStart start{context.run(), seed, start_};
  if (!command_.keeps_process) conversation_->process.reset();
  if (conversation_->process != nullptr) {
    try {
      tell_start(start);
      return;
    } catch (const ProgramError&) {
      if (stop_ != nullptr && stop_->made()) throw;
    }
  }
  tell_start(start);
}

void ExternalFilter::tell_start(const RunStart& start) const {
  converse([&](Conversation& with) {
    if (with.process == nullptr) with.process = std::make_unique<ChildProcess>(command_.words);
    with.next_id = 1;
    read_started(ask(start_message(0, start, setup_)), 0);
  });
}

std::string_view ExternalFilter::ask(const std::string& message) const {
  if (conversation_->process == nullptr) throw ProgramError("program is gone");
  return conversation_->process->exchange(message, {command_.answer_limit, stop_});
}

template <class Talk>
void ExternalFilter::converse(const Talk& talk) const {
  try {
    talk(*conversation_);
  } catch (...) {
    conversation_->process.reset();
    throw;
  }
}

}  // namespace montecarta::experiments
