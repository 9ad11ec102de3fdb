#include "runtime/host/skin_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "runtime/basis/skin_modifiers.h"
#include "shaders/include/fold.h"

namespace bodyopt {
namespace {

constexpr double kLimb = 0.25;  // of the longest chain's length
// Shares of a fold's reach. The trunk's skin may close on a limb's where the fold's joint is less than kFromTrunk from
// the trunk, along the bones. It does so up to kTrunkReach around the joint. An elbow does not fold on the belly, nor
// an armpit at the waist.
constexpr double kFromTrunk = 0.75;
constexpr float kTrunkReach = 0.625f;

std::size_t parent_of(const Skeleton& skeleton, std::size_t joint) {
  return static_cast<std::size_t>(skeleton.joints[joint].parent);
}
// Metres, at rest.
double bone_above(const Skeleton& skeleton, std::size_t joint) {
  return length(bind_place(skeleton, joint) - bind_place(skeleton, parent_of(skeleton, joint)));
}

// J, metres: from joint to joint at rest, along the bones between them; -1 where none lead there.
std::vector<double> ways_along_bones(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<double> ways(skeleton.size(), -1);
  double up = 0;
  for (int at = static_cast<int>(joint); at >= 0; at = skeleton.joints[static_cast<std::size_t>(at)].parent) {
    const auto j = static_cast<std::size_t>(at);
    ways[j] = up;
    if (skeleton.joints[j].parent >= 0) up += bone_above(skeleton, j);
  }
  for (std::size_t j = 0; j < ways.size(); ++j) {  // parents stand before their children
    if (ways[j] < 0 && skeleton.joints[j].parent >= 0) {
      const double above = ways[parent_of(skeleton, j)];
      if (above >= 0) ways[j] = above + bone_above(skeleton, j);
    }
  }
  return ways;
}

// J, metres: the longest chain of bones from the joint's parent through it; from the joint where it has none.
std::vector<double> chain_lengths(const Skeleton& skeleton) {
  std::vector<double> lengths(skeleton.size(), 0);
  for (std::size_t j = lengths.size(); j-- > 0;) {
    if (skeleton.joints[j].parent < 0) continue;
    lengths[j] += bone_above(skeleton, j);
    double& above = lengths[parent_of(skeleton, j)];
    above = std::max(above, lengths[j]);
  }
  return lengths;
}

// Metres along the bones to the nearest joint of the trunk.
double way_to_trunk(const std::vector<double>& ways, const std::vector<char>& trunk) {
  double least = std::numeric_limits<double>::max();
  for (std::size_t j = 0; j < ways.size(); ++j) {
    if (trunk[j] && ways[j] >= 0) least = std::min(least, ways[j]);
  }
  return least;
}

// Parts triangles across their longest extent, into halves of whole boxes, until each is one.
class TriangleBoxes {
 public:
  explicit TriangleBoxes(const MeshTable& mesh) : centres_(mesh.triangles.size() / 3), order_(centres_.size()) {
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      for (std::size_t i = 0; i < 3; ++i) centres_[k / 3][i] += mesh.rest[3 * std::size_t{mesh.triangles[k]} + i];
    }
    std::iota(order_.begin(), order_.end(), 0u);
    split(order_);
  }
  const std::vector<std::uint32_t>& order() const { return order_; }

 private:
  std::size_t longest_axis(std::span<const std::uint32_t> triangles) const {
    std::array<float, 3> extent{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [least, most] =
          std::ranges::minmax(triangles, {}, [&](std::uint32_t triangle) { return centres_[triangle][i]; });
      extent[i] = centres_[most][i] - centres_[least][i];
    }
    return static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
  }

  void split(std::span<std::uint32_t> triangles) {
    if (triangles.size() <= kBoxTriangles) return;
    const std::size_t axis = longest_axis(triangles),
                      half = small_box_count(static_cast<std::uint32_t>(triangles.size())) / 2 *
                             std::size_t{kBoxTriangles};
    std::ranges::nth_element(triangles, triangles.begin() + static_cast<std::ptrdiff_t>(half), {},
                             [&](std::uint32_t t) { return std::pair(centres_[t][axis], t); });
    split(triangles.first(half));
    split(triangles.subspan(half));
  }

