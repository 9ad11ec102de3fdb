// What fuzz targets share. A target is a reader of bytes from outside and some sound bytes to begin with.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "runtime/basis/safetensors.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::fuzz {

struct FuzzTarget {
  std::string name;
  std::vector<std::string> (*seeds)();
  // May throw Error(file), Error(mismatch) and Error(usage), which is how readers refuse. Anything else is a finding.
  void (*read)(const std::string& bytes);
  int most_mib = 64;  // allocated at once, for each KiB of the bytes begun
};

std::vector<FuzzTarget>& targets();
inline bool add_target(FuzzTarget target) {
  targets().push_back(std::move(target));
  return true;
}

// A file with these bytes, in a folder of this process.
std::filesystem::path as_file(const std::string& name, const std::string& bytes);
// The bytes that `write` leaves at the path it is given.
template <typename Write>
std::string written(const std::string& name, Write write) {
  const std::filesystem::path path = as_file(name, "");
  std::filesystem::remove(path);
  write(path);
  return testing::read_bytes(path);
}

// The file with the checksum that its content has: the bytes behind it would never be read else. As it is where it is
// no safetensors file.
std::string with_checksum(const std::string& bytes);

// What a reader accepts is finite.
template <typename Numbers>
void require_finite(const Numbers& numbers, const char* what) {
  for (const auto number : numbers) {
    if (std::isfinite(number)) continue;
    std::cerr << "NaN: accepted, though not finite: " << what << '\n';
    std::abort();
  }
}

}  // namespace bodyopt::fuzz
