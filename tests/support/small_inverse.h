// The block inverse of a small dense system, made by hand: the kernel tests' own, beside the trainer's.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

struct SmallFront {
  std::vector<int> own, boundary;                 // unknowns
  Eigen::MatrixXd p, w;                           // F11^-1; F11^-1 F12
  std::uint32_t own_slot = 0, boundary_slot = 0;  // first ones
};

// Seven fronts, a perfect binary tree in heap order: 0 is the root, 2 f + 1 and 2 f + 2 are f's children. Front f owns
// `own` + f % 3 unknowns (none when `own` is 0), those under one front are joined to about a third of what fronts above
// own, and four unknowns are nobody's.
struct SmallInverse {
  static constexpr std::size_t kFronts = 7;

  SmallInverse(Random& random, std::uint32_t own);

  Eigen::MatrixXd matrix;  // of all unknowns; zeros for those that are nobody's
  std::array<SmallFront, kFronts> fronts;
  BlockInverse inverse;

 private:
  using Index = Eigen::Index;

  void share_unknowns(Random& random, std::uint32_t own);
  void make_matrix(Random& random);
  // Boundary, P and W of a front whose children have them.
  void factor(std::size_t f);
  void add_slots(std::size_t begin, std::size_t end);
  void add_panels(std::size_t begin, std::size_t end);
  void add_matrix(const Eigen::MatrixXd& m, std::uint32_t slot, std::uint32_t input);
  // Of W, the panels of whose transpose come next.
  void add_strips(const SmallFront& front);
  void add_child_slots();

  std::array<Eigen::MatrixXd, kFronts> updates_;
};

// Unknowns that a front owns: panels and workgroups that are empty, partly full, full, or many.
inline constexpr std::array<std::uint32_t, 7> kFrontSizes = {0, 1, 15, 16, 31, 64, 90};

// How right sides stand: as many as one says, side by side in groups of the other.
struct RightSides {
  std::uint32_t count, interleave;
};
inline constexpr std::uint32_t kLevels = 3;  // of a small inverse
inline constexpr std::array<RightSides, 4> kRightSides = {{{1, 1}, {2, 1}, {3, 3}, {6, 3}}};

// Where an unknown of right side r stands.
std::size_t place_of(const BlockInverse& inverse, RightSides sides, std::size_t r, std::size_t unknown);

}  // namespace bodyopt::testing
