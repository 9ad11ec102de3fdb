# What our own sources are compiled with. The language goes on to whoever links a room; warnings stay with its sources:
# what third-party headers or a host's sources do is not our concern.
add_library(bodyopt_language INTERFACE)
target_compile_features(bodyopt_language INTERFACE cxx_std_20)
target_include_directories(bodyopt_language INTERFACE ${PROJECT_SOURCE_DIR})
# Eigen cuts sums into blocks by the size of the caches: as it takes them without asking the processor, so that what is
# learned has the same bits on all.
target_compile_definitions(bodyopt_language INTERFACE EIGEN_NO_CPUID)

add_library(bodyopt_flags INTERFACE)
# clang would tell of what shadows a name of another source that is compiled together with it.
target_compile_options(bodyopt_flags INTERFACE -Wall -Wextra -Wpedantic $<$<CXX_COMPILER_ID:GNU>:-Wshadow>
                       -Wnon-virtual-dtor -Werror)
# GCC 12 reports overlapping and overlong copies inside its own std::string (its bugs 105651 and 105329).
target_compile_options(bodyopt_flags INTERFACE
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict;-Wno-stringop-overflow;-Wno-array-bounds>)
# It would collect its garbage from 128 MB on, which takes a tenth of its time.
target_compile_options(bodyopt_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)
# GPU results are compared with CPU results: a multiply and an add stay two roundings on both.
target_compile_options(bodyopt_flags INTERFACE -ffp-contract=off)

option(BODYOPT_SANITIZE "Build with AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
if(BODYOPT_SANITIZE)
  target_compile_definitions(bodyopt_language INTERFACE BODYOPT_SANITIZED)
  target_compile_options(bodyopt_language INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all
                         -fno-omit-frame-pointer -O1)
  target_link_options(bodyopt_language INTERFACE -fsanitize=address,undefined)
  target_sources(bodyopt_language INTERFACE
                 $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${PROJECT_SOURCE_DIR}/cmake/sanitizers.cpp>)
endif()

option(BODYOPT_SANITIZE_THREADS "Build with ThreadSanitizer" OFF)
if(BODYOPT_SANITIZE_THREADS)
  target_compile_definitions(bodyopt_language INTERFACE BODYOPT_SANITIZED BODYOPT_SANITIZED_THREADS)
  target_compile_options(bodyopt_language INTERFACE -fsanitize=thread -fno-omit-frame-pointer -O1)
  target_link_options(bodyopt_language INTERFACE -fsanitize=thread)
  # Templates of oneTBB, whose library is not instrumented either.
  set_source_files_properties(${PROJECT_SOURCE_DIR}/runtime/threads/tbb_executor.cpp PROPERTIES
                              COMPILE_OPTIONS -fno-sanitize=thread)
endif()

option(BODYOPT_FUZZ "Build for libFuzzer, which clang brings" OFF)
if(BODYOPT_FUZZ)
  target_compile_options(bodyopt_language INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow)
endif()

# Links of the program and of two dozen test programs, at a tenth of the usual linker's price.
find_program(MOLD mold)
if(MOLD)
  # mold 1.10 begins the part that is read-only after relocation on an unmapped page where a thread's byte happens to end
  # the page before: such a program does not start.
  add_link_options(-fuse-ld=mold LINKER:-z,norelro)
endif()
