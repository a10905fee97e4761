// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/tuning.hpp"

#include "tests/doubles/matchers.hpp"

#include <string>

namespace montecarta::analysis {
namespace {

const TunedFactor kFoundFactor{2.0, {1.9, 2.1}};

TuningResult found_noise() {
  TuningResult result;
  result.cell = "ekf_slam";
  result.noise = {.motion = kFoundFactor, .sensor = kFoundFactor};
  return result;
}

std::string sentence_on(Answer answer, bool is_slight) {
  TuningConfirmation confirmation{.runs = 50, .answer = answer, .is_slight = is_slight};
  confirmation.verdict = "what they say";
  return tuning_sentence(found_noise(), confirmation);
}

TEST(TuningSentence, RefusesOnlyWhatIsShownToBeBeyondTheMargin) {
  EXPECT_THAT(sentence_on(Answer::consistent, false), HasSubstr("it is what they say"));
  EXPECT_THAT(sentence_on(Answer::undecided, false), HasSubstr("is open"));
  EXPECT_THAT(sentence_on(Answer::optimistic, false), HasSubstr("do not make it consistent"));
  EXPECT_THAT(sentence_on(Answer::optimistic, true),
              AllOf(HasSubstr("not shown to matter"), Not(HasSubstr("do not make it"))));
}

TEST(TuningNotes, NameFactorsThatTheDataDoNotDetermine) {
  TuningResult result = found_noise();
  result.noise.motion.interval = {0.5, 4.0};
  const auto notes = tuning_notes(result, {.runs = 50});
  EXPECT_THAT(notes, testing::Contains(HasSubstr("hardly determine the noise of motion:")));
}

}  // namespace
}  // namespace montecarta::analysis
