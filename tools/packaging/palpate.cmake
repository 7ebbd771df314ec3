# Functions that define a folder of palpate as a target.
#
#   palpate_library(DEPENDS a b)          palpate::<folder> (or NAME n) from every .cpp of this folder, without
#                                         those of subfolders that are targets themselves
#   palpate_program(NAME DEPENDS a b)     bin/NAME from every .cpp of this folder (or SOURCES)
#   palpate_test(LABEL KIND TARGET t)     one test program per mirrored folder
#
# install.cmake defines which of them are installed, and where.
include(${CMAKE_CURRENT_LIST_DIR}/install.cmake)

add_library(palpate_flags INTERFACE)
target_compile_options(palpate_flags INTERFACE
  $<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wnon-virtual-dtor;-Wcast-qual;-Werror>)
# gcc 12 reports false positives of these from within Eigen at -O3.
target_compile_options(palpate_flags INTERFACE
  $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;-Wno-array-bounds;-Wno-stringop-overflow>>)
# The static libraries are also parts of palpate-baselines.so.
target_compile_options(palpate_flags INTERFACE $<BUILD_INTERFACE:-fPIC>)
target_include_directories(palpate_flags INTERFACE $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>)
# One visibility for all targets, so that all can share precompiled headers; see
# sim/robot/CMakeLists.txt.
target_compile_options(palpate_flags INTERFACE $<BUILD_INTERFACE:-fvisibility=hidden;-fvisibility-inlines-hidden>)
# DART is built for SSE2: with wider vectors Eigen would require stronger alignment than DART
# provides.
target_compile_definitions(palpate_flags INTERFACE
  EIGEN_MAX_ALIGN_BYTES=16 PALPATE_VERSION="${PROJECT_VERSION}")
if(PALPATE_MARCH)
  # Of this build alone: who uses find_package(palpate) chooses its own processor. EIGEN_MAX_ALIGN_BYTES above
  # keeps Eigen's types the same on both sides; with AVX Eigen allocates otherwise than by malloc, and memory that
  # one side allocates the other must be able to free.
  target_compile_options(palpate_flags INTERFACE $<BUILD_INTERFACE:-march=${PALPATE_MARCH}>)
  target_compile_definitions(palpate_flags INTERFACE $<INSTALL_INTERFACE:EIGEN_MALLOC_ALREADY_ALIGNED=0>)
endif()
if(PALPATE_SANITIZE)
  target_compile_options(palpate_flags INTERFACE -fsanitize=${PALPATE_SANITIZE} -fno-omit-frame-pointer)
  target_link_options(palpate_flags INTERFACE -fsanitize=${PALPATE_SANITIZE})
endif()
if(PALPATE_FUZZ)
  # The programs' own main and libFuzzer's are defined by their targets.
  target_compile_options(palpate_flags INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(palpate_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
if(PALPATE_COVERAGE)
  target_compile_options(palpate_flags INTERFACE --coverage -fprofile-abs-path -fprofile-update=atomic)
  target_link_options(palpate_flags INTERFACE --coverage)
endif()
# Factor on a test's time-out relative to a release build.
set(PALPATE_SLOWNESS 1)
if(PALPATE_SANITIZE OR PALPATE_COVERAGE)
  set(PALPATE_SLOWNESS 8)
endif()
# Only libraries that are used are loaded, whatever the packages of others link to.
target_link_options(palpate_flags INTERFACE $<BUILD_INTERFACE:-Wl,--as-needed>)
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM AND NOT PALPATE_SANITIZE)
  # Before version 2.4 mold may begin the read-only segment of relocations with .tbss, on a page that
  # is not mapped; such a program does not start (github.com/rui314/mold/issues/1151).
  target_link_options(palpate_flags INTERFACE "$<BUILD_INTERFACE:-fuse-ld=mold;-Wl,-z,norelro>")
endif()

# Compilation of a target. LOOP: as users run it. OFFLINE: tests of programs, and programs with little
# computation that share no hot code with core, for which build time matters (an object of lower
# optimisation provides its inline functions to others of the same program). LAB: in between, for
# tests of what computes and for studies, whose time is that of the programs they start. Each uses one
# precompiled file with the headers that nearly all sources include, tests one with googletest; a
# source with its own flags does not.
option(PALPATE_PCH "Precompile common headers" ON)
set(PALPATE_LOOP_FLAGS "")
set(PALPATE_LAB_FLAGS $<$<CONFIG:Release>:-O2>)
set(PALPATE_OFFLINE_FLAGS $<$<CONFIG:Release>:-O1>)
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  # Most of the time goes into inlining the macros of googletest and what is run once.
  list(APPEND PALPATE_LAB_FLAGS $<$<CONFIG:Release>:SHELL:-mllvm -inline-threshold=20>)
  list(APPEND PALPATE_OFFLINE_FLAGS $<$<CONFIG:Release>:SHELL:-mllvm -inline-threshold=20>)
endif()
set(PALPATE_OFFLINE_FOLDERS
  "^tools/(bridge|collect|command|common|doctor|export|import|log|mesh|record|reference|top|train|view)|^tests/(unit/(rt|tools|lcmtypes)|process)")
set(PALPATE_LAB_FOLDERS
  "^tools/lab/(demo|endurance|faults|fit_check|runs|scores|studies)|^tests/(unit|property|integration|fault|fuzz|stress)")
# Of a filter some of whose results with obstacles change with rounding: as users run it.
set(PALPATE_LOOP_TESTS "^tests/unit/core/estimation")
if(PALPATE_PCH)
  set(kinds "")
  if(PALPATE_TESTS)
    find_package(GTest REQUIRED)
    set(kinds _TEST)
  endif()
  set(headers <Eigen/Dense> <Eigen/Geometry> <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <filesystem>
    <fstream> <functional> <map> <memory> <optional> <sstream> <stdexcept> <string> <vector>)
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/pch/empty.cpp CONTENT "")  # keeps an equal file
  foreach(way LOOP LAB OFFLINE)
    foreach(kind "" ${kinds})
      set(target palpate_pch_${way}${kind})
      add_library(${target} OBJECT EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/pch/empty.cpp)
      target_link_libraries(${target} PRIVATE palpate_flags Eigen3::Eigen Threads::Threads)
      target_compile_options(${target} PRIVATE ${PALPATE_${way}_FLAGS})
      target_precompile_headers(${target} PRIVATE ${headers})
      if(kind)
        target_link_libraries(${target} PRIVATE GTest::gmock)
        target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <gtest/gtest.h>)
      endif()
    endforeach()
  endforeach()
