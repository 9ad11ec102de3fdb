#include "assets/caches/gltf_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "assets/caches/bound_skin.h"
#include "assets/characters/character_write.h"
#include "assets/clips/gltf_motion.h"
#include "geometry/mesh.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMostGlbBytes = 0xFFFFFFFFu;  // of a .glb
constexpr const char* kGenerator = "bodyopt, shapes of a clip";

// Normals over vertices that are one where they lie on one another in a shape.
class SmoothNormals {
 public:
  SmoothNormals(std::span<const float> shape, std::span<const std::uint32_t> corners) {
    std::map<std::array<float, 3>, std::uint32_t> places;
    for (std::size_t k = 0; k < shape.size(); k += 3) {
      const auto next = static_cast<std::uint32_t>(places.size());
      place_of_.push_back(places.try_emplace({shape[k], shape[k + 1], shape[k + 2]}, next).first->second);
    }
    places_.resize(static_cast<Eigen::Index>(places.size()), 3);
    triangles_.resize(static_cast<Eigen::Index>(corners.size() / 3), 3);
    for (std::size_t k = 0; k < corners.size(); ++k) triangles_.data()[k] = place_of_[corners[k]];
  }

  // points x 3.
  std::vector<float> operator()(std::span<const float> shape) {
    for (std::size_t v = 0; v < place_of_.size(); ++v) {
      for (std::size_t i = 0; i < 3; ++i) {
        places_(place_of_[v], static_cast<Eigen::Index>(i)) = static_cast<double>(shape[3 * v + i]);
      }
    }
    const Positions all = unit_normals(places_, triangles_);
    std::vector<float> normals;
    for (const std::uint32_t place : place_of_) {
      for (Eigen::Index i = 0; i < 3; ++i) normals.push_back(static_cast<float>(all(place, i)));
    }
    return normals;
  }

 private:
  std::vector<std::uint32_t> place_of_;
  Positions places_;
  Triangles triangles_;
};

std::vector<float> difference(std::span<const float> a, std::span<const float> b) {
  std::vector<float> apart;
  for (std::size_t k = 0; k < a.size(); ++k) apart.push_back(a[k] - b[k]);
  return apart;
}

// Each frame shows its own target alone. `targets`: one for each frame, or for each but the first.
void add_weights(const CacheLayout& layout, std::size_t targets, std::size_t node, Json& animation, GlbWriter& glb) {
  const std::size_t without = layout.frames.size() - targets;
  std::vector<float> times, weights(layout.frames.size() * targets, 0.0f);
  for (std::size_t k = 0; k < layout.frames.size(); ++k) {
    times.push_back(static_cast<float>((layout.frames[k] - layout.frames.front()) / layout.fps));
    if (k >= without) weights[k * targets + k - without] = 1;
  }
  const std::size_t input = glb.add(times, "SCALAR", GlbTarget::none),
                    output = glb.add(weights, "SCALAR", GlbTarget::none);
  add_channel(input, output, node, "weights", animation);
}

}  // namespace

void require_replaceable_shapes(const fs::path& path) {
  if (may_be_replaced(path, kGenerator)) return;
  throw Error(ErrorKind::usage, path,
              " is there already, and holds no shapes that bodyopt wrote: is it a character or a "
              "clip? Choose another name, or remove it");
}

GltfShapesWriter::GltfShapesWriter(const fs::path& path, CacheLayout layout)
    : path_(path),
      layout_(std::move(layout)),
      corners_(layout_.corners.begin(), layout_.corners.end()),
      split_(split_corners(std::move(layout_.surface), corners_, layout_.points)) {
  require_replaceable_shapes(path_);
  const std::uint64_t frames = layout_.frames.size();
  const std::uint64_t points = split_.places.size();
  if (!std::ranges::is_sorted(layout_.frames)) {
    throw Error(ErrorKind::usage, path, ": the frames of a .glb rise in time: give --frames in order, or write .pc2");
  }
  // Positions, and normals or the joints and their motion; a weight of each target in every frame; coordinates, colours
  // and images.
  std::uint64_t bytes = 24 * points * frames + 4 * (frames * frames + corners_.size()) + 20 * points;
  if (const BoundSkin* bound = layout_.bound) {
    bytes += 40 * bound->clip.poses.size() * bound->character.skeleton.size() + 120 * points - 12 * points * frames;
  }
  for (const SurfaceTexture& texture : split_.surface.textures) bytes += texture.bytes->size();
  if (bytes <= kMostGlbBytes) return;
  throw Error(ErrorKind::usage, path, ": ", layout_.frames.size(), " frames of ", points,
              " points, with their images, take more than the 4 GiB that a .glb can hold: write fewer frames, or .pc2");
}

