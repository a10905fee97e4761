# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Runs at every build and writes the commit of SOURCE to HEADER: "unknown" outside git, and with
# "-dirty" at the end if sources have uncommitted changes (pages of results do not count). Changes
# the header only if the commit has changed, so nothing is compiled needlessly. Never fails.
set(git git --no-optional-locks -C ${SOURCE})
execute_process(
  COMMAND ${git} describe --always --abbrev=40 --exclude=*
  OUTPUT_VARIABLE hash RESULT_VARIABLE status OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT status EQUAL 0 OR hash STREQUAL "")
  set(hash unknown)
else()
  execute_process(
    COMMAND ${git} diff --quiet HEAD -- . ":!experiments/results"
    RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL 0)
    string(APPEND hash -dirty)
  endif()
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define MONTECARTA_GIT_HASH \"@hash@\"\n" @ONLY)
