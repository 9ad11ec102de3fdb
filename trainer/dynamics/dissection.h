// Nested dissection: a graph's nodes in the order in which they are eliminated, as a binary tree of fronts.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

// Neighbours of every node.
using Graph = std::vector<std::vector<int>>;

struct DissectedFront {
  std::vector<int> own;       // nodes eliminated here; none where a plane cuts no edge
  std::vector<int> boundary;  // nodes of fronts above that own or boundary nodes of fronts below touch, ascending
  int children[2] = {-1, -1};
  int level = 0;  // above those of its children; leaves are 0
};

// George 1973, by geometry: nodes are halved by planes, of several directions the one whose cut takes the fewest nodes
// to cover (Koenig's theorem), down to 32 or fewer. Children come before parents. A function of its arguments alone.
std::vector<DissectedFront> dissect(const Graph& graph, const Positions& points);

}  // namespace bodyopt
