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
