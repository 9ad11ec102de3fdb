// Sound FBX files, each made of the number that the bytes are, and what is read of them beside FBX's own formula.
#include "tests/assets/random_fbx.h"

#include <xxhash.h>

#include "assets/clips/gltf_clip.h"
#include "assets/gltf/gltf_file.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {"bodyopt!", "a number"}; }

void read(const std::string& bytes) {
  const auto seed = static_cast<unsigned>(XXH3_64bits(bytes.data(), bytes.size()));
  testing::WrittenFbx file = testing::FbxMaker(seed).limb(0.5);
  if (file.curves.size() > 2) file.curves.resize(2);  // a curve costs most of the time
  const std::string text = seed % 2 == 0 ? file.text() : file.binary(seed % 4 == 1 ? 7400 : 7700, seed % 3 == 0);
  const std::filesystem::path path = as_file("random.fbx", text);
  const GltfFile converted(path);
  const Character character = read_character(converted);
  const Clip clip = read_gltf_clip(converted, "", [&](const std::set<std::string>&) { return character.skeleton; }, {});
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const double seconds = file.begin + static_cast<double>(k) / clip.fps,
                 metres = testing::off(file, character, clip.poses[k], seconds);
    if (metres < 2e-4) continue;
    std::cerr << "WRONG: seed " << seed << ": " << metres << " m off at " << seconds << " s\n";
    std::abort();
  }
}

const bool added = add_target({"random_fbx", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
