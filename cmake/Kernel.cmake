# A compute kernel is four files with one name: the shader, its reference on the CPU, its dispatch, its test. Stops the
# configuration, naming the missing one, unless all are there.
file(GLOB kernel_shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/kernels/*.comp)
set(BODYOPT_KERNELS "")
foreach(shader ${kernel_shaders})
  get_filename_component(kernel ${shader} NAME_WE)
  list(APPEND BODYOPT_KERNELS ${kernel})
endforeach()

foreach(file runtime/cpu/@.cpp runtime/vulkan/kernels/@.cpp tests/kernels/@_test.cpp)
  foreach(kernel ${BODYOPT_KERNELS})
    string(REPLACE "@" ${kernel} path ${file})
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${path})
      message(FATAL_ERROR "${path} is missing: a kernel is shaders/kernels/${kernel}.comp, runtime/cpu/${kernel}.cpp, "
                          "runtime/vulkan/kernels/${kernel}.cpp, and tests/kernels/${kernel}_test.cpp")
    endif()
  endforeach()
endforeach()

# The most storage buffers of any kernel: a device with fewer is refused.
set(BODYOPT_MOST_BINDINGS 0)
foreach(shader ${kernel_shaders})
  file(STRINGS ${shader} buffers REGEX "binding = [0-9]+\\).* buffer ")
  list(LENGTH buffers count)
  if(count GREATER BODYOPT_MOST_BINDINGS)
    set(BODYOPT_MOST_BINDINGS ${count})
  endif()
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${kernel_shaders})
