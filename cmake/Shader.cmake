find_program(GLSLANG glslangValidator REQUIRED)

# bodyopt_shaders(FOLDER SHADER...): compiles each shader into a header with an array of SPIR-V words, which the sources
# of the room at FOLDER include: x.comp is x.spv.h and x_spv, x.vert is x.vert.spv.h and x_vert_spv.
function(bodyopt_shaders FOLDER)
  bodyopt_target(${FOLDER} target)
  set(headers ${PROJECT_BINARY_DIR}/shaders)
  foreach(source ${ARGN})
    get_filename_component(name ${source} NAME)
    string(REGEX REPLACE "\\.comp$" "" name ${name})
    string(REPLACE "." "_" array ${name}_spv)
    set(output ${headers}/${name}.spv.h)
    add_custom_command(
      OUTPUT ${output}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${headers}
      COMMAND ${GLSLANG} --quiet -V --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR}/shaders/include
              --depfile ${output}.d --vn ${array} -o ${output} ${source}
      DEPENDS ${source}
      DEPFILE ${output}.d
      COMMENT "Compiling ${source}"
      VERBATIM)
    target_sources(${target} PRIVATE ${output})
  endforeach()
  target_include_directories(${target} PRIVATE ${headers})
endfunction()
