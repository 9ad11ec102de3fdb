# bodyopt_room(FOLDER [PROGRAM NAME] [USES FOLDER...] [LINKS arguments of target_link_libraries...])
# A room is a folder, a library of the sources in it (not of those in folders below) named bodyopt_ and the folder, or a
# program of that name, and the rooms whose headers they include. tests/rules/rooms_test.cpp holds the sources and the
# diagram in README.md to what is said here, which is written to rooms.txt in the build folder.
set_property(GLOBAL PROPERTY BODYOPT_ROOMS "")

function(bodyopt_target FOLDER RESULT)
  string(REPLACE "/" "_" name ${FOLDER})
  set(${RESULT} bodyopt_${name} PARENT_SCOPE)
endfunction()

function(bodyopt_room FOLDER)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "PROGRAM" "USES;LINKS")
  bodyopt_target(${FOLDER} target)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${FOLDER}/*.cpp)
  set(used "")
  foreach(folder ${room_USES})
    bodyopt_target(${folder} name)
    if(NOT TARGET ${name})
      message(FATAL_ERROR "${FOLDER} uses ${folder}, which is no room that stands before it")
    endif()
    list(APPEND used ${name})
  endforeach()
  if(room_PROGRAM)
    add_executable(${room_PROGRAM} ${sources})
    target_link_libraries(${room_PROGRAM} PRIVATE bodyopt_language bodyopt_flags ${used} ${room_LINKS})
  elseif(sources)
    add_library(${target} STATIC ${sources})
    target_link_libraries(${target} PUBLIC bodyopt_language ${used} PRIVATE bodyopt_flags ${room_LINKS})
  else()  # headers only
    add_library(${target} INTERFACE)
    target_link_libraries(${target} INTERFACE bodyopt_language ${used})
  endif()
  string(REPLACE ";" " " line "${FOLDER};${room_USES}")
  set_property(GLOBAL APPEND PROPERTY BODYOPT_ROOMS ${line})
endfunction()

# How many sources are compiled at a time where that pays: four fifths of what a unit compiles are its libraries'
# templates.
set(BODYOPT_SOURCES_TOGETHER 13)

# The sources of each of these rooms are compiled several at a time: local names of two must differ.
function(bodyopt_compile_together)
  foreach(folder ${ARGN})
    bodyopt_target(${folder} target)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${BODYOPT_SOURCES_TOGETHER})
  endforeach()
endfunction()

# Rooms of files, arguments, panels and reports: what they compute is done elsewhere, and the optimiser would take a
# quarter of their build.
function(bodyopt_optimise_little)
  foreach(folder ${ARGN})
    bodyopt_target(${folder} target)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  endforeach()
endfunction()

# What most rooms of the trainer and the program include, parsed once for all of them. (clang wants a set of its own for
# each set of flags.)
set(BODYOPT_OFFLINE_HEADERS <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/SparseCore> <nlohmann/json.hpp> <algorithm> <array>
    <cmath> <filesystem> <fstream> <functional> <map> <memory> <optional> <set> <span> <sstream> <string> <vector>)
function(bodyopt_precompile FIRST)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    return()
  endif()
  bodyopt_target(${FIRST} first)
  target_precompile_headers(${first} PRIVATE ${BODYOPT_OFFLINE_HEADERS})
  target_compile_options(${first} PRIVATE -fpch-preprocess)  # for compiler caches
  foreach(folder ${ARGN})
    bodyopt_target(${folder} target)
    target_precompile_headers(${target} REUSE_FROM ${first})
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  endforeach()
endfunction()

# The rooms that a host program links: no number in them changes its type unseen. GCC's warnings: clang's are others.
function(bodyopt_convert_explicitly)
  foreach(folder ${ARGN})
    bodyopt_target(${folder} target)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wconversion -Wsign-conversion>)
  endforeach()
endfunction()

# A line for each room: its folder, then those of the rooms that it uses.
function(bodyopt_write_rooms)
  get_property(rooms GLOBAL PROPERTY BODYOPT_ROOMS)
  list(JOIN rooms "\n" text)
  file(WRITE ${PROJECT_BINARY_DIR}/rooms.txt "${text}\n")
endfunction()