std::span<const float> GltfShapesWriter::frame(std::size_t k) const {
  const std::size_t size = 3 * std::size_t{layout_.points};
  return std::span(positions_).subspan(k * size, size);
}

void GltfShapesWriter::append(std::span<const float> positions, std::span<const float> /*normals*/) {
  require_sample(path_, layout_, positions_.size() / (3 * std::size_t{layout_.points}), positions);
  positions_.insert(positions_.end(), positions.begin(), positions.end());
}

// The first, and what the others are more.
Json GltfShapesWriter::shapes(GlbWriter& glb) const {
  SmoothNormals smooth(frame(0), corners_);
  const std::vector<float> normals = smooth(frame(0));
  const auto add = [&](std::span<const float> values) {
    return glb.add(spread(values, split_.places), "VEC3", GlbTarget::vertices);
  };
  Json drawn = {{"attributes", {{"POSITION", add(frame(0))}, {"NORMAL", add(normals)}}}};
  for (std::size_t k = 1; k < layout_.frames.size(); ++k) {
    drawn["targets"].push_back(
        {{"POSITION", add(difference(frame(k), frame(0)))}, {"NORMAL", add(difference(smooth(frame(k)), normals))}});
  }
  return drawn;
}

// The rest shape, and what each is more below the joints.
Json GltfShapesWriter::bound_shapes(GlbWriter& glb) const {
  Json drawn = {{"attributes", bound_vertices(layout_.bound->character, split_.places, glb)}};
  for (std::size_t k = 0; k < layout_.frames.size(); ++k) {
    const std::vector<float> offsets = blend_shape(*layout_.bound, layout_.frames[k], frame(k));
    drawn["targets"].push_back({{"POSITION", glb.add(spread(offsets, split_.places), "VEC3", GlbTarget::vertices)}});
  }
  return drawn;
}

void GltfShapesWriter::close() {
  const std::size_t count = layout_.frames.size();
  require_all_samples(path_, layout_, positions_.size() / (3 * std::size_t{layout_.points}));
  GlbWriter glb;
  glb.root["asset"]["generator"] = kGenerator;
  Json animation = {{"name", layout_.name}, {"samplers", Json::array()}, {"channels", Json::array()}};
  Json node = {{"name", layout_.name}, {"mesh", 0}}, names = Json::array();
  if (layout_.bound != nullptr) {
    const Skeleton& skeleton = layout_.bound->character.skeleton;
    glb.add_skin(skeleton, glb.add_skeleton(skeleton));
    node["skin"] = 0;
    animation = motion_animation(with_continuous_rotations(layout_.bound->clip), skeleton, glb);
  }
  const Json drawn = layout_.bound != nullptr ? bound_shapes(glb) : shapes(glb);
  const Json primitives = surface_primitives(split_.corners, split_.surface, drawn, glb);
  glb.root["meshes"].push_back({{"name", layout_.name}, {"primitives", primitives}});
  const std::size_t mesh_node = glb.root["nodes"].size();
  glb.root["nodes"].push_back(node);
  glb.root["scenes"][0]["nodes"].push_back(mesh_node);
  if (drawn.contains("targets")) {
    const std::size_t targets = drawn["targets"].size();
    for (std::size_t k = count - targets; k < count; ++k) names.push_back("frame " + std::to_string(layout_.frames[k]));
    glb.root["meshes"][0]["weights"] = std::vector<float>(targets, 0.0f);
    glb.root["meshes"][0]["extras"]["targetNames"] = names;
    add_weights(layout_, targets, mesh_node, animation, glb);
    glb.root["animations"].push_back(animation);
  }
  glb.write(path_);
}

std::vector<fs::path> GltfShapesWriter::put_aside(const fs::path& stem) {
  write_file_atomically(points_aside(stem), std::as_bytes(std::span(positions_)));
  return {points_aside(stem)};
}

void GltfShapesWriter::take_up(const fs::path& stem, std::size_t frames) {
  const std::string bytes = read_file(points_aside(stem), kMostGlbBytes, "points that were put aside");
  positions_.resize(bytes.size() / sizeof(float));
  std::memcpy(positions_.data(), bytes.data(), positions_.size() * sizeof(float));
  if (positions_.size() == 3 * frames * layout_.points) return;
  throw Error(ErrorKind::file, points_aside(stem), ": does not hold the ", frames,
              " frames that were put aside: damaged, or of another run?");
}

}  // namespace bodyopt
