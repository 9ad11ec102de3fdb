# Hosts compile the runtime by clang, too: it reads the sources of these rooms with our warnings, without making code of
# them. Part of `all` where clang is there and another compiler builds.
function(bodyopt_check_by_clang)
  find_program(CLANG clang++)
  if(NOT CLANG OR NOT CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    return()
  endif()
  set(stamps "")
  foreach(folder ${ARGN})
    bodyopt_target(${folder} target)
    get_target_property(sources ${target} SOURCES)
    if(NOT folder STREQUAL runtime/cpu)  # its lanes include themselves again for each set of instructions
      list(TRANSFORM sources REPLACE "(.+)" "#include \"\\1\"")
      list(JOIN sources "\n" text)
      set(sources ${PROJECT_BINARY_DIR}/clang/${target}.cpp)
      file(CONFIGURE OUTPUT ${sources} CONTENT "${text}\n" @ONLY)
    endif()
    set(includes $<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>)
    set(definitions $<TARGET_PROPERTY:${target},COMPILE_DEFINITIONS>)
    foreach(source ${sources})
      cmake_path(GET source STEM name)
      set(stamp ${PROJECT_BINARY_DIR}/clang/${target}.${name}.checked)
      add_custom_command(
        OUTPUT ${stamp}
        COMMAND ${CLANG} -std=c++20 -fsyntax-only -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror
                "$<$<BOOL:${includes}>:-I$<JOIN:${includes},;-I>>" "$<$<BOOL:${definitions}>:-D$<JOIN:${definitions},;-D>>"
                -MD -MF ${stamp}.d -MT ${stamp} ${source}
        COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
        DEPENDS ${source} DEPFILE ${stamp}.d
        COMMENT "clang reads ${folder}: ${name}" COMMAND_EXPAND_LISTS VERBATIM)
      list(APPEND stamps ${stamp})
    endforeach()
  endforeach()
  add_custom_target(clang_check ALL DEPENDS ${stamps})
  foreach(folder ${ARGN})  # what is generated comes first
    bodyopt_target(${folder} target)
    add_dependencies(clang_check ${target})
  endforeach()
endfunction()
