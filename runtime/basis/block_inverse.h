// A sparse positive definite system, inverted once: solving it is a few dense products. Nested dissection (George 1973)
// splits the nodes into fronts, a binary tree; of each front the multifrontal factorisation (Duff and Reid 1983) keeps,
// instead of triangular factors, P = F11^-1 and W = F11^-1 F12 (own unknowns by own and boundary ones). One structure
// for diffuse (an unknown a node, three right sides) and jiggle (three unknowns a node).
//
// Each front has a slot per own unknown and one per boundary unknown (owned by fronts above it). A solve goes
//   up,   leaves to root:  b = right side - what the children hand up,  y = P b,  hands up W^T b + what they handed up
//   down, root to leaves:  x = y - W x_boundary
// A level is a set of fronts none of which is above another: its slots, and its panels, are solved side by side. Every
// sum has one order, whatever the threads: the same bits every time.
#pragma once

#include <cstdint>
#include <vector>

#include "shaders/include/layout.h"

namespace bodyopt {

struct InverseLevel {
  std::uint32_t first_slot, own_end, end_slot;  // own slots of all its fronts, then their boundary slots
  std::uint32_t up_begin, up_end;               // into up
  std::uint32_t down_begin, down_end;           // into down
};

struct BlockInverse {
  std::uint32_t unknown_count = 0;          // length of right sides and solutions; some unknowns may be nobody's
  std::vector<InverseLevel> levels;         // leaves first
  std::vector<std::uint32_t> slot_unknown;  // S: the unknown of every slot
  std::vector<std::uint32_t>
      child_slots;                 // S x 2: boundary slots, of lower levels, that hand up to this slot, or kNoSlot
  std::vector<InversePanel> up;    // rows of P (to own slots) and of W^T (to boundary slots), from own slots
  std::vector<InverseStrip> down;  // rows of W, from boundary slots to own ones
  std::vector<float> values;       // the panels' numbers

  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(slot_unknown.size()); }
};

// The value after the last that a panel, or a strip, takes. A strip without inputs takes none, wherever it begins: 0.
inline std::uint64_t end_value(const InversePanel& panel) {
  return panel.first_value + std::uint64_t{panel.input_count} * kBlockSize;
}
inline std::uint64_t end_value(const InverseStrip& strip) {
  if (strip.input_count == 0) return 0;
  return strip.first_value + (strip.input_count - 1) / kBlockSize * std::uint64_t{strip.panel_step} +
         std::uint64_t{strip.row_count} * kBlockSize;
}

}  // namespace bodyopt
