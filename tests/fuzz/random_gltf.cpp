// Sound characters, each made of the number that the bytes are, and what is read of them beside a plain reader.
#include "tests/assets/random_gltf.h"

#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {"bodyopt!", "a number"}; }

void read(const std::string& bytes) {
  std::uint64_t seed = bytes.size();
  for (const char byte : bytes) seed = 1099511628211u * (seed ^ static_cast<unsigned char>(byte));
  const RandomGltf made(seed);
  const std::filesystem::path path = as_file("random.glb", made.blob.glb());
  std::string wrong;
  try {
    const Character character = read_character(path);
    wrong = made.what_is_wrong(character);
    const ClipOptions options{.fps = 1, .unit = character.unit};
    if (wrong.empty()) wrong = made.what_is_wrong(character, read_clip(path.string(), character.skeleton, options));
  } catch (const Error& error) {
    if (!made.may_be_refused()) wrong = error.what();
  }
  if (wrong.empty()) return;
  std::cerr << "WRONG: seed " << seed << ": " << wrong << '\n';
  std::abort();
}

const bool added = add_target({"random_gltf", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
