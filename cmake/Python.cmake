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
                      INSTALL_RPATH $ORIGIN/../../../../${CMAKE_INSTALL_LIBDIR})
install(TARGETS bodyopt_python COMPONENT library DESTINATION ${modules}/bodyopt)
install(DIRECTORY bindings/python/bodyopt COMPONENT library DESTINATION ${modules})
