#include "trainer/dynamics/block_inverse.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <numeric>

#include "base/parallel.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr std::size_t kLeafNodes = 32;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

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

// Finds the smallest set of nodes that all edges between two sides touch, by Koenig's theorem on a maximum matching.
// Kuhn's augmenting paths find that: cuts are small, so Hopcroft and Karp's faster method is not needed.
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
    // Alternating paths start from unmatched nodes on the left. The cover is the nodes on the left that they do not
    // reach, and those on the right that they do.
    ++stamp_;
    for (const int node : left_) {
      if (partner_[at(node)] < 0) reach(node);
    }
    std::vector<int> cover = reached_;
    for (const int node : left_) {
      if (seen_[at(node)] != stamp_) cover.push_back(node);
    }
    std::ranges::sort(cover);
    return cover;
  }

 private:
  bool crosses(int node) const {
    return std::ranges::any_of(graph_[at(node)], [&](int n) { return side_[at(n)] == 1; });
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
  // Returns the front above all others of these nodes.
  int split(const std::vector<int>& nodes) {
    if (nodes.size() <= kLeafNodes) return add(nodes, -1, -1);
    std::vector<int> separator = best_separator(nodes);
    std::vector<int> halves[2];
    for (const int node : nodes) {
      if (!std::ranges::binary_search(separator, node)) {
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
    std::ranges::sort(front.boundary);
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

using Matrix = Eigen::MatrixXd;

// Columns that one thread solves or multiplies at a time: products do not depend on the number of threads.
constexpr Eigen::Index kColumns = 64;

template <typename Work>
void for_columns(Eigen::Index count, const Work& work) {
  parallel_for(static_cast<std::size_t>((count + kColumns - 1) / kColumns), [&](std::size_t k) {
    const Eigen::Index begin = static_cast<Eigen::Index>(k) * kColumns;
    work(begin, std::min(kColumns, count - begin));
  });
}

// Dense blocks of one front: its own n1 unknowns, its nb boundary unknowns.
struct Front {
  Matrix inverse;    // P, n1 x n1
  Matrix to_own;     // W, n1 x nb
  Matrix handed_up;  // nb x nb, freed when the parent has it
};

int level_count(const std::vector<DissectedFront>& tree) {
  int count = 0;
  for (const DissectedFront& front : tree) count = std::max(count, front.level + 1);
  return count;
}

std::vector<std::size_t> fronts_of(const std::vector<DissectedFront>& tree, int level) {
  std::vector<std::size_t> numbers;
  for (std::size_t f = 0; f < tree.size(); ++f) {
    if (tree[f].level == level) numbers.push_back(f);
  }
  return numbers;
}

class Factorisation {
 public:
  Factorisation(const Eigen::SparseMatrix<double>& matrix, const std::vector<DissectedFront>& tree, int components)
      : matrix_(matrix), tree_(tree), components_(components), fronts_(tree.size()) {
    for (int level = 0; level < level_count(tree); ++level) factorise(fronts_of(tree, level));
    if (!positive_) {
      throw Error(ErrorKind::mismatch, "the system is not positive definite: a part of it is held by nothing");
    }
  }

  const Front& front(std::size_t number) const { return fronts_[number]; }

 private:
  void factorise(const std::vector<std::size_t>& numbers) {
    // Many small fronts side by side; few large ones one after the other, each on all threads.
    if (numbers.size() >= 8) {
      parallel_for(numbers.size(), [&](std::size_t k) { factorise(numbers[k]); });
    } else {
      for (const std::size_t number : numbers) factorise(number);
    }
  }

  void factorise(std::size_t number) {
    const DissectedFront& front = tree_[number];
    const Eigen::Index own = components_ * static_cast<Eigen::Index>(front.own.size());
    const Eigen::Index boundary = components_ * static_cast<Eigen::Index>(front.boundary.size());
    Matrix whole = assemble(front, own + boundary);
    Front& result = fronts_[number];
    const Eigen::LLT<Matrix> factor(whole.topLeftCorner(own, own));
    if (own > 0 && factor.info() != Eigen::Success) positive_ = false;
    result.inverse.resize(own, own);
    for_columns(own, [&](Eigen::Index begin, Eigen::Index count) {
      result.inverse.middleCols(begin, count) = factor.solve(Matrix::Identity(own, own).middleCols(begin, count));
    });
    result.to_own.resize(own, boundary);
    result.handed_up = whole.bottomRightCorner(boundary, boundary);
    for_columns(boundary, [&](Eigen::Index begin, Eigen::Index count) {
      result.to_own.middleCols(begin, count) = factor.solve(whole.block(0, own + begin, own, count));
      result.handed_up.middleCols(begin, count).noalias() -=
          whole.topRightCorner(own, boundary).transpose() * result.to_own.middleCols(begin, count);
    });
    for (const int child : front.children) {
      if (child >= 0) fronts_[at(child)].handed_up.resize(0, 0);
    }
  }

  // The matrix's rows of the front's own unknowns, and what the children hand up.
  Matrix assemble(const DissectedFront& front, Eigen::Index size) {
    std::vector<int> nodes = front.own;
    nodes.insert(nodes.end(), front.boundary.begin(), front.boundary.end());
    std::vector<std::pair<int, Eigen::Index>> places;  // of each node, by node
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      places.emplace_back(nodes[k], components_ * static_cast<Eigen::Index>(k));
    }
    std::ranges::sort(places);
    const auto place = [&](int node) {
      const auto found = std::lower_bound(places.begin(), places.end(), std::pair<int, Eigen::Index>(node, -1));
      return found != places.end() && found->first == node ? found->second : -1;
    };
    Matrix whole = Matrix::Zero(size, size);
    for (std::size_t k = 0; k < front.own.size(); ++k) {
      for (int c = 0; c < components_; ++c) {
        const Eigen::Index column = components_ * static_cast<Eigen::Index>(k) + c;
        for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix_, components_ * front.own[k] + c); entry;
             ++entry) {
          const int node = static_cast<int>(entry.row()) / components_;
          const Eigen::Index row = place(node);
          if (row < 0) continue;  // eliminated below
          const Eigen::Index at_row = row + entry.row() % components_;
          whole(at_row, column) = entry.value();
          whole(column, at_row) = entry.value();
        }
      }
    }
    for (const int child : front.children) {
      if (child >= 0) add_handed_up(child, place, whole);
    }
    return whole;
  }

  template <typename Place>
  void add_handed_up(int child, const Place& place, Matrix& whole) const {
    const Matrix& handed = fronts_[at(child)].handed_up;
    const std::vector<int>& nodes = tree_[at(child)].boundary;
    std::vector<Eigen::Index> to;
    for (const int node : nodes) {
      for (int c = 0; c < components_; ++c) to.push_back(place(node) + c);
    }
    for (Eigen::Index j = 0; j < handed.cols(); ++j) {
      for (Eigen::Index i = 0; i < handed.rows(); ++i) {
        whole(to[static_cast<std::size_t>(i)], to[static_cast<std::size_t>(j)]) += handed(i, j);
      }
    }
  }

  const Eigen::SparseMatrix<double>& matrix_;
  const std::vector<DissectedFront>& tree_;
  Eigen::Index components_;
  std::vector<Front> fronts_;
  std::atomic<bool> positive_ = true;
};

// Lays the fronts out as the run time reads them.
class FrontLayout {
 public:
  FrontLayout(const std::vector<DissectedFront>& tree, const InverseNodes& nodes, int components)
      : tree_(tree),
        nodes_(nodes),
        components_(static_cast<std::uint32_t>(components)),
        own_begin_(tree.size()),
        boundary_begin_(tree.size()) {
    inverse_.unknown_count = components_ * static_cast<std::uint32_t>(nodes.node_count);
    for (int level = 0; level < level_count(tree); ++level) add_slots(level);
    link_children();
  }

  void add_panels(const Factorisation& factors) {
    for (std::size_t level = 0; level < inverse_.levels.size(); ++level) {
      InverseLevel& range = inverse_.levels[level];
      range.up_begin = static_cast<std::uint32_t>(inverse_.up.size());
      range.down_begin = static_cast<std::uint32_t>(inverse_.down.size());
      for (const std::size_t f : fronts_of(tree_, static_cast<int>(level))) {
        const Front& front = factors.front(f);
        add_panels(front.inverse, own_begin_[f], own_begin_[f]);
        add_strips(front.to_own, own_begin_[f], boundary_begin_[f]);
        add_panels(front.to_own.transpose(), boundary_begin_[f], own_begin_[f]);
      }
      range.up_end = static_cast<std::uint32_t>(inverse_.up.size());
      range.down_end = static_cast<std::uint32_t>(inverse_.down.size());
    }
  }

  BlockInverse take() { return std::move(inverse_); }

 private:
  void add_slots(int level) {
    InverseLevel range{};
    range.first_slot = inverse_.slot_count();
    for (const std::size_t f : fronts_of(tree_, level)) own_begin_[f] = add_slots(tree_[f].own);
    range.own_end = inverse_.slot_count();
    for (const std::size_t f : fronts_of(tree_, level)) boundary_begin_[f] = add_slots(tree_[f].boundary);
    range.end_slot = inverse_.slot_count();
    inverse_.levels.push_back(range);
  }

  std::uint32_t add_slots(const std::vector<int>& nodes) {
    const std::uint32_t begin = inverse_.slot_count();
    for (const int node : nodes) {
      for (std::uint32_t c = 0; c < components_; ++c) {
        inverse_.slot_unknown.push_back(components_ * static_cast<std::uint32_t>(nodes_.nodes[at(node)]) + c);
      }
    }
    return begin;
  }

  void link_children() {
    inverse_.child_slots.assign(2 * inverse_.slot_unknown.size(), kNoSlot);
    std::vector<std::uint32_t> slot_of(tree_.empty() ? 0 : nodes_.nodes.size());
    for (std::size_t f = 0; f < tree_.size(); ++f) {
      mark(tree_[f].own, own_begin_[f], slot_of);
      mark(tree_[f].boundary, boundary_begin_[f], slot_of);
      for (std::size_t k = 0; k < 2; ++k) {
        if (tree_[f].children[k] < 0) continue;
        const auto child = at(tree_[f].children[k]);
        for (std::size_t b = 0; b < tree_[child].boundary.size(); ++b) {
          for (std::uint32_t c = 0; c < components_; ++c) {
            const std::size_t slot = slot_of[at(tree_[child].boundary[b])] + c;
            inverse_.child_slots[2 * slot + k] =
                boundary_begin_[child] + components_ * static_cast<std::uint32_t>(b) + c;
          }
        }
      }
    }
  }

  void mark(const std::vector<int>& nodes, std::uint32_t begin, std::vector<std::uint32_t>& slot_of) const {
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      slot_of[at(nodes[k])] = begin + components_ * static_cast<std::uint32_t>(k);
    }
  }

  // Adds the strips of a matrix whose panels come next.
  void add_strips(const Matrix& to_own, std::uint32_t first_slot, std::uint32_t first_input) {
    const auto own = static_cast<std::uint32_t>(to_own.rows()), boundary = static_cast<std::uint32_t>(to_own.cols());
    const auto first_value = static_cast<std::uint32_t>(inverse_.values.size());
    for (std::uint32_t begin = 0; begin < own; begin += kBlockSize) {
      inverse_.down.push_back({first_slot + begin, std::min(kBlockSize, own - begin), first_input, boundary,
                               first_value + begin * kBlockSize, own * kBlockSize});
    }
  }

  void add_panels(const Matrix& matrix, std::uint32_t first_slot, std::uint32_t first_input) {
    if (inverse_.values.size() + static_cast<std::uint64_t>((matrix.rows() + kBlockSize) * matrix.cols()) >
        UINT32_MAX) {
      throw Error(ErrorKind::mismatch, "the inverse has more than 2^32 numbers: fewer tets are needed");
    }
    constexpr Eigen::Index kRows = kBlockSize;
    for (Eigen::Index begin = 0; begin < matrix.rows(); begin += kRows) {
      const Eigen::Index rows = std::min(kRows, matrix.rows() - begin);
      inverse_.up.push_back({first_slot + static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(rows),
                             first_input, static_cast<std::uint32_t>(matrix.cols()),
                             static_cast<std::uint32_t>(inverse_.values.size())});
      for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
        for (Eigen::Index row = 0; row < kRows; ++row) {
          inverse_.values.push_back(row < rows ? static_cast<float>(matrix(begin + row, column)) : 0.0f);
        }
      }
    }
  }

  const std::vector<DissectedFront>& tree_;
  const InverseNodes& nodes_;
  std::uint32_t components_;
  std::vector<std::uint32_t> own_begin_, boundary_begin_;  // slots, by front
  BlockInverse inverse_;
};

