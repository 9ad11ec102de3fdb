#include "runtime/host/character_model.h"

#include <algorithm>
#include <numeric>

namespace bodyopt {

NearTriangles near_triangles(const MeshTable& mesh) {
  const auto corners = [&](std::uint32_t triangle) { return mesh.triangles.begin() + std::ptrdiff_t{3} * triangle; };
  const auto lowest = [&](std::uint32_t triangle) {
    return *std::min_element(corners(triangle), corners(triangle) + 3);
  };
  std::vector<std::uint32_t> order(mesh.triangles.size() / 3), number(order.size());
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, {}, lowest);
  NearTriangles near;
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    number[order[k]] = k;
    near.triangles.insert(near.triangles.end(), corners(order[k]), corners(order[k]) + 3);
  }
  for (const std::uint32_t triangle : mesh.vertex_triangles) near.vertex_triangles.push_back(number[triangle]);
  return near;
}

std::shared_ptr<const CharacterModel> make_character_model(Basis basis, std::optional<Dynamics> dynamics,
                                                           std::span<const float> texture) {
  validate(basis, "the basis");
  if (dynamics) validate(*dynamics, basis, "the dynamics");
  return std::make_shared<const CharacterModel>(std::move(basis), std::move(dynamics), texture);
}

}  // namespace bodyopt
