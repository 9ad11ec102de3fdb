#include "assets/characters/character.h"

#include <meshoptimizer.h>

#include "assets/gltf/gltf_skin.h"
#include "assets/gltf/skin_surface.h"
#include "tests/assets/gltf_blob.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  GltfBlob coloured = two_joint_square();
  coloured.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      coloured.vectors({0, 0, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1});
  GltfBlob sparse = coloured;
  sparse.root["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5121}}}, {"values", {{"bufferView", 0}}}};
  sparse.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  sparse.root["meshes"][0]["weights"] = {0.5};
  sparse.root["scenes"] = {{{"nodes", {0, 2}}}};
  // The view of the positions, as EXT_meshopt_compression has it.
  GltfBlob compressed = coloured;
  std::vector<unsigned char> encoded(1024);
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), compressed.binary.data(), 4, 12));
  compressed.root["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
      {"buffer", 0},
      {"byteOffset", compressed.binary.size()},
      {"byteLength", encoded.size()},
      {"byteStride", 12},
      {"count", 4},
      {"mode", "ATTRIBUTES"}};
  compressed.binary.append(reinterpret_cast<const char*>(encoded.data()), encoded.size());
  GltfBlob pictured = coloured;
  pictured.root["images"] = {{{"name", "a"}, {"uri", "data:image/png;base64,iVBORw0KGgo="}}, {{"bufferView", 0}}};
  pictured.root["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
  pictured.root["textures"] = {{{"source", 0}, {"sampler", 0}},
                               {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
  const Json transform = {{"offset", {0.5, 0}}, {"rotation", 1}, {"scale", {2, 1}}, {"texCoord", 0}};
  pictured.root["materials"] = {
      {{"name", "m"},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"normalTexture", {{"index", 1}, {"scale", 0.5}}},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.5, 0.5, 1}},
         {"roughnessFactor", 0.5},
         {"baseColorTexture", {{"index", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}};
  Json& primitive = pictured.root["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["attributes"]["TEXCOORD_0"] = pictured.add(std::vector<float>{0, 1, 1, 1, 1, 0, 0, 0}, 5126, "VEC2", 2);
  primitive["attributes"]["_ROWS"] = primitive["attributes"]["TEXCOORD_0"];
  primitive["attributes"]["_ROW_OF"] = pictured.add(std::vector<std::uint16_t>(12, 1), 5123, "SCALAR", 1);
  return {coloured.glb(), sparse.glb(), compressed.glb(), pictured.glb()};
}

void read(const std::string& bytes) {
  const std::filesystem::path path = as_file("character.glb", bytes);
  const Character character = read_character(path, 0.1);
  require_finite(std::vector(character.vertices.data(), character.vertices.data() + character.vertices.size()),
                 "vertices");
  for (const std::vector<JointWeight>& weights : character.weights) {
    for (const JointWeight& weight : weights) require_finite(std::vector{weight.weight}, "weights");
  }
  const std::span corners(character.output_triangles.data(),
                          static_cast<std::size_t>(character.output_triangles.size()));
  const SkinSurface surface = read_skin_surface(path, character.output_count(), corners);
  require_finite(image_coordinates(surface, corners), "coordinates in images");
  for (const SurfaceMaterial& material : surface.materials) {
    require_finite(material.colour(), "a material's colour");
    require_finite(std::array{material.number("roughnessFactor", 1), material.number("alphaCutoff", 0.5)},
                   "a material");
  }
  require_finite(read_vertex_colours(path, "COLOR_0"), "colours");
}

const bool added = add_target({"character", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
