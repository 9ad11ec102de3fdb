#include "tests/support/small_inverse.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

namespace bodyopt::testing {

SmallInverse::SmallInverse(Random& random, std::uint32_t own) {
  share_unknowns(random, own);
  make_matrix(random);
  for (std::size_t f = kFronts; f-- > 0;) factor(f);
  for (const std::size_t begin : {3, 1, 0}) {
    add_slots(begin, 2 * begin + 1);
    add_panels(begin, 2 * begin + 1);
  }
  add_child_slots();
}

void SmallInverse::share_unknowns(Random& random, std::uint32_t own) {
  std::vector<int> order;
  const auto size_of = [&](std::size_t f) { return own == 0 ? 0 : own + f % 3; };
  for (std::size_t f = 0; f < kFronts; ++f) inverse.unknown_count += static_cast<std::uint32_t>(size_of(f));
  inverse.unknown_count += 4;
  for (std::uint32_t q = 0; q < inverse.unknown_count; ++q) order.push_back(static_cast<int>(q));
  for (std::uint32_t q = inverse.unknown_count; q > 1; --q) std::swap(order[q - 1], order[random.below(q)]);
  auto next = order.begin();
  for (std::size_t f = 0; f < kFronts; ++f) {
    const auto end = next + static_cast<std::ptrdiff_t>(size_of(f));
    fronts[f].own.assign(next, end);
    next = end;
  }
}

void SmallInverse::make_matrix(Random& random) {
  matrix.setZero(inverse.unknown_count, inverse.unknown_count);
  const auto join = [&](int a, int b) { matrix(a, b) = matrix(b, a) = random.uniform(-1, 1); };
  for (std::size_t f = 0; f < kFronts; ++f) {
    const std::vector<int>& own = fronts[f].own;
    for (const int a : own) {
      for (const int b : own) join(a, b);
    }
    for (std::size_t above = f; above > 0;) {
      above = (above - 1) / 2;
      for (const int b : fronts[above].own) {
        if (random.below(3) > 0) continue;
        for (const int a : own) join(a, b);
      }
    }
  }
  for (const SmallFront& front : fronts) {
    for (const int a : front.own) matrix(a, a) = 1 + matrix.row(a).cwiseAbs().sum();
  }
}

void SmallInverse::factor(std::size_t f) {
  SmallFront& front = fronts[f];
  const auto children =
      2 * f + 1 < kFronts ? std::vector<std::size_t>{2 * f + 1, 2 * f + 2} : std::vector<std::size_t>();
  std::vector<bool> is_boundary(inverse.unknown_count);
  for (std::size_t above = f; above > 0;) {
    above = (above - 1) / 2;
    for (const int b : fronts[above].own) {
      for (const int a : front.own)
        is_boundary[static_cast<std::size_t>(b)] = is_boundary[static_cast<std::size_t>(b)] || matrix(a, b) != 0;
    }
  }
  for (const std::size_t child : children) {
    for (const int b : fronts[child].boundary) is_boundary[static_cast<std::size_t>(b)] = true;
  }
  for (const int a : front.own) is_boundary[static_cast<std::size_t>(a)] = false;
  for (std::size_t q = 0; q < is_boundary.size(); ++q) {
    if (is_boundary[q]) front.boundary.push_back(static_cast<int>(q));
  }
  std::vector<int> all = front.own;
  all.insert(all.end(), front.boundary.begin(), front.boundary.end());
  const auto own = static_cast<Index>(front.own.size()), boundary = static_cast<Index>(front.boundary.size());
  Eigen::MatrixXd frontal = matrix(all, all);
  frontal.bottomRightCorner(boundary, boundary).setZero();  // theirs
  for (const std::size_t child : children) {
    std::vector<Index> places;
    for (const int b : fronts[child].boundary) places.push_back(std::ranges::find(all, b) - all.begin());
    frontal(places, places) += updates_[child];
  }
  const Eigen::MatrixXd f12 = frontal.topRightCorner(own, boundary);
  front.p = frontal.topLeftCorner(own, own).inverse();
  front.w = front.p * f12;
  updates_[f] = frontal.bottomRightCorner(boundary, boundary) - f12.transpose() * front.w;
}

void SmallInverse::add_slots(std::size_t begin, std::size_t end) {
  std::vector<std::uint32_t>& slots = inverse.slot_unknown;
  InverseLevel level{};
  level.first_slot = inverse.slot_count();
  for (std::size_t f = begin; f < end; ++f) {
    fronts[f].own_slot = inverse.slot_count();
    slots.insert(slots.end(), fronts[f].own.begin(), fronts[f].own.end());
  }
  level.own_end = inverse.slot_count();
  for (std::size_t f = begin; f < end; ++f) {
    fronts[f].boundary_slot = inverse.slot_count();
    slots.insert(slots.end(), fronts[f].boundary.begin(), fronts[f].boundary.end());
  }
  level.end_slot = inverse.slot_count();
  inverse.levels.push_back(level);
}

void SmallInverse::add_panels(std::size_t begin, std::size_t end) {
  InverseLevel& level = inverse.levels.back();
  level.up_begin = static_cast<std::uint32_t>(inverse.up.size());
  level.down_begin = static_cast<std::uint32_t>(inverse.down.size());
  for (std::size_t f = begin; f < end; ++f) {
    const SmallFront& front = fronts[f];
    add_matrix(front.p, front.own_slot, front.own_slot);
    add_strips(front);
    add_matrix(front.w.transpose(), front.boundary_slot, front.own_slot);
  }
  level.up_end = static_cast<std::uint32_t>(inverse.up.size());
  level.down_end = static_cast<std::uint32_t>(inverse.down.size());
}

void SmallInverse::add_matrix(const Eigen::MatrixXd& m, std::uint32_t slot, std::uint32_t input) {
  for (Index first = 0; first < m.rows(); first += kBlockSize) {
    const Index rows = std::min<Index>(kBlockSize, m.rows() - first);
    inverse.up.push_back({slot + static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(rows), input,
                          static_cast<std::uint32_t>(m.cols()), static_cast<std::uint32_t>(inverse.values.size())});
    for (Index column = 0; column < m.cols(); ++column) {
      for (Index row = 0; row < kBlockSize; ++row) {
        inverse.values.push_back(row < rows ? static_cast<float>(m(first + row, column)) : 0);
      }
    }
  }
}

void SmallInverse::add_strips(const SmallFront& front) {
  const auto own = static_cast<std::uint32_t>(front.own.size()),
             values = static_cast<std::uint32_t>(inverse.values.size());
  for (std::uint32_t first = 0; first < own; first += kBlockSize) {
    inverse.down.push_back({front.own_slot + first, std::min(kBlockSize, own - first), front.boundary_slot,
                            static_cast<std::uint32_t>(front.boundary.size()), values + first * kBlockSize,
                            own * kBlockSize});
  }
}

void SmallInverse::add_child_slots() {
  inverse.child_slots.assign(2 * inverse.slot_unknown.size(), kNoSlot);
  for (std::size_t f = 1; f < kFronts; ++f) {
    const SmallFront &child = fronts[f], &parent = fronts[(f - 1) / 2];
    for (std::size_t k = 0; k < child.boundary.size(); ++k) {
      const auto own = std::ranges::find(parent.own, child.boundary[k]);
      const std::size_t slot =
          own != parent.own.end()
              ? parent.own_slot + static_cast<std::size_t>(own - parent.own.begin())
              : parent.boundary_slot + static_cast<std::size_t>(std::ranges::find(parent.boundary, child.boundary[k]) -
                                                                parent.boundary.begin());
      inverse.child_slots[2 * slot + (f - 1) % 2] = child.boundary_slot + static_cast<std::uint32_t>(k);
    }
  }
}

std::size_t place_of(const BlockInverse& inverse, RightSides sides, std::size_t r, std::size_t unknown) {
  const std::size_t group = r / sides.interleave, member = r % sides.interleave;
  return (group * inverse.unknown_count + unknown) * sides.interleave + member;
}

}  // namespace bodyopt::testing
