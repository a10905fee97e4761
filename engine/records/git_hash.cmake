# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Run at every build: writes HEADER with the commit of SOURCE, "unknown" outside git. Touches the
# header only when the commit changed, so nothing is compiled needlessly, and never fails.
execute_process(
  COMMAND git --no-optional-locks -C ${SOURCE} describe --always --dirty --abbrev=40 --exclude=*
  OUTPUT_VARIABLE hash RESULT_VARIABLE status OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT status EQUAL 0 OR hash STREQUAL "")
  set(hash unknown)
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define MONTECARTA_GIT_HASH \"@hash@\"\n" @ONLY)
