#include "trainer/train/skinning/mesh_table.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// The low 21 bits of x, two zero bits after each.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

std::vector<std::uint32_t> morton_order(const Positions& vertices) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(vertices.rows()));
  std::iota(order.begin(), order.end(), 0u);
  if (order.empty()) return order;
  const Eigen::RowVector3d low = vertices.colwise().minCoeff();
  const double extent = (vertices.colwise().maxCoeff() - low).maxCoeff();
  const double scale = extent > 0 ? 0x1fffff / extent : 0;
  std::vector<std::uint64_t> codes;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    std::uint64_t code = 0;
    for (int i = 0; i < 3; ++i) code |= spread_bits(static_cast<std::uint64_t>((vertices(v, i) - low[i]) * scale)) << i;
    codes.push_back(code);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

Positions in_order(const Positions& welded, const std::vector<std::uint32_t>& order) {
  return welded(order, Eigen::all);
}

Character in_order(const Character& character, const std::vector<std::uint32_t>& order) {
  Character result = character;
  result.vertices = in_order(character.vertices, order);
  std::vector<std::uint32_t> runtime(order.size());
  for (std::size_t v = 0; v < order.size(); ++v) {
    runtime[order[v]] = static_cast<std::uint32_t>(v);
    result.weights[v] = character.weights[order[v]];
  }
  for (std::uint32_t& vertex : result.output_vertex) vertex = runtime[vertex];
  for (Eigen::Index k = 0; k < result.triangles.size(); ++k) {
    result.triangles.data()[k] = runtime[result.triangles.data()[k]];
  }
  return result;
}

MeshTable make_mesh_table(const Character& character) {
  MeshTable mesh;
  const Positions& rest = character.vertices;
  mesh.rest.assign(rest.data(), rest.data() + rest.size());
  const Triangles &skin = character.triangles, &output = character.output_triangles;
  mesh.triangles.assign(skin.data(), skin.data() + skin.size());
  mesh.output_vertex = character.output_vertex;
  mesh.output_triangles.assign(output.data(), output.data() + output.size());

  mesh.vertex_triangle_begin.assign(mesh.vertex_count() + 1, 0);
  for (const std::uint32_t v : mesh.triangles) ++mesh.vertex_triangle_begin[v + 1];
  std::partial_sum(mesh.vertex_triangle_begin.begin(), mesh.vertex_triangle_begin.end(),
                   mesh.vertex_triangle_begin.begin());
  mesh.vertex_triangles.resize(mesh.triangles.size());
  std::vector<std::uint32_t> next = mesh.vertex_triangle_begin;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    mesh.vertex_triangles[next[mesh.triangles[k]]++] = static_cast<std::uint32_t>(k / 3);
  }
  return mesh;
}

void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis) {
  constexpr double kSamePlace = 1e-5;  // metres
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::mismatch, "the basis is not of this character: " + what +
                                         "; was the character edited since the training, or is it another one?");
  };
  if (topology_hash(mesh) != topology_hash(basis.mesh)) refuse("its vertices or triangles are others");
  if (skeleton_hash(skeleton) != skeleton_hash(basis.skeleton)) refuse("its skeleton is another");
  for (std::size_t k = 0; k < mesh.rest.size(); ++k) {
    if (std::abs(static_cast<double>(mesh.rest[k] - basis.mesh.rest[k])) <= kSamePlace) continue;
    refuse("its vertices stand elsewhere at rest");
  }
}

}  // namespace bodyopt
