# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Writes SOURCE, the C++ that holds the page's own files: STYLES and SCRIPTS, paths separated by
# spaces, joined in their order. In pieces of 8000 characters, since a text constant has a limit.
function(append_text name files)
  set(pieces "")
  foreach(path IN LISTS files)
    file(READ ${path} bytes HEX)
    string(LENGTH "${bytes}" length)
    set(at 0)
    while(at LESS length)
      string(SUBSTRING "${bytes}" ${at} 16000 piece)
      string(REGEX REPLACE "(..)" "\\\\x\\1" piece "${piece}")
      string(APPEND pieces "\n    \"${piece}\"")
      math(EXPR at "${at} + 16000")
    endwhile()
  endforeach()
  file(APPEND ${SOURCE} "\nstd::string_view ${name}() {\n"
                        "  static constexpr char kText[] = \"\"${pieces};\n"
                        "  return {kText, sizeof kText - 1};\n}\n")
endfunction()

separate_arguments(STYLES)
separate_arguments(SCRIPTS)
file(WRITE ${SOURCE} "#include \"analysis/page/html.hpp\"\n\nnamespace montecarta::analysis {\n")
append_text(page_style "${STYLES}")
append_text(page_script "${SCRIPTS}")
file(APPEND ${SOURCE} "\n}  // namespace montecarta::analysis\n")
