# Functions for the CMakeLists of the folders.

# Sources of a target. A unity build compiles those of one group together: a solver and what it alone uses, or what a folder shares, so that
# a new file elsewhere does not change how a solver is compiled. Without a group (-) each is compiled alone.
function(hausbench_sources target group)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  target_sources(${target} PRIVATE ${ARGN})
  if(NOT group STREQUAL "-")
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${group})
  endif()
endfunction()

# Sources that are compiled once for each instruction set, by including themselves again (hwy/foreach_target.h), so they stay alone.
# Half of the time to build the fuzz targets went to sanitizers' checks in them, each one large function after inlining; `make asan-kernels`
# has these checks.
function(hausbench_vector_sources target)
  hausbench_sources(${target} - ${ARGN})
  if(HAUSBENCH_WITH_FUZZERS)
    list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
    set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES COMPILE_OPTIONS -fno-sanitize=undefined,address)
  endif()
endfunction()

# hausbench_solver(NAME SOURCE ... [ALONE] [IF CONDITION ELSE WHY]): a solver of the program. One of its sources defines NAME_solver(). Where the
# variable CONDITION is off, it is listed as not built, and WHY. Its folder is its group in a unity build, unless ALONE.
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

# The lists that registry.cpp reads, from all lines above.
function(hausbench_write_solvers)
  foreach(list SOLVERS NOT_BUILT)
    get_property(lines GLOBAL PROPERTY HAUSBENCH_${list})
    list(JOIN lines "\n" lines)
    string(TOLOWER ${list} file)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${file}.inc CONTENT "// Written by CMake: the lines hausbench_solver(...).\n${lines}\n")
  endforeach()
endfunction()
