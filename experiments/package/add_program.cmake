# SPDX-License-Identifier: BSD-3-Clause
# montecarta_add_program(NAME SOURCE...): adds the program montecarta with additional sources, e.g.
# filters that register themselves (filters/WRITE_YOUR_OWN.md).
function(montecarta_add_program name)
  set(objects montecarta_main montecarta_processor_check)
  set(library montecarta_experiments)
  if(TARGET montecarta::montecarta_experiments)  # of an installation
    list(TRANSFORM objects PREPEND montecarta::)
    set(library montecarta::montecarta_experiments)
  endif()
  list(TRANSFORM objects REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>")
  add_executable(${name} ${ARGN} ${objects})
  target_link_libraries(${name} PRIVATE ${library})
endfunction()

# montecarta_add_laws(NAME SOURCE...): adds a test program that checks the filters in these sources
# with the tests that every filter must pass. The sources may contain further tests.
function(montecarta_add_laws name)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name} ${ARGN} $<TARGET_OBJECTS:montecarta::montecarta_laws>)
  target_link_libraries(${name} PRIVATE montecarta::montecarta_experiments GTest::gtest_main)
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60)
endfunction()
