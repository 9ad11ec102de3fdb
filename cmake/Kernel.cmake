# A compute kernel is three files with one name: the shader, its reference on the CPU, its test. Stops the configuration,
# naming the missing one, unless all are there.
file(GLOB kernel_shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/kernels/*.comp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${kernel_shaders})
set(BODYOPT_KERNELS "")
foreach(shader ${kernel_shaders})
  get_filename_component(kernel ${shader} NAME_WE)
  list(APPEND BODYOPT_KERNELS ${kernel})
endforeach()

foreach(file runtime/cpu/@.cpp tests/kernels/@_test.cpp)
  foreach(kernel ${BODYOPT_KERNELS})
    string(REPLACE "@" ${kernel} path ${file})
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${path})
      message(FATAL_ERROR "${path} is missing: a kernel is shaders/kernels/${kernel}.comp, runtime/cpu/${kernel}.cpp, "
                          "and tests/kernels/${kernel}_test.cpp")
    endif()
  endforeach()
endforeach()

# What a kernel's shader declares, as C++ for runtime/vulkan/kernels/shader_kernel.h: its bindings by name, which of them
# it writes, what it is pushed, and the line "// Threads: EXPRESSION" over `push`.
function(bodyopt_describe_kernel SHADER DECLARATION BINDING_COUNT)
  get_filename_component(kernel ${SHADER} NAME_WE)
  file(READ ${SHADER} text)
  string(REGEX MATCH "Constants { ([A-Za-z]+) push; }" found "${text}")
  set(push ${CMAKE_MATCH_1})
  string(REGEX MATCH "// Threads: ([^\n;]+)" found "${text}")
  set(threads ${CMAKE_MATCH_1})
  if(NOT push OR NOT threads)
    message(FATAL_ERROR "${SHADER}: expected 'uniform Constants { <Name>Push push; }' and a line '// Threads: <how many>'")
  endif()
  string(REGEX MATCHALL "binding = [0-9]+\\)[a-z ]* buffer B[0-9]+ { [A-Za-z0-9]+ [a-z_]+" buffers "${text}")
  set(names "")
  set(written 0)  # bits
  foreach(buffer ${buffers})
    string(REGEX MATCH "binding = ([0-9]+).* ([a-z_]+)$" found ${buffer})
    list(LENGTH names count)
    if(NOT CMAKE_MATCH_1 EQUAL count)
      message(FATAL_ERROR "${SHADER}: expected binding ${count}, found: ${buffer}")
    endif()
    list(APPEND names ${CMAKE_MATCH_2})
    if(NOT buffer MATCHES " readonly ")  # writeonly, or changed in place
      math(EXPR written "${written} | 1 << ${count}")
    endif()
  endforeach()
  list(LENGTH names count)
  list(JOIN names ", " fields)
  list(TRANSFORM names PREPEND "buffers.")
  list(JOIN names ", " ranges)
  set(takes_frames false)
  if(text MATCHES "constant_id = 0\\) const uint kFrames = 1;")
    set(takes_frames true)
  endif()
  set(class "")
  string(REPLACE "_" ";" words ${kernel})
  foreach(word ${words})
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND class ${first}${rest})
  endforeach()
  set(${BINDING_COUNT} ${count} PARENT_SCOPE)
  set(${DECLARATION} "
struct ${class}Shader {
  using Push = ${push};
  struct Buffers {
    BufferRange ${fields};
  };
  static std::array<BufferRange, ${count}> ranges(const Buffers& buffers) { return {${ranges}}; }
  static constexpr std::uint32_t written = ${written};
  static constexpr bool takes_frames = ${takes_frames};
  static std::uint32_t threads([[maybe_unused]] const Push& push) { return ${threads}; }
  static std::span<const std::uint32_t> spirv();
};
using ${class} = ShaderKernel<${class}Shader>;
" PARENT_SCOPE)
endfunction()

# runtime/vulkan/kernels/kernels.h and .cpp in the build folder: a ShaderKernel for each shader.
set(BODYOPT_GENERATED ${PROJECT_BINARY_DIR}/generated)
set(BODYOPT_MOST_BINDINGS 0)  # of any kernel: a device with fewer is refused
set(declarations "")
set(includes "")
set(definitions "")
foreach(shader kernel IN ZIP_LISTS kernel_shaders BODYOPT_KERNELS)
  bodyopt_describe_kernel(${shader} declaration count)
  string(APPEND declarations "${declaration}")
  string(APPEND includes "#include \"${kernel}.spv.h\"\n")
  string(REGEX MATCH "struct ([A-Za-z]+)" found "${declaration}")
  string(APPEND definitions
         "std::span<const std::uint32_t> ${CMAKE_MATCH_1}::spirv() { return ${kernel}_spv; }\n")
  if(count GREATER 8)  # the storage buffers that WebGPU, and so nearly any device, has at the least
    message(FATAL_ERROR "${shader} binds ${count} buffers, at most 8 are portable: join some of them")
  endif()
  if(count GREATER BODYOPT_MOST_BINDINGS)
    set(BODYOPT_MOST_BINDINGS ${count})
  endif()
endforeach()
set(folder runtime/vulkan/kernels)
file(CONFIGURE OUTPUT ${BODYOPT_GENERATED}/${folder}/kernels.h @ONLY CONTENT "// Made by cmake/Kernel.cmake.
#pragma once

#include <array>

#include \"${folder}/shader_kernel.h\"
#include \"shaders/include/attach.h\"
#include \"shaders/include/jiggle.h\"
#include \"shaders/include/layout.h\"

namespace bodyopt::vulkan {
${declarations}
}  // namespace bodyopt::vulkan
")
file(CONFIGURE OUTPUT ${BODYOPT_GENERATED}/${folder}/kernels.cpp @ONLY CONTENT "// Made by cmake/Kernel.cmake.
#include \"${folder}/kernels.h\"

${includes}
namespace bodyopt::vulkan {

${definitions}
}  // namespace bodyopt::vulkan
")
