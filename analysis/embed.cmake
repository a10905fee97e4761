# SPDX-License-Identifier: BSD-3-Clause
cmake_minimum_required(VERSION 3.25)

# Writes SOURCE, the C++ that holds files of the source tree: STYLES and SCRIPTS of the page, each
# list joined in its order, and PROSE, each file by its name. All are paths separated by spaces.

# The bytes of a file as text constants of 8000 characters; a text constant has a limit of 65536.
function(read_as_constants path result)
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
  set(${result} "${pieces}" PARENT_SCOPE)
endfunction()

function(append_text name constant files)
  file(APPEND ${SOURCE} "\nstatic constexpr std::string_view ${constant}[] = {\n")
  foreach(path IN LISTS files)
    read_as_constants(${path} pieces)
    file(APPEND ${SOURCE} "${pieces},\n")
  endforeach()
  file(APPEND ${SOURCE} "};\n\nstd::string ${name}() {\n  std::string text;\n"
                        "  for (const std::string_view file : ${constant}) text += file;\n"
                        "  return text;\n}\n")
endfunction()

function(append_prose files)
  file(APPEND ${SOURCE} "\nstatic constexpr ProseFile kProseFiles[] = {\n")
  foreach(path IN LISTS files)
    get_filename_component(name ${path} NAME_WE)
    read_as_constants(${path} pieces)
    file(APPEND ${SOURCE} "{\"${name}\",${pieces}},\n")
  endforeach()
  file(APPEND ${SOURCE} "};\n\nstd::span<const ProseFile> prose_files() { return kProseFiles; }\n")
endfunction()

separate_arguments(STYLES)
separate_arguments(SCRIPTS)
separate_arguments(PROSE)
file(WRITE ${SOURCE} "#include \"analysis/study/prose.hpp\"\n"
                     "#include \"analysis/render/page/html.hpp\"\n\n"
                     "namespace montecarta::analysis {\n")
append_text(page_style kStyles "${STYLES}")
append_text(page_script kScripts "${SCRIPTS}")
append_prose("${PROSE}")
file(APPEND ${SOURCE} "\n}  // namespace montecarta::analysis\n")
