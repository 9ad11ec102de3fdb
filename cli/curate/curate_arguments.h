// What the verbs below `curate` are told.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "trainer/curate/local_models.h"

namespace bodyopt::cli {

struct CurateArguments {
  std::string dataset, name, type, new_name, out, take, frames, list, mesh, picture;
  std::vector<std::string> settings, joints, muscles, regions, near_joints;
  double strength = 1, within = -1, degrees = kAlikeDegrees, spread = 30;
  int near = 0, frame = 0, worst = 10, heldout_every = 0;
  std::size_t place = 1;
  bool history = false, unposed = false, everywhere = false, whole_skin = false;
  JsonOption json;
};

using Arguments = std::shared_ptr<CurateArguments>;

// Of its dataset.json.
inline std::filesystem::path path_of(const CurateArguments& arguments) {
  const std::filesystem::path given = arguments.dataset;
  return given.extension() == ".json" ? given : given / "dataset.json";
}

}  // namespace bodyopt::cli
