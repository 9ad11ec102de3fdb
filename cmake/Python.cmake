# The Python module, for the system's Python: bindings/python/bodyopt and, in it, the compiled _runtime.
if(EXISTS /usr/bin/python3)
  set(Python_EXECUTABLE /usr/bin/python3 CACHE FILEPATH "The Python that the module is for")
endif()
find_package(Python 3.9 QUIET COMPONENTS Interpreter Development)
if(Python_FOUND)
  set(PYBIND11_FINDPYTHON ON)
  find_package(pybind11 2.10 CONFIG QUIET)
endif()
set(default OFF)
if(pybind11_FOUND AND NOT BODYOPT_SANITIZE AND NOT BODYOPT_SANITIZE_THREADS)  # Python itself is not sanitized
  set(default ON)
endif()
option(BODYOPT_BUILD_PYTHON "Build the Python module" ${default})
if(NOT BODYOPT_BUILD_PYTHON)
  return()
endif()
find_package(pybind11 2.10 CONFIG REQUIRED)

pybind11_add_module(bodyopt_python MODULE NO_EXTRAS bindings/python/module.cpp)
target_link_libraries(bodyopt_python PRIVATE bodyopt_language bodyopt_flags bodyopt_shared)
execute_process(COMMAND ${Python_EXECUTABLE} -c "import sysconfig; print(sysconfig.get_path('platlib'))"
                OUTPUT_VARIABLE modules OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "lib[0-9]*/python.*$" modules ${modules})  # below the prefix
set_target_properties(bodyopt_python PROPERTIES OUTPUT_NAME _runtime
                      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python
                      INSTALL_RPATH "$ORIGIN;$ORIGIN/../../../../${CMAKE_INSTALL_LIBDIR}")
install(TARGETS bodyopt_python COMPONENT library DESTINATION ${modules}/bodyopt)
install(DIRECTORY bindings/python/bodyopt COMPONENT library DESTINATION ${modules})

# The module, its library and what TARGETS are linked with, in FOLDER of a component.
set_target_properties(bodyopt_shared PROPERTIES BUILD_RPATH $ORIGIN)
function(install_module COMPONENT FOLDER KIND TARGET LIBRARIES)
  install(DIRECTORY bindings/python/bodyopt/ COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL DESTINATION ${FOLDER}
          PATTERN __pycache__ EXCLUDE)
  install(TARGETS bodyopt_python COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL DESTINATION ${FOLDER})
  install(PROGRAMS $<TARGET_FILE:bodyopt_shared> COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL DESTINATION ${FOLDER}
          RENAME $<TARGET_SONAME_FILE_NAME:bodyopt_shared>)  # archives have no links
  install(CODE "
    file(GET_RUNTIME_DEPENDENCIES ${KIND} $<TARGET_FILE:${TARGET}> RESOLVED_DEPENDENCIES_VAR libraries
         PRE_INCLUDE_REGEXES ${LIBRARIES} PRE_EXCLUDE_REGEXES .*)
    foreach(library \${libraries})
      get_filename_component(name \${library} NAME)
      file(REAL_PATH \${library} library)
      file(COPY_FILE \${library} \${CMAKE_INSTALL_PREFIX}/${FOLDER}/\${name})
    endforeach()" COMPONENT ${COMPONENT} EXCLUDE_FROM_ALL)
endfunction()

# The Blender add-on as a zip.
set(addon bodyopt_blender)
install(DIRECTORY bindings/blender/${addon} COMPONENT blender EXCLUDE_FROM_ALL DESTINATION . PATTERN __pycache__ EXCLUDE)
install_module(blender ${addon}/bodyopt LIBRARIES bodyopt_shared "libtbb libhwy libxxhash")
set(staged ${PROJECT_BINARY_DIR}/blender)
add_custom_target(blender_addon
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${staged}
  COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --component blender --prefix ${staged}
  COMMAND ${CMAKE_COMMAND} -E chdir ${staged}
          ${CMAKE_COMMAND} -E tar cf ${PROJECT_BINARY_DIR}/${addon}.zip --format=zip ${addon}
  VERBATIM)
add_dependencies(blender_addon bodyopt_python)
