#include "assets/fbx/fbx_mesh.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

constexpr std::size_t kMostFbxOffsets = 1 << 27;

std::vector<Vec3> mesh_vectors(const FbxScene& scene, const FbxObject& object, const char* name) {
  const std::vector<double> numbers = object.node->child(name).numbers();
  if (numbers.size() % 3 != 0) scene.fail(name, " of '", object.name, "' are ", numbers.size(), " numbers, not threes");
  std::vector<Vec3> vectors;
  for (std::size_t k = 0; k < numbers.size(); k += 3) {
    vectors.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
    if (!std::isfinite(length(vectors.back())))
      scene.fail(name, " of '", object.name, "' has a number that is not finite");
  }
  return vectors;
}

void check_point(const FbxScene& scene, const FbxObject& object, std::int64_t point, const FbxMesh& mesh) {
  if (point >= 0 && point < std::ssize(mesh.points)) return;
  scene.fail("'", object.name, "' names point ", point, " of ", mesh.points.size(), "; the FBX file is damaged");
}

// Looks up a layer's value of a polygon, or of one of its corners; nothing where the file does not give it.
class FbxLayer {
 public:
  FbxLayer(const FbxObject& geometry, const char* element, const char* indices)
      : layer_(geometry.node->child(element)),
        indices_(layer_.child(indices).integers()),
        mapping_(layer_.child("MappingInformationType").text(0)) {}
  const FbxNode& node() const { return layer_; }
  std::optional<std::uint32_t> at(std::size_t corner, std::uint32_t point, std::size_t polygon) const {
    std::size_t place = 0;
    if (mapping_ == "ByPolygonVertex") place = corner;
    if (mapping_ == "ByVertice" || mapping_ == "ByVertex") place = point;
    if (mapping_ == "ByPolygon") place = polygon;
    if (indices_.empty()) return static_cast<std::uint32_t>(place);
    if (place >= indices_.size() || indices_[place] < 0 || indices_[place] > 0xFFFFFFF) return std::nullopt;
    return static_cast<std::uint32_t>(indices_[place]);
  }

 private:
  const FbxNode& layer_;
  std::vector<std::int64_t> indices_;
  std::string mapping_;
};

struct FbxLayers {
  explicit FbxLayers(const FbxObject& geometry)
      : texture(geometry, "LayerElementUV", "UVIndex"), material(geometry, "LayerElementMaterial", "Materials") {}
  FbxLayer texture, material;
};

// Quads are cut along the shorter diagonal; larger polygons become fans. `first`: the number of its first corner.
void append_polygon(const std::vector<std::uint32_t>& points, std::size_t first, std::size_t polygon,
                    const FbxLayers& layers, FbxMesh& mesh) {
  const auto apart = [&](std::size_t a, std::size_t b) {
    return length(mesh.points[points[a]] - mesh.points[points[b]]);
  };
  const std::size_t turn = points.size() == 4 && apart(1, 3) < apart(0, 2) ? 1 : 0;
  for (std::size_t k = 2; k < points.size(); ++k) {
    std::array<std::uint32_t, 3>& triangle = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t corner = ((i == 0 ? 0 : k + i - 2) + turn) % points.size();
      triangle[i] = points[corner];
      const auto row = layers.texture.at(first + corner, points[corner], polygon);
      mesh.texture_of.push_back(row && 2 * *row + 1 < mesh.texture.size() ? *row : 0);
    }
    mesh.material_of.push_back(layers.material.at(first, points[0], polygon).value_or(0));
  }
}

// The last corner of a polygon is written as its complement.
void read_polygons(const FbxScene& scene, const FbxObject& geometry, FbxMesh& mesh) {
  const FbxLayers layers(geometry);
  mesh.texture = layers.texture.node().child("UV").numbers();
  if (!std::ranges::all_of(mesh.texture, [](double x) { return std::abs(x) < 1e6; })) mesh.texture.clear();
  std::size_t corner_count = 0, polygon_count = 0;
  std::vector<std::uint32_t> corners;
  for (const std::int64_t corner : geometry.node->child("PolygonVertexIndex").integers()) {
    const std::int64_t point = corner < 0 ? ~corner : corner;
    check_point(scene, geometry, point, mesh);
    corners.push_back(static_cast<std::uint32_t>(point));
    if (corner >= 0) continue;
    append_polygon(corners, corner_count, polygon_count++, layers, mesh);
    corner_count += corners.size();
    corners.clear();
  }
  if (mesh.texture.size() < 2) mesh.texture_of.clear();
  if (!corners.empty()) scene.fail("the last polygon of '", geometry.name, "' has no end; the FBX file is damaged");
}

