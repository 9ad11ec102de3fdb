# A wheel of the module and the program. What it leaves to the system is what any desktop has: the C and C++ libraries, zlib
# and X11.
install_module(wheel bodyopt EXECUTABLES bodyopt
               "libtbb libhwy libxxhash libpugixml libspdlog libfmt libglfw libstb libspng libwebp libtinygltf \
libmeshoptimizer libsndfile libFLAC libogg libopus libvorbis libmpg123 libmp3lame")
# Netgen and what it brings find one another in a folder of their own, where drivers and other programs do not look.
set_target_properties(bodyopt PROPERTIES INSTALL_RPATH "$ORIGIN/../lib/netgen")
install(CODE "
  set(folder \${CMAKE_INSTALL_PREFIX}/bodyopt/program/lib/netgen)
  file(MAKE_DIRECTORY \${folder})
  file(GET_RUNTIME_DEPENDENCIES LIBRARIES ${netgen} RESOLVED_DEPENDENCIES_VAR libraries
       POST_EXCLUDE_REGEXES \"/(ld-linux.*|lib(c|m|gcc_s|stdc..|z|X11|xcb|Xau|Xdmcp|bsd|md))[.]so\")
  foreach(library ${netgen} \${libraries})
    get_filename_component(name \${library} NAME)
    file(REAL_PATH \${library} library)
    file(COPY_FILE \${library} \${folder}/\${name})
    execute_process(COMMAND patchelf --set-rpath \\$ORIGIN \${folder}/\${name} COMMAND_ERROR_IS_FATAL ANY)
    # Its licence goes with it. A package may name a file as it was before /lib went into /usr.
    string(REGEX REPLACE \"^/usr\" \"\" earlier \${library})
    execute_process(COMMAND dpkg-query -S \${library} \${earlier} OUTPUT_VARIABLE owners ERROR_QUIET)
    string(REGEX MATCH \"^[^:]+\" package \"\${owners}\")
    file(COPY /usr/share/doc/\${package}/copyright DESTINATION \${folder}/licences/\${package})
  endforeach()" COMPONENT wheel EXCLUDE_FROM_ALL)
set(staged ${PROJECT_BINARY_DIR}/wheel)
add_custom_target(wheel
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${staged}
  COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --component wheel --prefix ${staged}
  COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --component program --prefix ${staged}/bodyopt/program
  COMMAND ${Python_EXECUTABLE} ${PROJECT_SOURCE_DIR}/bindings/python/make_wheel.py ${staged} ${PROJECT_VERSION}
          ${PROJECT_BINARY_DIR}
  VERBATIM)
add_dependencies(wheel bodyopt bodyopt_python)
