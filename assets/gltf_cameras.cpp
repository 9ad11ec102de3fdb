#include "assets/gltf_cameras.h"

#include <algorithm>

#include "assets/clip_source.h"
#include "assets/gltf_nodes.h"
#include "assets/json_file.h"

namespace bodyopt {
namespace {

// Returns `own`, or "camera" where it has no name, and a number if that is taken.
std::string free_name(const std::vector<ClipCamera>& cameras, const std::string& own) {
  const std::string wanted = own.empty() ? "camera" : own;
  std::string name = wanted;
  for (int k = 2; std::ranges::find(cameras, name, &ClipCamera::name) != cameras.end(); ++k) {
    name = wanted + " " + std::to_string(k);
  }
  return name;
}

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
  std::vector<ClipCamera> cameras;
  std::vector<std::size_t> places;  // their nodes
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (nodes[n].camera < 0) continue;
    try {
      const auto index = static_cast<std::size_t>(nodes[n].camera);
      const std::vector<JsonObject> all = root.objects("cameras");
      if (index >= all.size()) root.refuse("has no camera ", index, ", which a node is");
      cameras.push_back(lens_of(all[index], unit));
      const bool is_named = nodes[n].name.empty() && all[index].has("name");
      cameras.back().name = free_name(cameras, is_named ? all[index].text("name") : nodes[n].name);
      places.push_back(n);
    } catch (const Error& error) {
      notes.push_back(std::string("A camera is left out: ") + error.what() + ".");
    }
  }
  for (std::size_t k = 0; k < frames && !cameras.empty(); ++k) {
    const std::vector<Affine> world = world_at(k);
    for (std::size_t c = 0; c < cameras.size(); ++c) cameras[c].places.push_back(world[places[c]]);
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