// Numbers are column by column.
std::optional<Affine> read_matrix(const FbxScene& scene, const FbxObject& object, const char* name) {
  const std::vector<double> numbers = object.node->child(name).numbers();
  if (numbers.size() != 16) return std::nullopt;
  Affine matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const double value = numbers[4 * column + row];
      if (!std::isfinite(value)) scene.fail(name, " of '", object.name, "' has a number that is not finite");
      matrix.m[row][column] = value;
    }
  }
  return matrix;
}

void read_clusters(const FbxScene& scene, const FbxObject& skin, FbxMesh& mesh) {
  for (const FbxObject* deformer : scene.into(skin.id, "Deformer")) {
    const std::vector<const FbxObject*> bones = scene.into(deformer->id, "Model");
    FbxCluster cluster{bones.empty() ? nullptr : bones.front(), deformer->node->child("Indexes").integers(),
                       deformer->node->child("Weights").numbers(), read_matrix(scene, *deformer, "Transform"),
                       read_matrix(scene, *deformer, "TransformLink")};
    if (cluster.points.size() != cluster.weights.size()) {
      scene.fail("'", deformer->name, "' binds ", cluster.points.size(), " points with ", cluster.weights.size(),
                 " weights; the FBX file is damaged");
    }
    for (const std::int64_t point : cluster.points) check_point(scene, *deformer, point, mesh);
    if (!std::ranges::all_of(cluster.weights, [](double weight) { return std::abs(weight) < 1e30; })) {
      scene.fail("a weight of '", deformer->name, "' is not a finite number");
    }
    if (cluster.bone == nullptr && cluster.points.empty()) continue;
    if (cluster.bone == nullptr) scene.fail("'", deformer->name, "' binds points to a bone that is not in the file");
    if (deformer->node->child("Mode").text(0) == "Additive") {
      scene.fail("'", deformer->name, "' adds to other bones' weights, which is not read; bake the skin's weights");
    }
    mesh.clusters.push_back(std::move(cluster));
  }
}

// Shapes in between come first: the last shape alone is read.
void read_channel_shape(const FbxScene& scene, const FbxObject& channel, FbxMesh& mesh) {
  const std::vector<const FbxObject*> shapes = scene.into(channel.id, "Geometry");
  if (shapes.empty()) return;
  const std::vector<double> percents = channel.node->child("FullWeights").numbers(),
                            older = channel.node->child("DeformPercent").numbers();
  const double whole = percents.empty() ? 100 : percents.back();
  const double percent = scene.number(channel, "DeformPercent", older.empty() ? 0 : older.front());
  const FbxObject& shape = *shapes.back();
  if (shapes.size() > 1 && percent != 0 && percent != whole) {
    scene.fail("the blend shape '", channel.name,
               "' rests in between its shapes; export it with the shape at 0 or 100");
  }
  if (mesh.points.size() * (mesh.shapes.size() + 1) > kMostFbxOffsets) {
    scene.fail("its blend shapes move more than ", kMostFbxOffsets, " points; the FBX file is damaged or hostile");
  }
  FbxMesh::BlendShape read{std::vector<Vec3>(mesh.points.size()), whole > 0 ? percent / whole : 0};
  const std::vector<Vec3> offsets = mesh_vectors(scene, shape, "Vertices");
  const std::vector<std::int64_t> points = shape.node->child("Indexes").integers();
  if (points.size() != offsets.size()) {
    scene.fail("the blend shape '", shape.name, "' moves ", points.size(), " points by ", offsets.size(), " offsets");
  }
  for (std::size_t k = 0; k < points.size(); ++k) {
    check_point(scene, shape, points[k], mesh);
    read.offsets[static_cast<std::size_t>(points[k])] = offsets[k];
  }
  mesh.shapes.push_back(std::move(read));
}

}  // namespace

FbxMesh read_fbx_mesh(const FbxScene& scene, const FbxObject& geometry) {
  FbxMesh mesh;
  mesh.points = mesh_vectors(scene, geometry, "Vertices");
  read_polygons(scene, geometry, mesh);
  for (const FbxObject* deformer : scene.into(geometry.id, "Deformer")) {
    if (deformer->type == "Skin") read_clusters(scene, *deformer, mesh);
    if (deformer->type != "BlendShape") continue;
    for (const FbxObject* channel : scene.into(deformer->id, "Deformer")) read_channel_shape(scene, *channel, mesh);
  }
  return mesh;
}

}  // namespace bodyopt
