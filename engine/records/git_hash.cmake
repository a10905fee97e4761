# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Run at every build: writes HEADER with the commit of SOURCE, "unknown" outside git, "-dirty"
# behind it where sources differ from that; pages of results are none. Touches the header only when
# the commit changed, so nothing is compiled needlessly, and never fails.
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
