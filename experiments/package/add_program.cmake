# SPDX-License-Identifier: BSD-3-Clause
# montecarta_add_program(NAME SOURCE...): the program montecarta with more in it, e.g. filters that
# add themselves (filters/WRITE_YOUR_OWN.md).
function(montecarta_add_program name)
  set(objects montecarta_main montecarta_processor_check)
  set(library montecarta_experiments)
  if(TARGET montecarta::montecarta_experiments)  # an installed one
    list(TRANSFORM objects PREPEND montecarta::)
    set(library montecarta::montecarta_experiments)
  endif()
  list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_executable(${name} ${ARGN} ${objects})
  target_link_libraries(${name} PRIVATE ${library})
endfunction()

# montecarta_add_laws(NAME SOURCE...): a test program, which ctest runs, that holds the filters
# which these sources add to what every filter is held to; the sources may have tests of their own.
function(montecarta_add_laws name)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name} ${ARGN} $<TARGET_OBJECTS:montecarta::montecarta_laws>)
  target_link_libraries(${name} PRIVATE montecarta::montecarta_experiments GTest::gtest_main)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60)
endfunction()
