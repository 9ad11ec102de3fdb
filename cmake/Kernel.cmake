# bodyopt_kernel(NAME): a compute kernel is four files with one name. Stops the configuration, naming the missing one,
# unless all are there, and compiles the shader into a header: <kernel_include>/NAME.spv.h, array NAME_spv.
set(BODYOPT_SHADER_DIR ${PROJECT_BINARY_DIR}/shaders)
find_program(GLSLANG glslangValidator REQUIRED)

# compile_shader(SOURCE OUTPUT ARRAY): GLSL to a C++ header that holds SPIR-V words.
function(compile_shader SOURCE OUTPUT ARRAY)
  add_custom_command(
    OUTPUT ${OUTPUT}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${BODYOPT_SHADER_DIR}
    COMMAND ${GLSLANG} --quiet -V --target-env vulkan1.2 -I${PROJECT_SOURCE_DIR}/shaders/include
            --depfile ${OUTPUT}.d --vn ${ARRAY} -o ${OUTPUT} ${SOURCE}
    DEPENDS ${SOURCE}
    DEPFILE ${OUTPUT}.d
    COMMENT "Compiling ${SOURCE}"
    VERBATIM)
endfunction()

function(bodyopt_kernel NAME)
  set(files shaders/${NAME}.comp runtime/cpu/${NAME}.cpp runtime/vulkan/${NAME}.cpp tests/kernels/${NAME}_test.cpp)
  foreach(file ${files})
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${file})
      message(FATAL_ERROR "kernel ${NAME}: ${file} is missing (a kernel is four files: ${files})")
    endif()
  endforeach()
  set(header ${BODYOPT_SHADER_DIR}/${NAME}.spv.h)
  compile_shader(${PROJECT_SOURCE_DIR}/shaders/${NAME}.comp ${header} ${NAME}_spv)
  target_sources(bodyopt_runtime PRIVATE runtime/cpu/${NAME}.cpp runtime/vulkan/${NAME}.cpp ${header})
  set_property(GLOBAL APPEND PROPERTY BODYOPT_KERNEL_TESTS ${PROJECT_SOURCE_DIR}/tests/kernels/${NAME}_test.cpp)
endfunction()
