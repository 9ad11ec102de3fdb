# Flags for our own targets only: what third-party headers do is not our concern.
add_library(bodyopt_flags INTERFACE)
target_compile_features(bodyopt_flags INTERFACE cxx_std_20)
target_compile_options(bodyopt_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Werror)
# GCC 12 reports overlapping copies inside its own std::string (its bug 105651).
target_compile_options(bodyopt_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# GPU results are compared with CPU results: a multiply and an add stay two roundings on both.
target_compile_options(bodyopt_flags INTERFACE -ffp-contract=off)
target_include_directories(bodyopt_flags INTERFACE ${PROJECT_SOURCE_DIR})

option(BODYOPT_SANITIZE "Build with AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
if(BODYOPT_SANITIZE)
  target_compile_definitions(bodyopt_flags INTERFACE BODYOPT_SANITIZED)
  target_compile_options(bodyopt_flags INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -O1)
  target_link_options(bodyopt_flags INTERFACE -fsanitize=address,undefined)
  target_sources(bodyopt_flags INTERFACE ${PROJECT_SOURCE_DIR}/cmake/sanitizers.cpp)
endif()

option(BODYOPT_FUZZ "Build for libFuzzer, which clang brings" OFF)
if(BODYOPT_FUZZ)
  target_compile_options(bodyopt_flags INTERFACE -fsanitize=fuzzer-no-link,float-cast-overflow)
endif()
