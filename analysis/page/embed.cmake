# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Writes SOURCE, the C++ that holds the page's own files: STYLES and SCRIPTS, paths separated by
# spaces, joined in their order. A constant for each file, since a text constant has a limit of
# 65536 characters, in pieces of 8000 characters.
function(append_text name constant files)
  file(APPEND ${SOURCE} "\nstatic constexpr std::string_view ${constant}[] = {\n")
  foreach(path IN LISTS files)
    set(pieces "")
    file(READ ${path} bytes HEX)
    string(LENGTH "${bytes}" length)
    set(at 0)
    while(at LESS length)
      string(SUBSTRING "${bytes}" ${at} 16000 piece)
      string(REGEX REPLACE "(..)" "\\\\x\\1" piece "${piece}")
      string(APPEND pieces "\n    \"${piece}\"")
      math(EXPR at "${at} + 16000")
    endwhile()
    file(APPEND ${SOURCE} "${pieces},\n")
  endforeach()
  file(APPEND ${SOURCE} "};\n\nstd::string ${name}() {\n  std::string text;\n"
                        "  for (const std::string_view file : ${constant}) text += file;\n"
                        "  return text;\n}\n")
endfunction()

separate_arguments(STYLES)
separate_arguments(SCRIPTS)
file(WRITE ${SOURCE} "#include \"analysis/page/html.hpp\"\n\nnamespace montecarta::analysis {\n")
append_text(page_style kStyles "${STYLES}")
append_text(page_script kScripts "${SCRIPTS}")
file(APPEND ${SOURCE} "\n}  // namespace montecarta::analysis\n")