  std::vector<std::array<float, 3>> centres_;  // T: three times as far from the origin as they are
  std::vector<std::uint32_t> order_;           // T
};

std::vector<std::uint32_t> vertex_sides(const Basis& basis, const SkinModifier& modifier, std::size_t words) {
  std::vector<std::uint32_t> sides(2 * words * basis.mesh.vertex_count());
  for (std::size_t k = 0; k < modifier.joints.size(); ++k) {
    const std::vector<char> below = at_or_below(basis.skeleton, modifier.joints[k]);
    const float* fold = &modifier.numbers[kPushOut.numbers + k * kPushOut.joint_numbers];
    const std::vector<float> reaches = fold_reaches(basis.skeleton, modifier.joints[k], fold[3]);
    for (std::size_t v = 0; v < basis.mesh.vertex_count(); ++v) {
      float squared = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const float way = basis.mesh.rest[3 * v + i] - fold[i];
        squared += way * way;
      }
      const std::uint32_t bit = 1u << k % 32;
      std::uint32_t* own = &sides[2 * words * v + k / 32];
      const std::uint32_t holder = basis.ddm.vertices[v].base_joint;
      if (squared < reaches[holder] * reaches[holder]) own[0] |= bit;
      if (below[holder]) own[words] |= bit;
    }
  }
  return sides;
}

struct OrientedCorner {
  TangentCorner corner;
  bool is_mirrored;
  double angle;  // at rest
};

// Keyed by vertex of the skin and texture coordinates.
using CornersByPlace = std::map<std::pair<std::uint32_t, std::array<float, 2>>, std::vector<OrientedCorner>>;

double angle_at_rest(const MeshTable& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  double to_b[3], to_c[3], across[3], dot = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    to_b[i] = double{mesh.rest[3 * std::size_t{b} + i]} - double{mesh.rest[3 * std::size_t{a} + i]};
    to_c[i] = double{mesh.rest[3 * std::size_t{c} + i]} - double{mesh.rest[3 * std::size_t{a} + i]};
    dot += to_b[i] * to_c[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    across[i] = to_b[j] * to_c[k] - to_b[k] * to_c[j];
  }
  return std::atan2(std::hypot(across[0], across[1], across[2]), dot);
}

class Corners {
 public:
  Corners(const MeshTable& mesh, std::span<const float> texture) : mesh_(mesh), texture_(texture) {
    for (std::size_t t = 0; t < mesh.output_triangles.size(); t += 3) add(&mesh.output_triangles[t]);
  }

  // The corners of an output vertex: mirrored or not, whichever hold the larger angle.
  std::pair<bool, std::vector<TangentCorner>> of(std::uint32_t output) const {
    std::pair<bool, std::vector<TangentCorner>> found;
    const auto at = by_place_.find(place(output));
    if (at == by_place_.end()) return found;
    double plain = 0, mirrored = 0;
    for (const OrientedCorner& corner : at->second) (corner.is_mirrored ? mirrored : plain) += corner.angle;
    found.first = mirrored > plain;
    for (const OrientedCorner& corner : at->second) {
      if (corner.is_mirrored == found.first) found.second.push_back(corner.corner);
    }
    return found;
  }

  CornersByPlace::key_type place(std::uint32_t output) const {
    return {mesh_.output_vertex[output], {texture_[2 * std::size_t{output}], texture_[2 * std::size_t{output} + 1]}};
  }

 private:
  void add(const std::uint32_t* triangle) {
    const auto [u_b, v_b] = edge(triangle[0], triangle[1]);
    const auto [u_c, v_c] = edge(triangle[0], triangle[2]);
    const double area = u_b * v_c - u_c * v_b;
    if (area == 0 || is_collapsed(triangle)) return;
    for (std::size_t k = 0; k < 3; ++k) {
      add_corner(triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3], area < 0);
    }
  }

  // Two of its corners are at one place at rest: an angle there is of an edge without a direction.
  bool is_collapsed(const std::uint32_t* triangle) const {
    const auto at = [&](std::size_t k) { return &mesh_.rest[3 * std::size_t{mesh_.output_vertex[triangle[k]]}]; };
    return std::equal(at(0), at(0) + 3, at(1)) || std::equal(at(1), at(1) + 3, at(2)) ||
           std::equal(at(2), at(2) + 3, at(0));
  }

  // An edge on the texture.
  std::array<double, 2> edge(std::uint32_t from, std::uint32_t to) const {
    const auto along = [&](std::size_t i) {
      return double{texture_[2 * std::size_t{to} + i]} - double{texture_[2 * std::size_t{from} + i]};
    };
    return {along(0), along(1)};
  }

  // The tangent of a triangle, to where the first texture coordinate grows: v_c e_b - v_b e_c over the area's sign.
  void add_corner(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool is_mirrored) {
    const double v_b = edge(a, b)[1], v_c = edge(a, c)[1];
    const double scale = (is_mirrored ? -1 : 1) / std::max(std::abs(v_b), std::abs(v_c));
    const std::uint32_t at = mesh_.output_vertex[a], at_b = mesh_.output_vertex[b], at_c = mesh_.output_vertex[c];
    by_place_[place(a)].push_back({{at_b, at_c, static_cast<float>(scale * v_c), static_cast<float>(-scale * v_b)},
                                   is_mirrored,
                                   angle_at_rest(mesh_, at, at_b, at_c)});
  }

  const MeshTable& mesh_;
  const std::span<const float> texture_;
  CornersByPlace by_place_;
};

}  // namespace

