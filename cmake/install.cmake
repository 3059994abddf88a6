# Installs the package that plug-ins are built with (find_package(hausbench), see CONTRIBUTING.md), the files that the program reads at run time, and
# the documents.
include(CMakePackageConfigHelpers)
set(HAUSBENCH_PACKAGE_FOLDER ${CMAKE_INSTALL_LIBDIR}/cmake/hausbench)
install(TARGETS hausbench_algorithms hausbench_text EXPORT hausbench_targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
if(HAUSBENCH_WITH_PROGRAM)
  install(TARGETS hausbench EXPORT hausbench_targets RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(FILES ${CMAKE_BINARY_DIR}/hausbench.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  install(FILES ${CMAKE_BINARY_DIR}/hausbench.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME hausbench)
  install(FILES ${CMAKE_BINARY_DIR}/commit.json DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench)
  install(FILES datasets/manifest.toml datasets/corpus.toml datasets/fetch.py datasets/packages.py datasets/letters.py
    DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench/datasets)
  install(DIRECTORY analysis DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench
    FILES_MATCHING PATTERN "*.py" PATTERN "*.mplstyle" PATTERN "*.toml" PATTERN "__pycache__" EXCLUDE)
  install(DIRECTORY docs/tour experiments DESTINATION ${CMAKE_INSTALL_DATADIR}/hausbench PATTERN "__pycache__" EXCLUDE)
endif()
# Documents keep their folders, so that the links between them stay valid.
file(GLOB_RECURSE pages RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS algorithms/*.md docs/*.md docs/*.ipynb docs/*.png docs/*.svg library/examples/* results/reference/*.md)
foreach(page IN LISTS pages ITEMS library/hausbench.h README.md CONTRIBUTING.md CHANGELOG.md LICENSE CITATION.cff packages.txt results/README.md)
  cmake_path(GET page PARENT_PATH folder)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder})
endforeach()
# Headers that solvers share, without those in the folders of single solvers. They include each other as <hausbench/...>.
set(HAUSBENCH_HEADERS ${CMAKE_BINARY_DIR}/generated/include/hausbench)
install(CODE "
  file(REMOVE_RECURSE ${HAUSBENCH_HEADERS})
  foreach(folder . certificate kernel search session structures)
    file(GLOB headers RELATIVE ${PROJECT_SOURCE_DIR}/algorithms ${PROJECT_SOURCE_DIR}/algorithms/\${folder}/*.h)
    foreach(header IN LISTS headers)
      file(READ ${PROJECT_SOURCE_DIR}/algorithms/\${header} text)
      string(REGEX REPLACE \"#include \\\"algorithms/([^\\\"]+)\\\"\" \"#include <hausbench/\\\\1>\" text \"\${text}\")
      file(WRITE ${HAUSBENCH_HEADERS}/\${header} \"\${text}\")
    endforeach()
  endforeach()")
install(DIRECTORY ${HAUSBENCH_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT hausbench_targets NAMESPACE hausbench:: FILE hausbenchTargets.cmake DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/hausbenchConfig.cmake.in ${CMAKE_BINARY_DIR}/generated/hausbenchConfig.cmake
  INSTALL_DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/hausbenchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/hausbenchConfig.cmake ${CMAKE_BINARY_DIR}/generated/hausbenchConfigVersion.cmake
  DESTINATION ${HAUSBENCH_PACKAGE_FOLDER})
