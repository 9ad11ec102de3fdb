#include "runtime/host/fold_tables.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "runtime/basis/skin_modifiers.h"
#include "runtime/host/fold_joints.h"
#include "shaders/include/fold.h"

namespace bodyopt {
namespace {

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

}  // namespace

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

}  // namespace bodyopt
