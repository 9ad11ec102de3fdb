#include "assets/clips/gltf_cameras.h"

#include <algorithm>
#include <set>

#include "assets/clips/clip_source.h"
#include "assets/gltf/gltf_nodes.h"
#include "base/json_file.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMost = 100;  // of a file
constexpr double kFurthest = 1e5;   // metres from the origin

// How it sees. Throws Error(file).
ClipCamera lens_of(const JsonObject& camera, double unit) {
  constexpr double kNarrowest = 1e-3, kWidest = 3;  // radians
  const bool is_orthographic = camera.text("type") == "orthographic";
  const char* const kind = is_orthographic ? "orthographic" : "perspective";
  if (!camera.has(kind)) camera.refuse("has no '", kind, "'");
  const JsonObject lens(camera.json()[kind], camera.path(), camera.place() + " '" + kind + "'");
  if (is_orthographic) return {.height = 2 * unit * lens.number("ymag", 1e-6, 1e6)};
  return {.vertical_angle = lens.number("yfov", kNarrowest, kWidest)};
}

}  // namespace

std::vector<ClipCamera> read_gltf_cameras(const GltfFile& file, double unit, std::size_t frames,
                                          const std::function<std::vector<Affine>(std::size_t)>& world_at,
                                          std::vector<std::string>& notes) {
  const std::vector<tinygltf::Node>& nodes = file.model().nodes;
  if (!file.look().contains("cameras")) return {};
  const JsonObject root(file.look(), file.path(), "the file");
  const auto leave_out = [&](const Error& error) {
    notes.push_back(std::string("A camera is left out: ") + error.what() + ".");
  };
  std::vector<JsonObject> all;
  try {
    all = root.objects("cameras");
  } catch (const Error& error) {
    leave_out(error);
    return {};
  }
  std::vector<ClipCamera> cameras;
  std::vector<std::size_t> places;  // their nodes
  std::set<std::string> names;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].camera < 0) continue;
    if (cameras.size() == kMost) {
      notes.push_back("Only the first " + std::to_string(kMost) + " cameras are read.");
      break;
    }
    try {
      const auto index = static_cast<std::size_t>(nodes[n].camera);
      if (index >= all.size()) root.refuse("has no camera ", index, ", which a node is");
      ClipCamera camera = lens_of(all[index], unit);
      camera.name = !nodes[n].name.empty()   ? nodes[n].name
                    : all[index].has("name") ? all[index].text("name")
                                             : "camera";
      const std::string own = camera.name;
      for (int k = 2; !names.insert(camera.name).second; ++k) camera.name = own + " " + std::to_string(k);
      cameras.push_back(std::move(camera));
      places.push_back(n);
    } catch (const Error& error) {
      leave_out(error);
    }
  }
  for (std::size_t k = 0; k < frames && !cameras.empty(); ++k) {
    const std::vector<Affine> world = world_at(k);
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      Affine place = world[places[c]];
      for (auto& row : place.m) row[3] = std::clamp(row[3], -kFurthest, kFurthest);
      cameras[c].places.push_back(place);
    }
  }
  return cameras;
}

std::vector<ClipCamera> read_still_cameras(const std::filesystem::path& path, double unit) {
  const std::string extension = lower_case_extension(path);
  if (!is_called_scene(path) || extension == ".fbx") return {};
  const GltfFile file(path);
  std::vector<std::string> unused;  // what reading the character notes already
  const NodeTree tree = read_nodes(file, unit, unused);
  return read_gltf_cameras(
      file, unit, 1, [&](std::size_t) { return world_of_nodes(tree); }, unused);
}

}  // namespace bodyopt
