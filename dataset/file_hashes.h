// Which files a dataset is made of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/dataset.h"

namespace bodyopt {

struct HashedFile {
  std::string what;    // "character", "take 'rom': shapes"
  std::string path;    // as the dataset names it
  std::uint64_t xxh3;  // of its bytes
};

// Of every file that the dataset names, each once, in its order. Throws Error(file) where one cannot be read.
std::vector<HashedFile> hashed_files(const Dataset& dataset);

// xxh3 of a file's bytes. Throws Error(file).
std::uint64_t file_hash(const std::filesystem::path& path);

}  // namespace bodyopt
