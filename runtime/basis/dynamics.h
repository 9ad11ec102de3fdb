// The tables of diffuse and jiggle: an optional second file beside the basis. Made by the trainer, constant afterwards.
// N nodes of T tetrahedra fill the body; the first B nodes lie on the skin. Rest space, metres, unless a name says
// otherwise. Skin vertices are in the basis' runtime order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "shaders/include/layout.h"

namespace bodyopt {

// A sparse positive definite system, inverted once, so that solving it is a few dense products. Nested dissection
// (George 1973) splits the nodes into a binary tree of fronts. Multifrontal factorisation (Duff and Reid 1983) here
// keeps P = F11^-1 (own by own unknowns) and W = F11^-1 F12 (own by boundary) of each. Triangular factors are not
// needed. Diffuse (one unknown a node, three right sides) and jiggle (three unknowns a node) share this structure.
//
// Each front has a slot per own unknown and one per boundary unknown (owned by fronts above it). A solve goes
//   up,   leaves to root:  b = right side - what the children hand up,  y = P b,  hands up W^T b + what they handed up,
//   down, root to leaves:  x = y - W x_boundary.
// A level is a set of fronts none of which is above another: its slots, and its panels, are solved side by side. Every
// sum has one order, whatever the threads: the same bits every time.

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

struct Safetensors;

struct TetTable {
  std::vector<float> nodes;                 // N x 3
  std::vector<std::uint32_t> tets;          // T x 4, positive volume
  std::vector<TetShape> shapes;             // T
  std::vector<std::uint32_t> corner_begin;  // N + 1, into corners
  std::vector<std::uint32_t> corners;       // 4T: 4 x tet + corner of every corner at a node, ascending per node
  std::vector<SurfacePoint> surface;        // B: where the skin carries each node that lies on it
  std::vector<TetPoint> skin;               // V: which tet carries each skin vertex, and how much of it
  std::vector<float> skin_limit;            // V: metres that no displacement of each reaches; kNoLimit: any

  std::uint32_t node_count() const { return static_cast<std::uint32_t>(nodes.size() / 3); }
  std::uint32_t tet_count() const { return static_cast<std::uint32_t>(shapes.size()); }
  std::uint32_t surface_count() const { return static_cast<std::uint32_t>(surface.size()); }
};

// X_I = L_II^-1 (-L_IB X_B), L the finite-element (cotangent) Laplacian of the rest tets: exact for rotations.
struct DiffuseTable {
  std::vector<std::uint32_t> row_begin;  // N + 1, into columns; no entries for the first B nodes
  std::vector<std::uint32_t> columns;    // nodes on the skin
  std::vector<float> values;             // -L_IB
  BlockInverse inverse;                  // of L_II: unknowns are nodes
};

// How the time step is taken, and what of the material is the same everywhere.
struct JiggleStep {
  float frames_per_second = 24;
  std::uint32_t substeps = 1;   // steps a frame
  bool implicit_euler = false;  // instead of TR-BDF2: of files of earlier versions
  float stiffness_damping = 0;  // beta of C = alpha M + beta K, seconds

  float length() const { return 1 / (frames_per_second * static_cast<float>(substeps)); }  // h, seconds
  // `d`: the system is A = M/d^2 + C/d + K. Both stages of TR-BDF2 have d = gamma h / 2, gamma = 2 - sqrt(2) (Bank et
  // al. 1985). Implicit Euler has d = h.
  float stage() const { return implicit_euler ? length() : 0.29289321881345254f * length(); }
};

// One linear finite-element step of the displacement from the quasi-static tets (docs/pipeline/jiggle.md).
struct JiggleTable {
  JiggleStep step;
  std::vector<JiggleNode> nodes;  // N
  BlockInverse inverse;           // of A: unknowns are 3 x node + axis, in the nodes' rotated frames
  // N, N/m: the springs that hold each node, those it shares with others included. `inverse` has them: no step reads
  // them, but displays of what is held do.
  std::vector<float> springs;
};

struct Dynamics {
  TetTable tets;
  DiffuseTable diffuse;
  JiggleTable jiggle;
  Metadata metadata;          // topology_hash and skeleton_hash of the basis it belongs to, provenance, report
  std::string file_checksum;  // of the file that they were read from; empty: none
};

// Checks every count, offset, index and number, and that it belongs to the basis. Throws Error(file) or
// Error(mismatch) whose text starts with `origin`.
void validate(const Dynamics& dynamics, const Basis& basis, const std::string& origin);

// Safetensors, as save_basis. Throws Error(file).
void save_dynamics(const Dynamics& dynamics, const std::filesystem::path& path);
// Checked against the basis. Throws Error(file), Error(mismatch).
Dynamics load_dynamics(const std::filesystem::path& path, const Basis& basis);

// The path of a basis' dynamics: hero.dynamics.safetensors beside hero.safetensors.
std::filesystem::path dynamics_beside(std::filesystem::path basis);

// How a file of dynamics is stepped, without the basis it belongs to. Throws Error(file).
JiggleStep read_step(const Safetensors& file, const std::filesystem::path& path);

// The checksum of all tables and metadata, as in the file that was read or would be written: 16 hexadecimal digits.
std::string checksum(const Dynamics& dynamics);

// Bytes of the tables a frame needs, by stage: "diffuse", "jiggle" (the tets count with diffuse).
std::map<std::string, std::size_t> table_bytes(const Dynamics& dynamics);

}  // namespace bodyopt
