# The library that a host program links, shared and static, of the objects of the rooms of runtime/, and what
# `cmake --install --component library` makes of it: headers, libraries, CMake package, pkg-config file. Only what
# bodyopt.h declares can be seen from outside.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(objects "")
foreach(folder ${runtime_rooms})
  bodyopt_target(${folder} target)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
                                             VISIBILITY_INLINES_HIDDEN ON)
  list(APPEND objects $<TARGET_OBJECTS:${target}>)
endforeach()

foreach(kind shared static)
  string(TOUPPER ${kind} KIND)
  add_library(bodyopt_${kind} ${KIND} ${objects})
  add_library(bodyopt::${kind} ALIAS bodyopt_${kind})
  target_link_libraries(bodyopt_${kind} PRIVATE TBB::tbb hwy::hwy ${CMAKE_DL_LIBS} ${XXHASH})
  target_include_directories(bodyopt_${kind} INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                       $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  set_target_properties(bodyopt_${kind} PROPERTIES OUTPUT_NAME bodyopt EXPORT_NAME ${kind} LINKER_LANGUAGE CXX)
  install(TARGETS bodyopt_${kind} EXPORT bodyopt_${kind} COMPONENT library
          LIBRARY NAMELINK_COMPONENT library)
  install(EXPORT bodyopt_${kind} NAMESPACE bodyopt:: FILE bodyopt_${kind}.cmake COMPONENT library
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodyopt)
endforeach()
set_target_properties(bodyopt_shared PROPERTIES VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
                                                LINK_DEPENDS ${PROJECT_SOURCE_DIR}/cmake/bodyopt.map)
target_link_libraries(bodyopt_static INTERFACE stdc++)  # for programs of C alone
target_link_options(bodyopt_shared PRIVATE -Wl,--version-script=${PROJECT_SOURCE_DIR}/cmake/bodyopt.map)
if(NOT BODYOPT_SANITIZE AND NOT BODYOPT_SANITIZE_THREADS)
  target_link_options(bodyopt_shared PRIVATE -Wl,--no-undefined)  # sanitizers leave theirs to the program
else()
  target_link_libraries(bodyopt_shared PRIVATE bodyopt_language)
endif()

configure_package_config_file(cmake/bodyoptConfig.cmake.in ${PROJECT_BINARY_DIR}/bodyoptConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodyopt)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/bodyoptConfigVersion.cmake COMPATIBILITY SameMajorVersion)
file(RELATIVE_PATH BODYOPT_PREFIX_FROM_PC /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/bodyopt.pc.in bodyopt.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/bodyoptConfig.cmake ${PROJECT_BINARY_DIR}/bodyoptConfigVersion.cmake
        COMPONENT library DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/bodyopt)
install(FILES ${PROJECT_BINARY_DIR}/bodyopt.pc COMPONENT library DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(DIRECTORY include/bodyopt COMPONENT library DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
