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

# Sets the properties of an OBJECT library whose sources are part of the program and of the C library.
function(hausbench_shared_objects target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    UNITY_BUILD_MODE GROUP)
endfunction()

# hausbench_solver(NAME SOURCE ... [ALONE] [GPL] [IF CONDITION ELSE WHY]): adds a solver to the program. One of its sources defines hausbench::NAME::solver(). If
# the variable CONDITION is off, the solver is not built, and is listed with the reason WHY. Its group in a unity build is its folder, or none if ALONE.
# The C library leaves out solvers marked GPL, which need libraries under the GPL, and SURFACES, which accept only shapes that it does not have.
function(hausbench_solver name)
  cmake_parse_arguments(PARSE_ARGV 1 solver "ALONE;GPL;SURFACES" "IF;ELSE" "")
  if(solver_GPL)
    set_property(GLOBAL APPEND PROPERTY HAUSBENCH_LIBRARY_NOT_BUILT "NOT_BUILT(${name}, \"it needs code under the GPL, which this library leaves out\")")
  elseif(solver_SURFACES)
    set_property(GLOBAL APPEND PROPERTY HAUSBENCH_LIBRARY_NOT_BUILT "NOT_BUILT(${name}, \"this library has no algebraic surfaces\")")
  endif()
  if(solver_IF AND NOT ${solver_IF})
    set(why "NOT_BUILT(${name}, \"${solver_ELSE}\")")
    set_property(GLOBAL APPEND PROPERTY HAUSBENCH_NOT_BUILT "${why}")
    if(NOT solver_GPL AND NOT solver_SURFACES)
      set_property(GLOBAL APPEND PROPERTY HAUSBENCH_LIBRARY_NOT_BUILT "${why}")
    endif()
    return()
  endif()
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME folder)
  if(solver_ALONE)
    set(folder -)
  endif()
  hausbench_sources(hausbench_algorithms ${folder} ${solver_UNPARSED_ARGUMENTS})
  set_property(GLOBAL APPEND PROPERTY HAUSBENCH_SOLVERS "SOLVER(${name})")
  if(NOT solver_GPL AND NOT solver_SURFACES)
    set_property(GLOBAL APPEND PROPERTY HAUSBENCH_LIBRARY_SOLVERS "SOLVER(${name})")
  endif()
endfunction()

# Writes the lists that built_solvers.cpp includes, from all calls of hausbench_solver(): for the program to generated/, for the C library to
# generated/library/.
function(hausbench_write_solvers)
  foreach(list SOLVERS NOT_BUILT)
    string(TOLOWER ${list} file)
    foreach(of "" LIBRARY_)
      get_property(lines GLOBAL PROPERTY HAUSBENCH_${of}${list})
      list(JOIN lines "\n" lines)
      string(TOLOWER "${of}" folder)
      string(REPLACE _ / folder "${folder}")
      file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${folder}${file}.inc CONTENT "// Written by CMake: the lines hausbench_solver(...).\n${lines}\n")
    endforeach()
  endforeach()
endfunction()
