# Functions for the CMakeLists.txt of the folders.

# Adds sources to a target. A unity build compiles the sources of a group together. A group is a solver with the sources that only it uses, or the
# shared sources of a folder, so that a new file elsewhere does not change how a solver is compiled. With the group "-" each source is compiled alone.
function(hausbench_sources target group)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  target_sources(${target} PRIVATE ${ARGN})
  if(NOT group STREQUAL "-")
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
  endif()
endfunction()

# Adds sources that are compiled once for each instruction set. They include themselves again (hwy/foreach_target.h), so they have no group.
# The fuzz targets leave out the sanitizers' checks in these sources, which took half of the build time, since each source becomes one large
# function after inlining. `make asan-kernels` has these checks.
function(hausbench_vector_sources target)
  hausbench_sources(${target} - ${ARGN})
  if(HAUSBENCH_WITH_FUZZERS)
    list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES COMPILE_OPTIONS -fno-sanitize=undefined,address)
  endif()
endfunction()

# hausbench_solver(NAME SOURCE ... [ALONE] [IF CONDITION ELSE WHY]): adds a solver to the program. One of its sources defines NAME_solver(). If the
# variable CONDITION is off, the solver is not built, and is listed with the reason WHY. Its group in a unity build is its folder, or none if ALONE.
function(hausbench_solver name)
  cmake_parse_arguments(PARSE_ARGV 1 solver "ALONE" "IF;ELSE" "")
  if(solver_IF AND NOT ${solver_IF})
    set_property(GLOBAL APPEND PROPERTY HAUSBENCH_NOT_BUILT "NOT_BUILT(${name}, \"${solver_ELSE}\")")
    return()
  endif()
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  if(solver_ALONE)
    set(folder -)
  endif()
  hausbench_sources(hausbench_algorithms ${folder} ${solver_UNPARSED_ARGUMENTS})
  set_property(GLOBAL APPEND PROPERTY HAUSBENCH_SOLVERS "SOLVER(${name})")
endfunction()

# Writes the lists that registry.cpp includes, from all calls of hausbench_solver().
function(hausbench_write_solvers)
  foreach(list SOLVERS NOT_BUILT)
    get_property(lines GLOBAL PROPERTY HAUSBENCH_${list})
    list(JOIN lines "\n" lines)
    string(TOLOWER ${list} file)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${file}.inc CONTENT "// Written by CMake: the lines hausbench_solver(...).\n${lines}\n")
  endforeach()
endfunction()
