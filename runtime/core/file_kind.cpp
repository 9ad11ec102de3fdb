#include "runtime/core/file_kind.h"

#include <algorithm>
#include <fstream>
#include <string_view>

#include "runtime/core/text.h"

namespace bodyopt {
namespace {

struct Kind {
  std::string_view told_by;  // the file's first bytes, or a name's end where files of the kind begin in many ways
  std::string_view name, way{};
};

constexpr std::string_view kByBlender = ": open it in Blender, and export glTF (of moving shapes MDD)",
                           kByFbx = ": export FBX from there (of moving shapes a point cache, MDD or PC2)",
                           kBySolving = ", without joints: solve them onto a skeleton, and export BVH or FBX",
                           kByAddOn = ": MotionBuilder or an add-on of Blender reads it and writes FBX or BVH";

// Kinds are looked for in this order: the least distinctive come last.
constexpr Kind kKinds[] = {
    {"glTF", "a binary glTF file (.glb)"},
    {"HIERARCHY", "a BVH file"},
    {"POINTCACHE2", "a PC2 point cache"},
    {"\x89PNG", "a picture"},
    {"\xff\xd8\xff", "a picture"},
    {"Kaydara FBX", "an FBX file"},
    {"; FBX", "an FBX file"},
    {"BLENDER", "a Blender file (.blend)", kByBlender},
    {".blend", "a Blender file (.blend), compressed", kByBlender},
    {"PXR-USDC", "a USD file", kByBlender},
    {"#usda", "a USD file", kByBlender},
    {".usdz", "a USD file", kByBlender},
    {"Ogawa", "an Alembic cache (.abc)", ": Blender and Houdini read it and write .mdd"},
    {"\x89HDF", "an Alembic cache (.abc)", ": Houdini reads it and writes .mdd"},
    {"//Maya ASCII", "a scene of Maya (.ma)", kByFbx},
    {".mb", "a scene of Maya (.mb)", kByFbx},
    {"\xd0\xcf\x11\xe0", "a scene of 3ds Max (.max)", kByFbx},
    {"070707", "a scene of Houdini (.hip)", kByFbx},
    {".uasset", "an asset of Unreal", kByFbx},
    {".c3d", "markers of motion capture (.c3d)", kBySolving},
    {"PathFileType", "markers of motion capture (.trc)", kBySolving},
    {".asf", "a skeleton of Acclaim (.asf)", kByAddOn},
    {".amc", "motion of Acclaim (.amc)", kByAddOn},
    {".obj", "an OBJ, a mesh without joints: bind it to some in Blender, and export glTF"},
    {"ply", "a PLY file", kByBlender},
    {".stl", "an STL file", kByBlender},
    {".3ds", "a 3DS file", kByBlender},
    {"version https://git-lfs", "a pointer of Git LFS, in the place of a file that was not fetched (git lfs pull)"},
    {"# ", "a text file, perhaps an OBJ"},
    {"<?xml", "an XML file"},
    {"{", "a JSON file"},
    {"<!DOCTYPE", "a web page"},
    {"<html", "a web page"},
    {"\x93NUMPY", "arrays of NumPy"},
    {".npz", "arrays of NumPy"},
    {"PK\x03\x04", "a ZIP archive"}};

std::string described(const Kind& kind) { return "; it looks like " + std::string(kind.name) + std::string(kind.way); }

}  // namespace

std::string looks_like(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return "";  // a pipe would make its reader wait
  std::ifstream file(path, std::ios::binary);
  std::string start(512, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  if (!file.is_open()) return "";
  if (start.empty()) return "; it is empty";
  if (start.find("<COLLADA") != std::string::npos) return described({"", "a COLLADA file (.dae)", kByBlender});
  const std::string extension = lower_case(path.extension().string());
  const auto kind = std::ranges::find_if(
      kKinds, [&](const Kind& k) { return start.starts_with(k.told_by) || extension == k.told_by; });
  if (kind != std::end(kKinds)) return described(*kind);
  // Eight bytes of header size, the upper ones zero, then JSON.
  if (start.size() > 8 && start[8] == '{' && start.substr(4, 4) == std::string(4, '\0'))
    return "; it looks like a safetensors file, as bases are";
  return "";
}

}  // namespace bodyopt
