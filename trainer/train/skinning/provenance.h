// How a basis was trained, as its metadata "provenance" have it (provenance_text()).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "runtime/basis/basis.h"
#include "trainer/train/options.h"

namespace bodyopt::trainer {

struct Provenance {
  std::string program;
  TrainOptions options;  // what is written of them; the others are the defaults
  bool updated = false;  // from an earlier training of other frames
};

// Nothing where no training of ours wrote any. What an earlier version did not write is the default. `origin`: the
// basis' file. Throws Error(file) for a value that no training writes.
std::optional<Provenance> read_provenance(const Metadata& metadata, const std::filesystem::path& origin);

// Adds the provenance of the basis that this one was transferred from, whoever wrote it.
void add_source(const Metadata& source, Metadata& metadata);

}  // namespace bodyopt::trainer
