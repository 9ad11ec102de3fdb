// A character as .gltf, its buffers inside it as base64.
#include "assets/characters/character.h"
#include "tests/assets/gltf_blob.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::string base64(const std::string& bytes) {
  const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k + 2 < bytes.size(); k += 3) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[k + i])); };
    const unsigned word = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (const int shift : {18, 12, 6, 0}) text += digits[word >> shift & 63];
  }
  return text;
}

std::vector<std::string> seeds() {
  GltfBlob blob = two_joint_square();
  blob.binary.resize((blob.binary.size() + 2) / 3 * 3, '\0');
  blob.root["buffers"] = {
      {{"byteLength", blob.binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(blob.binary)}}};
  return {blob.root.dump()};
}

void read(const std::string& bytes) { read_character(as_file("character.gltf", bytes), 0.1); }

const bool added = add_target({"gltf_text", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
