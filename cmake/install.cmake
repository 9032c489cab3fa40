# Installs the command, the library with its headers, the shipped models, and what find_package(talus) needs.
include(CMakePackageConfigHelpers)
install(TARGETS talus EXPORT talusTargets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS talus_command RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY framework DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/talus FILES_MATCHING PATTERN "*.h" PATTERN "lua_*.h" EXCLUDE PATTERN "node_modules" EXCLUDE)
install(DIRECTORY models DESTINATION ${CMAKE_INSTALL_DATADIR}/talus)
install(FILES ${PROJECT_BINARY_DIR}/play.html DESTINATION ${CMAKE_INSTALL_DATADIR}/talus OPTIONAL)  # scripts/build page
set(talus_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/talus)
install(EXPORT talusTargets NAMESPACE talus:: DESTINATION ${talus_cmake_dir})
file(WRITE ${PROJECT_BINARY_DIR}/talusConfig.cmake "include(CMakeFindDependencyMacro)
find_dependency(Eigen3)
find_dependency(fmt)
include(\${CMAKE_CURRENT_LIST_DIR}/talusTargets.cmake)
include(\${CMAKE_CURRENT_LIST_DIR}/TalusAddPlugin.cmake)
")
write_basic_package_version_file(${PROJECT_BINARY_DIR}/talusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/talusConfig.cmake ${PROJECT_BINARY_DIR}/talusConfigVersion.cmake
              cmake/TalusAddPlugin.cmake DESTINATION ${talus_cmake_dir})
