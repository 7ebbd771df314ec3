# usage: cmake [-DPALPATE_MAINTAINER='NAME <ADDRESS>'] -P write_source.cmake FOLDER
# Writes the folder debian of a source package into the unpacked sources: from control.cmake, packages.txt, LICENSE and
# the maintainer scripts that the packages made by CPack also have.
cmake_minimum_required(VERSION 3.25)
math(EXPR last "${CMAKE_ARGC} - 1")
set(folder "${CMAKE_ARGV${last}}/debian")
set(palpate_debian "${CMAKE_CURRENT_LIST_DIR}")
get_filename_component(root "${palpate_debian}/../../.." ABSOLUTE)
set(palpate_licence "${root}/LICENSE")
set(PALPATE_SUITESPARSE ON)
set(same "(= \${binary:Version})")
include("${palpate_debian}/control.cmake")
include("${palpate_debian}/documents.cmake")
set(palpate_maintainer "${PALPATE_MAINTAINER}")
file(STRINGS "${root}/CMakeLists.txt" project REGEX "^project\\(palpate VERSION ")
string(REGEX REPLACE ".* VERSION ([0-9.]+).*" "\\1-1" palpate_version "${project}")

# Every build has build-essential.
file(STRINGS "${root}/tools/packaging/packages.txt" lines)
set(needed "debhelper-compat (= 13)")
set(of_build OFF)
foreach(line IN LISTS lines)
  if(line MATCHES "^#")
    string(REGEX MATCH "Build-Depends" of_build "${line}")
  elseif(of_build AND line AND NOT line STREQUAL "build-essential")
    list(APPEND needed "${line}")
  endif()
endforeach()
list(JOIN needed ",\n " needed)

set(control "Source: palpate
Section: misc
Priority: optional
Maintainer: ${PALPATE_MAINTAINER}
Build-Depends: ${needed}
Standards-Version: 4.6.2
Rules-Requires-Root: no
")
set(components "")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} C)
  set(of CPACK_DEBIAN_${C}_PACKAGE)
  set(name "${${of}_NAME}")
  string(APPEND components "${name} ${component}\n")
  # The instructions that the programs are built for, and DART's libraries, are those of PCs.
  set(architecture amd64)
  if(${of}_ARCHITECTURE)
    set(architecture ${${of}_ARCHITECTURE})
  endif()
  set(depends "\${misc:Depends}")
  if(${of}_SHLIBDEPS)
    string(APPEND depends ", \${shlibs:Depends}")
  endif()
  if(${of}_DEPENDS)
    string(APPEND depends ", ${${of}_DEPENDS}")
  endif()
  string(APPEND control "\nPackage: ${name}\nSection: ${${of}_SECTION}\nArchitecture: ${architecture}\nDepends: ${depends}\n")
  foreach(field Recommends Suggests)
    string(TOUPPER ${field} F)
    if(${of}_${F})
      string(APPEND control "${field}: ${${of}_${F}}\n")
    endif()
  endforeach()
  string(REPLACE "\n" "\n " description "${CPACK_COMPONENT_${C}_DESCRIPTION}")
  string(APPEND control "Description: ${description}\n")
  # debhelper marks files below /etc as conffiles by itself.
  foreach(script IN LISTS ${of}_CONTROL_EXTRA)
    get_filename_component(kind "${script}" NAME)
    if(NOT kind STREQUAL "conffiles")
      configure_file("${script}" "${folder}/${name}.${kind}" COPYONLY)
    endif()
  endforeach()
  configure_file("${palpate_debian}/lintian-overrides" "${folder}/${name}.lintian-overrides" COPYONLY)
endforeach()

file(WRITE "${folder}/control" "${control}")
file(WRITE "${folder}/components" "${components}")
file(WRITE "${folder}/source/format" "3.0 (quilt)\n")
configure_file("${palpate_debian}/lintian-overrides" "${folder}/source/lintian-overrides" COPYONLY)
configure_file("${palpate_debian}/source/rules" "${folder}/rules" COPYONLY)
palpate_write_copyright("${folder}/copyright")
palpate_write_changelog("${folder}/changelog")
message("palpate ${palpate_version}")
