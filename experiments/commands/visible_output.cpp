// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/visible_output.hpp"

#include "engine/text/visible_text.hpp"

#include <string_view>

namespace montecarta::experiments {

VisibleOutput::VisibleOutput(std::ostream& stream) : stream_(stream), target_(stream.rdbuf(this)) {}

VisibleOutput::~VisibleOutput() {
  sync();
  const std::ios_base::iostate state = stream_.rdstate();  // setting a buffer clears it
  stream_.rdbuf(target_);
  stream_.clear(state);
}

bool VisibleOutput::pass_on() {
  const std::size_t unfinished = engine::unfinished_bytes(waiting_);
  const std::string shown =
      engine::visible(std::string_view(waiting_).substr(0, waiting_.size() - unfinished), "\n\t");
  waiting_.erase(0, waiting_.size() - unfinished);
  const auto length = static_cast<std::streamsize>(shown.size());
  return target_->sputn(shown.data(), length) == length;
}

VisibleOutput::int_type VisibleOutput::overflow(int_type c) {
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  waiting_ += traits_type::to_char_type(c);
  return pass_on() ? c : traits_type::eof();
}

std::streamsize VisibleOutput::xsputn(const char* text, std::streamsize length) {
  waiting_.append(text, static_cast<std::size_t>(length));
  return pass_on() ? length : 0;
}

int VisibleOutput::sync() {
  const std::string rest = engine::visible(waiting_, "\n\t");  // no later byte can complete it
  waiting_.clear();
  const auto length = static_cast<std::streamsize>(rest.size());
  if (target_->sputn(rest.data(), length) != length) return -1;
  return target_->pubsync();
}

}  // namespace montecarta::experiments
