#include "trainer/dynamics/dissection.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace bodyopt {
namespace {

constexpr std::size_t kLeafNodes = 32;

// Half of the space's directions along axes, and diagonals of faces and of cubes.
std::vector<Eigen::Vector3d> directions() {
  std::vector<Eigen::Vector3d> result;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int first = x != 0 ? x : y != 0 ? y : z;
        if (first > 0) result.push_back(Eigen::Vector3d(x, y, z).normalized());
      }
    }
  }
  return result;
}

// The smallest set of nodes that all edges between two sides touch: Koenig's theorem on a largest matching, which is
// found by augmenting paths (Hopcroft and Karp's problem, Kuhn's algorithm: cuts are small).
class CoverFinder {
 public:
  explicit CoverFinder(const Graph& graph) : graph_(graph), partner_(graph.size(), -1), seen_(graph.size(), 0) {}

  // side: 0 or 1 for the nodes looked at, -1 for others. Ascending.
  std::vector<int> operator()(const std::vector<int>& nodes, const std::vector<signed char>& side) {
    side_ = side.data();
    left_.clear();
    reached_.clear();
    for (const int node : nodes) {
      partner_[at(node)] = -1;
      if (side_[at(node)] == 0 && crosses(node)) left_.push_back(node);
    }
    for (const int node : left_) {
      ++stamp_;
      augment(node);
    }
    // What alternating paths reach from unmatched nodes on the left; the cover is the left not reached and the right
    // reached.
    ++stamp_;
    for (const int node : left_) {
      if (partner_[at(node)] < 0) reach(node);
    }
    std::vector<int> cover = reached_;
    for (const int node : left_) {
      if (seen_[at(node)] != stamp_) cover.push_back(node);
    }
    std::sort(cover.begin(), cover.end());
    return cover;
  }

 private:
  static std::size_t at(int node) { return static_cast<std::size_t>(node); }
  bool crosses(int node) const {
    return std::any_of(graph_[at(node)].begin(), graph_[at(node)].end(), [&](int n) { return side_[at(n)] == 1; });
  }
  bool augment(int node) {
    for (const int other : graph_[at(node)]) {
      if (side_[at(other)] != 1 || seen_[at(other)] == stamp_) continue;
      seen_[at(other)] = stamp_;
      if (partner_[at(other)] >= 0 && !augment(partner_[at(other)])) continue;
      partner_[at(other)] = node;
      partner_[at(node)] = other;
      return true;
    }
    return false;
  }
  void reach(int node) {
    if (seen_[at(node)] == stamp_) return;
    seen_[at(node)] = stamp_;
    for (const int other : graph_[at(node)]) {
      if (side_[at(other)] != 1 || seen_[at(other)] == stamp_) continue;
      seen_[at(other)] = stamp_;
      reached_.push_back(other);
      if (partner_[at(other)] >= 0) reach(partner_[at(other)]);
    }
  }

  const Graph& graph_;
  const signed char* side_ = nullptr;
  std::vector<int> partner_;
  std::vector<std::uint64_t> seen_;  // stamps
  std::uint64_t stamp_ = 0;
  std::vector<int> left_, reached_;
};

class Dissection {
 public:
  Dissection(const Graph& graph, const Positions& points)
      : graph_(graph), points_(points), find_cover_(graph), side_(graph.size(), -1), front_of_(graph.size(), -1) {
    std::vector<int> all(graph.size());
    std::iota(all.begin(), all.end(), 0);
    if (!all.empty()) split(all);
  }

  std::vector<DissectedFront> take() { return std::move(fronts_); }

 private:
  static std::size_t at(int node) { return static_cast<std::size_t>(node); }

  // Returns the front above all others of these nodes.
  int split(const std::vector<int>& nodes) {
    if (nodes.size() <= kLeafNodes) return add(nodes, -1, -1);
    std::vector<int> separator = best_separator(nodes);
    std::vector<int> halves[2];
    for (const int node : nodes) {
      if (!std::binary_search(separator.begin(), separator.end(), node)) {
        halves[side_[at(node)]].push_back(node);
      }
    }
    for (const int node : nodes) side_[at(node)] = -1;
    if (halves[0].empty() || halves[1].empty()) return add(nodes, -1, -1);  // all touch all
    const int first = split(halves[0]), second = split(halves[1]);
    return add(std::move(separator), first, second);
  }

  // Leaves side_ as the best cut found has it.
  std::vector<int> best_separator(const std::vector<int>& nodes) {
    std::vector<int> best;
    std::vector<int> best_low;
    for (const Eigen::Vector3d& direction : kDirections) {
      const std::vector<int> low = lower_half(nodes, direction);
      mark(nodes, low);
      std::vector<int> cover = find_cover_(nodes, side_);
      if (!best_low.empty() && cover.size() >= best.size()) continue;
      best = std::move(cover);
      best_low = low;
    }
    mark(nodes, best_low);
    return best;
  }

  std::vector<int> lower_half(const std::vector<int>& nodes, const Eigen::Vector3d& direction) const {
    std::vector<std::pair<double, int>> order;
    for (const int node : nodes) order.emplace_back(points_.row(node).dot(direction), node);
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
    std::nth_element(order.begin(), middle, order.end());
    std::vector<int> low;
    for (auto entry = order.begin(); entry != middle; ++entry) low.push_back(entry->second);
    return low;
  }

  void mark(const std::vector<int>& nodes, const std::vector<int>& low) {
    for (const int node : nodes) side_[at(node)] = 1;
    for (const int node : low) side_[at(node)] = 0;
  }

  int add(std::vector<int> own, int first, int second) {
    const int number = static_cast<int>(fronts_.size());
    DissectedFront front;
    for (const int node : own) front_of_[at(node)] = number;
    // Nodes not yet in a front belong to one above.
    const auto touch = [&](const std::vector<int>& nodes) {
      for (const int node : nodes) {
        if (front_of_[at(node)] < 0) front.boundary.push_back(node);
      }
    };
    for (const int node : own) touch(graph_[at(node)]);
    const int children[] = {first, second};
    for (int k = 0; k < 2; ++k) {
      front.children[k] = children[k];
      if (children[k] < 0) continue;
      touch(fronts_[at(children[k])].boundary);
      front.level = std::max(front.level, fronts_[at(children[k])].level + 1);
    }
    std::sort(front.boundary.begin(), front.boundary.end());
    front.boundary.erase(std::unique(front.boundary.begin(), front.boundary.end()), front.boundary.end());
    front.own = std::move(own);
    fronts_.push_back(std::move(front));
    return number;
  }

  const Graph& graph_;
  const Positions& points_;
  const std::vector<Eigen::Vector3d> kDirections = directions();
  CoverFinder find_cover_;
  std::vector<signed char> side_;  // of the nodes being split
  std::vector<int> front_of_;
  std::vector<DissectedFront> fronts_;
};

}  // namespace

std::vector<DissectedFront> dissect(const Graph& graph, const Positions& points) {
  return Dissection(graph, points).take();
}

}  // namespace bodyopt
