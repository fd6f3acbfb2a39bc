# SPDX-License-Identifier: Apache-2.0
# One library target per folder: a layer. Its link line lists all layers that it may include.

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

# Flags of all targets of the project.
add_library(floorloc_options INTERFACE)
target_compile_features(floorloc_options INTERFACE cxx_std_20)
target_compile_options(floorloc_options INTERFACE -Wall -Wextra -Wconversion -Wshadow -Werror)
# GCC 12 warns falsely of overlaps in std::string's operator+ (GCC bug 105651), and of its bounds where the header is a
# precompiled one.
target_compile_options(floorloc_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict -Wno-array-bounds>)
target_include_directories(floorloc_options INTERFACE ${CMAKE_SOURCE_DIR})
target_compile_definitions(floorloc_options INTERFACE FLOORLOC_VERSION="${PROJECT_VERSION}")

set(FLOORLOC_SANITIZE "" CACHE STRING "Sanitizers, e.g. address,undefined or thread")
if(FLOORLOC_SANITIZE)
  target_compile_options(floorloc_options INTERFACE -fsanitize=${FLOORLOC_SANITIZE} -fno-omit-frame-pointer
                                                    -fno-sanitize-recover=all)
  target_link_options(floorloc_options INTERFACE -fsanitize=${FLOORLOC_SANITIZE})
  # These check every dereference, a third of all that is compiled then. What they find here, the address sanitizer
  # finds too, except for misaligned reads: the fuzz targets check those, where outside bytes are read.
  if(FLOORLOC_SANITIZE MATCHES "undefined" AND NOT FLOORLOC_SANITIZE MATCHES "fuzzer")
    target_compile_options(floorloc_options INTERFACE -fno-sanitize=null,alignment,object-size,vptr)
  endif()
  if(FLOORLOC_SANITIZE MATCHES "thread")  # the same bug, seen by another warning
    target_compile_options(floorloc_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)
  endif()
endif()

# floorloc_library(NAME [QUICK headers] [PUBLIC targets...] [PRIVATE targets...] [EXCLUDE files...])
# QUICK: at -O1, like the tests, with these precompiled headers: for code that calls what takes the time.
# Builds every .cpp of the current folder (main.cpp and those to exclude excepted) into the static library floorloc::NAME.
function(floorloc_library name)
  cmake_parse_arguments(ARG "" "QUICK" "PUBLIC;PRIVATE;EXCLUDE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  file(GLOB headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.h)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  list(TRANSFORM ARG_EXCLUDE PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(REMOVE_ITEM sources "" ${ARG_EXCLUDE})
  add_library(floorloc_${name} STATIC ${sources})
  add_library(floorloc::${name} ALIAS floorloc_${name})
  target_link_libraries(floorloc_${name} PUBLIC floorloc_options ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  if(ARG_QUICK)
    target_link_libraries(floorloc_${name} PRIVATE floorloc_quick_options)
    floorloc_use_precompiled(floorloc_${name} ${ARG_QUICK})
  else()
    floorloc_use_precompiled(floorloc_${name} floorloc_headers)
  endif()
  # Every header must compile alone. Those with a source of their name do, since it includes them first (the layering
  # test sees to it); the others are compiled by target floorloc_NAME_verify_interface_header_sets.
  foreach(header ${headers})
    string(REGEX REPLACE "\\.h$" ".cpp" source ${header})
    if(NOT source IN_LIST sources)
      list(APPEND lone_headers ${header})
    endif()
  endforeach()
  list(REMOVE_ITEM headers ${lone_headers})
  target_sources(floorloc_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_SOURCE_DIR} FILES ${headers})
  if(lone_headers)
    target_sources(floorloc_${name} PUBLIC FILE_SET lone TYPE HEADERS BASE_DIRS ${CMAKE_SOURCE_DIR} FILES ${lone_headers})
    set_target_properties(floorloc_${name} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON
                                                      INTERFACE_HEADER_SETS_TO_VERIFY lone)
  endif()
endfunction()

# floorloc_kernels(SOURCES...): sources of the current folder whose inner loops dominate the run time.
function(floorloc_kernels)
  # Fused multiply-add rounds differently: without it every processor finds the same features.
  set(options -ffp-contract=off -fno-math-errno -fno-trapping-math)
  # GCC's generic tuning, which target_clones get too, avoids gather loads; they are faster here.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    list(APPEND options -mtune=haswell)
  endif()
  if(FLOORLOC_SANITIZE)
    list(APPEND options -O2)
  endif()
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# floorloc_hot(SOURCES...): sources of the current folder in which the tests of sanitized builds, where nothing is
# inlined otherwise, spend most of their time.
function(floorloc_hot)
  if(FLOORLOC_SANITIZE)
    set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS -O2 SKIP_PRECOMPILE_HEADERS ON)
  endif()
endfunction()

# Every test binary, and those of what several threads share: what presets asan and tsan build.
add_custom_target(unit_tests)
add_custom_target(thread_tests)

# floorloc_test(NAME SOURCES... LIBS... [SHARDS n] [THREADS filter] [LONG patterns...]): one GoogleTest binary. ctest
# starts it once, not once for each case (each start of a binary with OpenCV takes 0.1 to 0.2 s), or in n parts at once,
# for long ones. Labels: unit, and threads for those whose cases start threads; preset tsan runs those of them that match
# the filter. The cases that match LONG are parts of their own with the label long: './run test asan' leaves them out.
function(floorloc_test name)
  cmake_parse_arguments(ARG "" "SHARDS;THREADS" "SOURCES;LIBS;LONG" ${ARGN})
  list(JOIN ARG_LONG ":" long)
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE floorloc_quick_options ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  floorloc_use_precompiled(${name} floorloc_test_headers)
  if(FLOORLOC_SANITIZE)
    floorloc_long_sentences(${name})  # what sanitizers insert makes GCC warn falsely
  endif()
  add_dependencies(unit_tests ${name})
  set(labels unit)
  if(ARG_THREADS)
    list(APPEND labels threads)
    add_dependencies(thread_tests ${name})
  endif()
  if(ARG_THREADS AND FLOORLOC_SANITIZE MATCHES "thread")
    floorloc_test_parts(${name} ${name} "${ARG_THREADS}" 1 "${labels}")
  elseif(ARG_LONG)
    floorloc_test_parts(${name} ${name} "*-${long}" "${ARG_SHARDS}" "${labels}")
    floorloc_test_parts(${name} ${name}.long "${long}" "${ARG_SHARDS}" "${labels};long")
  else()
    floorloc_test_parts(${name} ${name} "*" "${ARG_SHARDS}" "${labels}")
  endif()
endfunction()

# floorloc_test_parts(BINARY PART FILTER SHARDS LABELS): the cases that match, in so many tests of ctest.
function(floorloc_test_parts binary part filter shards labels)
  if(NOT shards)
    set(shards 1)
  endif()
  math(EXPR last "${shards} - 1")
  foreach(shard RANGE ${last})
    set(name ${part})
    if(shards GREATER 1)
      string(APPEND name ".${shard}")
    endif()
    add_test(NAME ${name} COMMAND ${binary} --gtest_brief=1 --gtest_filter=${filter})
    # tests/runner/count_cases.py counts the cases in the reports.
    set(environment GTEST_OUTPUT=xml:${CMAKE_BINARY_DIR}/reports/${name}.xml
                    GTEST_TOTAL_SHARDS=${shards} GTEST_SHARD_INDEX=${shard})
    set_tests_properties(${name} PROPERTIES LABELS "${labels}" COST ${shards} ENVIRONMENT "${environment}")
  endforeach()
endfunction()
