#include "dataset/file_hashes.h"

#include <xxhash.h>

#include <array>
#include <fstream>
#include <memory>
#include <set>

#include "assets/clip_source.h"
#include "runtime/core/error.h"

namespace bodyopt {

std::uint64_t file_hash(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::array<char, 1 << 16> bytes;
  while (file.read(bytes.data(), bytes.size()) || file.gcount() > 0) {
    XXH3_64bits_update(state.get(), bytes.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw Error(ErrorKind::file, path, ": cannot be read: it is not there, or damaged");
  return XXH3_64bits_digest(state.get());
}

namespace {

// As the take names it, without the name of a clip within.
std::string clip_file(const Dataset& dataset, const DatasetTake& take) {
  const std::string source = (dataset.folder / take.clip).string();
  return take.clip.substr(0, take.clip.size() - (source.size() - split_source(source).path.string().size()));
}

}  // namespace

std::vector<HashedFile> hashed_files(const Dataset& dataset) {
  std::vector<HashedFile> files;
  std::set<std::string> known;
  const auto add = [&](const std::string& what, const std::string& path) {
    if (!path.empty() && known.insert(path).second) files.push_back({what, path, file_hash(dataset.folder / path)});
  };
  add("character", dataset.character);
  add("muscles", dataset.muscles);
  add("materials", dataset.materials);
  add("corrections", dataset.corrections);
  add("regions", dataset.regions);
  for (const DatasetTake& take : dataset.takes) {
    const std::string of_take = "take '" + take.name + "': ";
    add(of_take + "clip", clip_file(dataset, take));
    add(of_take + "controls", take.controls);
    add(of_take + "joint map", take.joint_map);
    add(of_take + "shapes", take.shapes);
    add(of_take + "side-car", take.shapes_status);
  }
  return files;
}

}  // namespace bodyopt