endif()

# Compiles several sources of a target as one, so that shared headers are read and instantiated
# once. Off in presets for development (dev, debug, the sanitizers) and in `bitwise`.
option(PALPATE_UNITY "Compile several sources at a time" OFF)
if(PALPATE_UNITY)
  # A source's private types are then "included" by the file that joins it with others.
  target_compile_options(palpate_flags INTERFACE $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>>)
endif()

# By the folder of its sources; `kind` is "" or "_TEST".
function(palpate_compile target kind source)
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${source})
  set(way LOOP)
  if(folder MATCHES "${PALPATE_OFFLINE_FOLDERS}")
    set(way OFFLINE)
  elseif(folder MATCHES "${PALPATE_LAB_FOLDERS}" AND NOT folder MATCHES "${PALPATE_LOOP_TESTS}")
    set(way LAB)
  endif()
  target_compile_options(${target} PRIVATE ${PALPATE_${way}_FLAGS})
  if(PALPATE_PCH)
    target_precompile_headers(${target} REUSE_FROM palpate_pch_${way}${kind})
  endif()
  if(PALPATE_UNITY AND NOT folder MATCHES "^tests/(stress|fault|process)")
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 12)
  endif()
endfunction()

function(palpate_library)
  cmake_parse_arguments(ARG "" "NAME" "DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  get_filename_component(name ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  if(ARG_NAME)
    set(name ${ARG_NAME})
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  file(GLOB_RECURSE targets RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*/CMakeLists.txt)
  foreach(target ${targets})
    get_filename_component(target ${target} DIRECTORY)
    list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${target}/")
  endforeach()
  if(sources)
    add_library(palpate_${name} STATIC ${sources})
    target_link_libraries(palpate_${name} PUBLIC palpate_flags ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS})
  else()
    add_library(palpate_${name} INTERFACE)
    target_link_libraries(palpate_${name} INTERFACE palpate_flags ${ARG_DEPENDS})
  endif()
  if(sources)
    palpate_compile(palpate_${name} "" ${CMAKE_CURRENT_SOURCE_DIR})
  endif()
  add_library(palpate::${name} ALIAS palpate_${name})
  palpate_export_library(${name})
endfunction()

function(palpate_program name)
  cmake_parse_arguments(ARG "" "" "DEPENDS;SOURCES" ${ARGN})
  if(NOT ARG_SOURCES)
    file(GLOB ARG_SOURCES CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE palpate_flags ${ARG_DEPENDS})
  palpate_compile(${name} "" ${CMAKE_CURRENT_SOURCE_DIR})
  palpate_install_program(${name})
endfunction()

# A program in Python: palpate_<folder>.command in the current folder. Its modules stay in the source
# tree, or go to share/palpate/tools; the program finds them.
function(palpate_python_program PROGRAM)
  get_filename_component(FOLDER ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  set(program ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${PROGRAM})
  configure_file(${CMAKE_SOURCE_DIR}/tools/common/python_program.in ${program} @ONLY)
  file(CHMOD ${program} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
  set_property(GLOBAL APPEND PROPERTY PALPATE_PROGRAMS_tools ${PROGRAM})
  install(PROGRAMS ${program} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT tools)
  install(DIRECTORY palpate_${FOLDER} DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate/tools/${FOLDER}
    COMPONENT tools PATTERN __pycache__ EXCLUDE)
endfunction()

# Every .cpp of the folder `dir` (below the current one) becomes the test program
# <label>_<dir with underscores>, linked to `DEPENDS`; each of its tests is a ctest of that label.
function(palpate_test dir)
  cmake_parse_arguments(ARG "RUN_SERIAL" "LABEL;TIMEOUT" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${dir}/*.cpp)
  if(NOT sources)
    return()
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  math(EXPR ARG_TIMEOUT "${ARG_TIMEOUT} * ${PALPATE_SLOWNESS}")
  set(serial FALSE)
  if(ARG_RUN_SERIAL)
    set(serial TRUE)
  endif()
  string(REPLACE "/" "_" flat ${dir})
  set(name ${ARG_LABEL}_${flat})
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE palpate_flags palpate::support ${ARG_DEPENDS}
    GTest::gmock GTest::gtest GTest::gtest_main)
  palpate_compile(${name} _TEST ${CMAKE_CURRENT_SOURCE_DIR}/${dir})
  gtest_discover_tests(${name} TEST_PREFIX "${ARG_LABEL}.${flat}." DISCOVERY_MODE PRE_TEST
    DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT}
    RUN_SERIAL ${serial})
endfunction()
