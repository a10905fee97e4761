// SPDX-License-Identifier: BSD-3-Clause
// A crash of the process that reads a file is an error like any other.
#include "engine/records/forked_reader.hpp"

#include "engine/errors.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"

#include <csignal>

namespace montecarta::engine {
namespace {

std::string answer_to(std::string_view question) {
  if (question == "crash") std::raise(SIGSEGV);
  if (question == "stop") throw StudyError("a.h5: not whole");
  if (question == "fail") throw RunError("a.h5: cannot be read");
  return std::string(question) + "!";
}

TEST(ForkedReader, AnswersAndThrowsAsTheProcessItself) {
  const ForkedReader copy("a.h5", answer_to);
  EXPECT_EQ(copy.ask("here"), "here!");
  EXPECT_EQ(copy.ask(""), "!");
  EXPECT_EQ(copy.ask(std::string(1U << 20U, 'x')).size(), (1U << 20U) + 1U);
  EXPECT_EQ(complaint_of([&] { copy.ask("stop"); }), "a.h5: not whole");
  EXPECT_EQ(complaint_of<RunError>([&] { copy.ask("fail"); }), "a.h5: cannot be read");
  EXPECT_EQ(copy.ask("there"), "there!");
}

TEST(ForkedReader, SurvivesACrash) {
  const ForkedReader copy("a.h5", answer_to);
  for (const std::string question : {"crash", "here"}) {
    EXPECT_THAT(complaint_of([&] { copy.ask(question); }), StartsWith("a.h5: damaged"));
  }
}

}  // namespace
}  // namespace montecarta::engine
