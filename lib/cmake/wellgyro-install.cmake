# Installs the libraries with a CMake package (components fit, lcm, c) and pkg-config files.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/wellgyro)

function(wellgyro_install target exported)
  install(TARGETS ${target} EXPORT ${target}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT ${target} NAMESPACE wellgyro:: DESTINATION ${package_dir}
    FILE ${exported}-targets.cmake)
endfunction()

# wellgyro_pkgconfig(name "what it is" REQUIRES ... PRIVATE ... LIBS ...)
function(wellgyro_pkgconfig name description)
  cmake_parse_arguments(PC "" "LIBS_PRIVATE" "REQUIRES;REQUIRES_PRIVATE" ${ARGN})
  # Relative, so that the installed tree may be moved.
  file(RELATIVE_PATH PC_UP /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  set(PC_NAME ${name})
  set(PC_DESCRIPTION ${description})
  list(JOIN PC_REQUIRES " " PC_REQUIRES)
  list(JOIN PC_REQUIRES_PRIVATE " " PC_REQUIRES_PRIVATE)
  configure_file(${PROJECT_SOURCE_DIR}/lib/cmake/wellgyro.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

# No ABI is promised from one minor version to the next: each has a soname of its own.
set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set_target_properties(wellgyro PROPERTIES VERSION ${PROJECT_VERSION}
  SOVERSION ${soversion})
wellgyro_install(wellgyro wellgyro)
wellgyro_pkgconfig(wellgyro "Gyro wellbore surveying"
  REQUIRES eigen3 REQUIRES_PRIVATE geographiclib fmt tomlplusplus pugixml libcrypto sqlite3 yaml-cpp
    proj libzip)
if(TARGET wellgyro-fit)
  set_target_properties(wellgyro-fit PROPERTIES VERSION ${PROJECT_VERSION}
  SOVERSION ${soversion})
  wellgyro_install(wellgyro-fit wellgyro-fit)
  wellgyro_pkgconfig(wellgyro-fit "Fits of wellgyro, with Ceres"
    REQUIRES wellgyro LIBS_PRIVATE "-lceres -lglog")
endif()
if(TARGET wellgyro-c)
  wellgyro_install(wellgyro-c wellgyro-c)
  wellgyro_pkgconfig(wellgyro_c "wellgyro for C")
endif()
if(TARGET wellgyro-lcm)
  set_target_properties(wellgyro-lcm PROPERTIES VERSION ${PROJECT_VERSION}
  SOVERSION ${soversion})
  wellgyro_install(wellgyro-lcm wellgyro-lcm)
  wellgyro_pkgconfig(wellgyro-lcm "wellgyro on LCM" REQUIRES wellgyro LIBS_PRIVATE "-llcm")
endif()

get_target_property(wellgyro_type wellgyro TYPE)
string(COMPARE EQUAL ${wellgyro_type} STATIC_LIBRARY WELLGYRO_STATIC)
configure_package_config_file(cmake/wellgyro-config.cmake.in wellgyro-config.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(wellgyro-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/wellgyro-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/wellgyro-config-version.cmake
  cmake/wellgyro-geographiclib.cmake cmake/FindLCM.cmake
  DESTINATION ${package_dir})
# Where Debian has the licence of a package.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)
