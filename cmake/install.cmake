# Installs the package of find_package(hausbench), whose parts hausbenchConfig.cmake.in lists, the files that the program reads at run time, and the
# documents.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(HAUSBENCH_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/hausbench)
set(HAUSBENCH_PARTS plugin)
install(TARGETS hausbench_algorithms hausbench_text EXPORT hausbench_plugin ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(HAUSBENCH_WITH_LIBRARY)
  list(APPEND HAUSBENCH_PARTS c)
  install(TARGETS hausbench_c EXPORT hausbench_c LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(FILES library/hausbench.h library/hausbench.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  file(RELATIVE_PATH HAUSBENCH_PREFIX_FROM_PC ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})  # installed files may be moved
  configure_file(library/hausbench.pc.in ${PROJECT_BINARY_DIR}/generated/hausbench.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/generated/hausbench.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
if(HAUSBENCH_WITH_PROGRAM)
  list(APPEND HAUSBENCH_PARTS program)
  install(TARGETS hausbench EXPORT hausbench_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(FILES ${PROJECT_BINARY_DIR}/hausbench.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${PROJECT_BINARY_DIR}/hausbench.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME hausbench)
  install(FILES ${PROJECT_BINARY_DIR}/commit.json DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench)
  install(FILES datasets/manifest.toml datasets/corpus.toml datasets/fetch.py datasets/packages.py datasets/letters.py
    DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench/datasets)
  install(DIRECTORY analysis DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench
    FILES_MATCHING PATTERN "*.py" PATTERN "*.mplstyle" PATTERN "*.toml" PATTERN "__pycache__" EXCLUDE)
  install(DIRECTORY docs/tour experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench PATTERN "__pycache__" EXCLUDE)
endif()
# Documents keep their folders, so that the links between them stay valid.
file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS algorithms/*.md docs/*.md docs/*.ipynb docs/*.png docs/*.svg library/examples/* results/reference/*.md)
foreach(page IN LISTS pages ITEMS library/hausbench.h library/hausbench.hpp README.md CONTRIBUTING.md CHANGELOG.md LICENSE CITATION.cff packages.txt results/README.md)
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
# Headers that solvers share, without those in the folders of single solvers. They include each other as <hausbench/...>. Written to a folder of a random
# name, so that one build can be installed twice at the same time.
install(CODE "
  string(RANDOM name)
  set(written ${PROJECT_BINARY_DIR}/generated/\${name})
  foreach(folder . certificate kernel search session structures)
    file(GLOB headers RELATIVE ${PROJECT_SOURCE_DIR}/algorithms ${PROJECT_SOURCE_DIR}/algorithms/\${folder}/*.h)
    foreach(header IN LISTS headers)
      file(READ ${PROJECT_SOURCE_DIR}/algorithms/\${header} text)
      string(REGEX REPLACE \"#include \\\"algorithms/([^\\\"]+)\\\"\" \"#include <hausbench/\\\\1>\" text \"\${text}\")
      file(WRITE \${written}/hausbench/\${header} \"\${text}\")
    endforeach()
  endforeach()
  file(INSTALL \${written}/hausbench DESTINATION \${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR})
  file(REMOVE_RECURSE \${written})")
foreach(part IN LISTS HAUSBENCH_PARTS)
  install(EXPORT hausbench_${part} NAMESPACE hausbench:: DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
endforeach()
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/hausbenchConfig.cmake.in ${PROJECT_BINARY_DIR}/generated/hausbenchConfig.cmake
  INSTALL_DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/hausbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/hausbenchConfig.cmake ${PROJECT_BINARY_DIR}/generated/hausbenchConfigVersion.cmake
  DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