Graph graph_of(const Eigen::SparseMatrix<double>& matrix, int components) {
  Graph graph(static_cast<std::size_t>(matrix.cols() / components));
  for (int node = 0; node < static_cast<int>(graph.size()); ++node) {
    std::vector<int>& near = graph[at(node)];
    for (int c = 0; c < components; ++c) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, components * node + c); entry; ++entry) {
        const int other = static_cast<int>(entry.row()) / components;
        if (other != node) near.push_back(other);
      }
    }
    std::ranges::sort(near);
    near.erase(std::unique(near.begin(), near.end()), near.end());
  }
  return graph;
}

}  // namespace

std::vector<DissectedFront> dissect(const Graph& graph, const Positions& points) {
  return Dissection(graph, points).take();
}

BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const InverseNodes& nodes, int components) {
  // A factorisation takes a NaN for a positive number.
  if (!Eigen::Map<const Eigen::ArrayXd>(matrix.valuePtr(), matrix.nonZeros()).allFinite()) {
    throw Error(ErrorKind::mismatch, "the system holds a number that is not finite");
  }
  const std::vector<DissectedFront> tree = dissect(graph_of(matrix, components), nodes.points);
  const Factorisation factors(matrix, tree, components);
  FrontLayout layout(tree, nodes, components);
  layout.add_panels(factors);
  return layout.take();
}

BlockInverse invert(const Eigen::SparseMatrix<double>& matrix, const Positions& points, int components) {
  InverseNodes all{points, std::vector<int>(static_cast<std::size_t>(points.rows())), static_cast<int>(points.rows())};
  std::iota(all.nodes.begin(), all.nodes.end(), 0);
  return invert(matrix, all, components);
}

}  // namespace bodyopt::trainer
