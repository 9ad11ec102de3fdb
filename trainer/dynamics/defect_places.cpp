#include "trainer/dynamics/defect_places.h"

#include <iomanip>
#include <map>
#include <sstream>
#include <vector>

#include "geometry/bad_edges.h"
#include "geometry/self_intersections.h"

namespace bodyopt {
namespace {

constexpr std::size_t kShown = 3;  // joints

using VertexList = std::vector<std::uint32_t>;

VertexList first_vertices(const std::vector<VertexPair>& edges) {
  VertexList vertices;
  for (const VertexPair& edge : edges) vertices.push_back(edge.first);
  return vertices;
}

// The first of every joint's.
std::string places_of(const Character& character, const std::string& defect, const VertexList& vertices) {
  std::map<std::uint32_t, std::uint32_t> first;
  for (const std::uint32_t v : vertices) first.try_emplace(character.weights[v].front().joint, v);
  std::ostringstream text;
  text << std::fixed << std::setprecision(3);
  std::size_t shown = 0;
  for (const auto& [joint, vertex] : first) {
    if (shown++ == kShown) break;
    text << (shown == 1 ? "; the skin " + defect + " at '" : ", '") << character.skeleton.joints[joint].name << "' ("
         << character.vertices.row(vertex) << " m)";
  }
  if (first.size() > kShown) text << " and " << first.size() - kShown << " more";
  return text.str();
}

}  // namespace

std::string defect_places(const Character& character) {
  if (!character.vertices.allFinite()) return "";
  const BadEdges bad = find_bad_edges(character.triangles);
  return places_of(character, "is open", first_vertices(bad.open)) +
         places_of(character, "is fused along an edge", first_vertices(bad.shared)) +
         places_of(character, "turns inside out", first_vertices(bad.flipped)) +
         places_of(character, "passes through itself",
                   corners_of(self_intersections(character.vertices, character.triangles), character.triangles));
}

}  // namespace bodyopt
