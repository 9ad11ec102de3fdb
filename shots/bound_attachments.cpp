#include "shots/bound_attachments.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace bodyopt::shots {
namespace {

constexpr std::size_t kMostWeights = 4;  // that every program draws

// Returns the largest weights, descending, with a sum of one.
std::vector<JointWeight> largest(const std::map<std::uint32_t, double>& by_joint) {
  std::vector<JointWeight> weights;
  for (const auto& [joint, weight] : by_joint) weights.push_back({joint, weight});
  std::ranges::stable_sort(weights, std::greater<>(), &JointWeight::weight);
  weights.resize(std::min(weights.size(), kMostWeights));
  double sum = 0;
  for (const JointWeight& weight : weights) sum += weight.weight;
  for (JointWeight& weight : weights) weight.weight /= sum;
  return weights;
}

// `welded`: the character's vertex of each vertex of the basis.
std::vector<JointWeight> anchor_weights(const Character& character, const std::vector<std::uint32_t>& welded,
                                        const AttachedMesh& attached, std::size_t anchor) {
  std::map<std::uint32_t, double> by_joint;
  for (std::uint32_t p = attached.point_begin[anchor]; p < attached.point_begin[anchor + 1]; ++p) {
    const SurfacePoint& point = attached.points[p];
    const std::pair<std::uint32_t, float> corners[] = {{point.a, point.wa}, {point.b, point.wb}, {point.c, point.wc}};
    for (const auto& [vertex, share] : corners) {
      for (const JointWeight& weight : character.weights[welded[vertex]]) {
        by_joint[weight.joint] += static_cast<double>(share) * weight.weight;
      }
    }
  }
  if (by_joint.empty()) by_joint[attached.anchors[anchor].joint] = 1;
  return largest(by_joint);
}

}  // namespace

BoundSkin bind_attached(const BoundSkin& skin, const MeshTable& mesh, const AttachedMesh& attached) {
  std::vector<std::uint32_t> welded(mesh.vertex_count());
  for (std::size_t o = 0; o < mesh.output_count(); ++o) {
    welded[mesh.output_vertex[o]] = skin.character.output_vertex[o];
  }
  std::vector<std::vector<JointWeight>> of_anchors;
  for (std::size_t k = 0; k < attached.anchors.size(); ++k) {
    of_anchors.push_back(anchor_weights(skin.character, welded, attached, k));
  }
  BoundSkin bound{{}, skin.clip};
  Character& own = bound.character;
  own.name = attached.name;
  own.skeleton = skin.character.skeleton;
  own.vertices = rows_of(attached.rest);
  own.triangles = own.output_triangles = rows_of(attached.triangles);
  for (const std::uint32_t anchor : attached.vertex_anchor) own.weights.push_back(of_anchors[anchor]);
  own.output_vertex.resize(own.weights.size());
  std::iota(own.output_vertex.begin(), own.output_vertex.end(), 0u);
  return bound;
}

}  // namespace bodyopt::shots
