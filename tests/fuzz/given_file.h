// Files that only the trainer makes, of which none is built for fuzzers: the stage of the attack
// (tests/attack/write_stage.cpp) has them. BODYOPT_FUZZ_FILES names the folder.
#pragma once

#include "runtime/basis/dynamics.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {

inline std::filesystem::path given_file(const std::string& name) {
  const char* const folder = std::getenv("BODYOPT_FUZZ_FILES");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : ".") / name;
  if (std::filesystem::exists(path)) return path;
  std::cerr << path << " is not there: BODYOPT_FUZZ_FILES is the folder of what the stage writes for fuzzers\n";
  std::exit(64);
}

// A body of one tetrahedron.
inline const Basis& tet_basis() {
  static const Basis basis = load_basis(given_file("tet.safetensors"));
  return basis;
}
inline const Dynamics& tet_dynamics() {
  static const Dynamics dynamics = load_dynamics(given_file("tet.dynamics.safetensors"), tet_basis());
  return dynamics;
}

}  // namespace bodyopt::fuzz