std::vector<char> trunk_joints(const Skeleton& skeleton) {
  const std::vector<double> lengths = chain_lengths(skeleton);
  const double shortest = kLimb * std::ranges::max(lengths);
  std::vector<int> limbs(lengths.size(), 0);
  for (std::size_t j = limbs.size(); j-- > 0;) {
    if (skeleton.joints[j].parent < 0 || lengths[j] < shortest) continue;
    limbs[parent_of(skeleton, j)] += std::max(limbs[j], 1);
  }
  std::vector<char> trunk;
  for (const int count : limbs) trunk.push_back(count > 1);
  return trunk;
}

std::vector<float> fold_reaches(const Skeleton& skeleton, std::uint32_t joint, float reach) {
  const std::vector<double> ways = ways_along_bones(skeleton, joint);
  const std::vector<char> trunk = trunk_joints(skeleton);
  const float of_trunk = way_to_trunk(ways, trunk) < kFromTrunk * double{reach} ? kTrunkReach * reach : 0.0f;
  const std::vector<char> below = at_or_below(skeleton, joint);
  std::vector<float> reaches;
  for (std::size_t j = 0; j < ways.size(); ++j) {
    const bool bent = static_cast<int>(j) == skeleton.joints[joint].parent;
    const bool near = bent || (ways[j] >= 0 && ways[j] < double{reach});
    const bool limb_on_trunk = trunk[j] && !trunk[joint] && !bent,
               beyond = below[j] && j != joint && !trunk[joint] && of_trunk > 0;
    reaches.push_back(limb_on_trunk || (beyond && near) ? of_trunk : near ? reach : 0.0f);
  }
  return reaches;
}

std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<char> found(skeleton.size());
  for (std::size_t j = 0; j < found.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    found[j] = j == joint || (parent >= 0 && found[static_cast<std::size_t>(parent)]);
  }
  return found;
}

FoldTables fold_tables(const Basis& basis) {
  const SkinModifier* modifier = basis.modifiers.of_type(kPushOut.name);
  if (modifier == nullptr) return {};
  const std::size_t words = (modifier->joints.size() + 31) / 32;
  FoldTables tables = {boxed_triangles(basis.mesh), vertex_sides(basis, *modifier, words)};
  add_box_sides(words, tables);
  return tables;
}

std::vector<std::uint32_t> boxed_triangles(const MeshTable& mesh) {
  std::vector<std::uint32_t> triangles;
  const TriangleBoxes boxes(mesh);
  for (const std::uint32_t triangle : boxes.order()) {
    const auto corners = mesh.triangles.begin() + 3 * std::ptrdiff_t{triangle};
    triangles.insert(triangles.end(), corners, corners + 3);
  }
  return triangles;
}

void add_box_sides(std::size_t words, FoldTables& tables) {
  std::vector<std::uint32_t>& sides = tables.sides;
  const std::size_t begin = sides.size();
  sides.resize(begin + 2 * words * small_box_count(static_cast<std::uint32_t>(tables.triangles.size() / 3)));
  for (std::size_t k = 0; k < tables.triangles.size(); ++k) {
    const std::uint32_t* child = &sides[2 * words * tables.triangles[k] + words];
    std::uint32_t* box = &sides[begin + 2 * words * (k / 3 / kBoxTriangles)];
    for (std::size_t word = 0; word < words; ++word) {
      box[word] |= ~child[word];
      box[words + word] |= child[word];
    }
  }
}

TangentTables tangent_tables(const MeshTable& mesh, std::span<const float> texture) {
  TangentTables tables;
  if (texture.empty()) return tables;
  const Corners corners(mesh, texture);
  std::map<CornersByPlace::key_type, TangentVertex> known;
  for (std::uint32_t output = 0; output < mesh.output_count(); ++output) {
    auto [found, is_new] = known.try_emplace(corners.place(output));
    if (is_new) {
      const auto [is_mirrored, own] = corners.of(output);
      const auto begin = static_cast<std::uint32_t>(tables.corners.size());
      tables.corners.insert(tables.corners.end(), own.begin(), own.end());
      found->second = {mesh.output_vertex[output], begin, static_cast<std::uint32_t>(tables.corners.size()),
                       is_mirrored ? -1.0f : 1.0f};
    }
    tables.vertices.push_back(found->second);
  }
  return tables;
}

}  // namespace bodyopt
