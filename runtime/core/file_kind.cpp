#include "runtime/core/file_kind.h"

#include <fstream>
#include <utility>

namespace bodyopt {

std::string looks_like(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string start(512, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  if (!file.is_open() || std::filesystem::is_directory(path)) return "";
  if (start.empty()) return "; it is empty";
  const std::pair<const char*, const char*> kinds[] = {
      {"glTF", "a binary glTF file (.glb)"},
      {"HIERARCHY", "a BVH file"},
      {"POINTCACHE2", "a PC2 point cache"},
      {"\x89PNG", "a picture"},
      {"\xff\xd8\xff", "a picture"},
      {"<?xml", "an XML file"},
      {"{", "a JSON file"},
      {"Kaydara FBX", "an FBX file"},
      {"; FBX", "an FBX file"},
      {"BLENDER", "a Blender file"},
      {"PXR-USDC", "a USD file"},
      {"#usda", "a USD file"},
      {"Ogawa", "an Alembic cache (.abc): Blender and Houdini read it and write .mdd"},
      {"\x89HDF", "an Alembic cache (.abc): Houdini reads it and writes .mdd"},
      {"# ", "a text file, perhaps an OBJ"},
      {"version https://git-lfs", "a pointer of Git LFS, in the place of a file that was not fetched (git lfs pull)"},
      {"<!DOCTYPE", "a web page"},
      {"<html", "a web page"},
      {"PK\x03\x04", "a ZIP archive"}};
  if (start.find("<COLLADA") != std::string::npos) return "; it looks like a COLLADA file (.dae)";
  for (const auto& [magic, kind] : kinds) {
    if (start.starts_with(magic)) return std::string("; it looks like ") + kind;
  }
  // Eight bytes of header size, the upper ones zero, then JSON.
  if (start.size() > 8 && start[8] == '{' && start.substr(4, 4) == std::string(4, '\0'))
    return "; it looks like a safetensors file, as bases are";
  return "";
}

}  // namespace bodyopt
