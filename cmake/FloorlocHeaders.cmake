# SPDX-License-Identifier: Apache-2.0
# Precompiled headers. Reading the standard library, Eigen and OpenCV took half of the time of a typical source.
# A source must still include what it uses: CMAKE_DISABLE_PRECOMPILE_HEADERS (preset lint) shows whether it does.

set(FLOORLOC_COMMON_HEADERS
  <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory> <mutex> <numbers> <optional> <random>
  <set> <span> <sstream> <stdexcept> <string> <string_view> <unordered_map> <utility> <vector>
  <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <opencv2/core.hpp>)

# For what is compiled more often than it runs: tests and the command line. What takes time at run time is in libraries.
add_library(floorloc_quick_options INTERFACE)
target_link_libraries(floorloc_quick_options INTERFACE floorloc_options)
target_compile_options(floorloc_quick_options INTERFACE $<$<CONFIG:Release>:-O1>)

# floorloc_precompile(NAME LIBS... HEADERS...): the common headers and more, for targets with the options of LIBS. More
# is not better: every source pays for what the compiler instantiates of a header (0.3 s for the common ones, 0.3 s for
# GoogleMock, 0.5 s for nlohmann/json.hpp), whether it uses it or not.
function(floorloc_precompile name)
  cmake_parse_arguments(ARG "" "" "LIBS;HEADERS" ${ARGN})
  set(source ${CMAKE_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// A precompiled header belongs to a target, a target has a source.\n")
  add_library(${name} OBJECT EXCLUDE_FROM_ALL ${source})
  target_link_libraries(${name} PRIVATE ${ARG_LIBS} Eigen3::Eigen opencv_core)
  target_precompile_headers(${name} PRIVATE ${FLOORLOC_COMMON_HEADERS} ${ARG_HEADERS})
endfunction()

# floorloc_use_precompiled(TARGET NAME)
function(floorloc_use_precompiled target name)
  target_precompile_headers(${target} REUSE_FROM ${name})
  if(NOT CMAKE_DISABLE_PRECOMPILE_HEADERS)
    # For editors, which read the headers of compile_commands.json as text; the layering test forbids OpenCV where it
    # does not belong.
    target_include_directories(${target} SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
  endif()
endfunction()

floorloc_precompile(floorloc_headers LIBS floorloc_options)
floorloc_precompile(floorloc_command_headers LIBS floorloc_quick_options CLI11::CLI11 HEADERS <CLI/CLI.hpp> <iostream>
                                                                                             <nlohmann/json.hpp>)
if(FLOORLOC_BUILD_TESTS)
  find_package(GTest REQUIRED)
  floorloc_precompile(floorloc_test_headers LIBS floorloc_quick_options GTest::gmock HEADERS <gmock/gmock.h> <gtest/gtest.h>)
endif()

# floorloc_long_sentences(TARGET): for targets that concatenate many strings in one expression. GCC 12 warns falsely there
# of reads and writes beyond std::string's local buffer, and a precompiled header is no system header to it.
function(floorloc_long_sentences target)
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread -Wno-stringop-overflow>)
endfunction()
