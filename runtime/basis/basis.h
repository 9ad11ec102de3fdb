// The trained character: plain arrays that the CPU reads and the GPU gets as they are. Made by the trainer, constant
// afterwards. Vertices are in runtime order (Morton order of the welded skin) unless a name says otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "shaders/include/layout.h"

namespace bodyopt {

// The skin. V welded vertices solve; O output vertices (seams split, as in the character's file) are what users get.
struct MeshTable {
  std::vector<float> rest;                           // V x 3, metres, rest space
  std::vector<std::uint32_t> triangles;              // T x 3, runtime vertex indices
  std::vector<std::uint32_t> output_vertex;          // O: runtime vertex of each output vertex
  std::vector<std::uint32_t> output_triangles;       // T' x 3, output vertex indices (for display and export)
  std::vector<std::uint32_t> vertex_triangle_begin;  // V + 1, CSR: the triangles around each vertex
  std::vector<std::uint32_t> vertex_triangles;       // 3T, in ascending order per vertex

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(rest.size() / 3); }
  // Blocks of kBlockSize vertices, the last one perhaps not full.
  std::uint32_t block_count() const { return (vertex_count() + kBlockSize - 1) / kBlockSize; }
  std::uint32_t output_count() const { return static_cast<std::uint32_t>(output_vertex.size()); }
};

// Direct Delta Mush, centred moments (Le & Lewis 2019, v0). See shaders/include/layout.h for the packing.
struct DdmTable {
  std::vector<std::uint32_t> block_begin;   // blocks + 1, into block_joints
  std::vector<std::uint32_t> block_joints;  // joint of each (block, joint) entry
  std::vector<std::uint32_t> moments;       // entries x kMomentWords x kBlockSize words
  std::vector<DdmVertex> vertices;          // blocks x kBlockSize; the lanes after V hold zeros
};

// Muscle fibres on the skin. The strain of a fibre is its length on the DDM base (un-posed displacement zero) over its
// rest length, minus one.
struct StrainTable {
  std::vector<std::uint32_t> vertices;     // runtime vertex of each strain vertex
  std::vector<FibrePoint> points;          // indices into vertices
  std::vector<std::uint32_t> fibre_begin;  // S + 1, into points
  std::vector<float> rest_length;          // S, metres, > 0
  std::vector<std::string> names;          // S: "<muscle>/<fibre number>"

  std::uint32_t fibre_count() const { return static_cast<std::uint32_t>(rest_length.size()); }
};

// Learned corrections fade to Direct Delta Mush where training did not show a pose.
//   off_j^2 = |D_j x_j|^2 + |what the features of joint j lie outside their ranges|^2,
//   fade_r  = 1 / (1 + sum_j w_rj max(0, off_j^2 - tolerance_j)).
// `x_j` holds the joint features (radians) of joint j, its parent and its children. D_j gives what of them lies in
// directions in which training never moved them, as far as it is joint j's own. There are such where joints only ever
// turned together. Joints are counted as in feature_joints(). All empty: nothing fades.
struct FadeTable {
  std::vector<std::uint32_t> joint_begin;      // joints + 1, into joints
  std::vector<std::uint32_t> joints;           // whose nine features each are x_j, one after the other
  std::vector<std::uint32_t> direction_begin;  // joints + 1: rows of D before those of the joint
  std::vector<float> directions;               // row-major, joint by joint; a row has as many numbers as x_j
  std::vector<float> tolerance;                // per joint: the largest off_j^2 of training, radians squared
  std::vector<std::uint32_t> region_begin;     // regions + 1, into region_joints and region_weights
  std::vector<std::uint32_t> region_joints;    // ascending within a region
  std::vector<float> region_weights;           // w_rj >= 0, 1 / radians squared

  bool empty() const { return joint_begin.empty(); }
};

// The un-posed displacement learned from shapes:
//   p_r = P_r f_r,  c_r = fade_r W_r [1, p_r, phi(p_r)],  phi_m = exp(-|p_r - centre_m|^2 inverse_width2),
//   delta d_i = sum over the blend entries of the block of i of (c_k - c_k at rest) b_ik   (un-posed space, metres)
struct ResidualTable {
  std::vector<std::string> controls;   // names of the control features, in order
  std::vector<FeatureRange> features;  // F = joint features, strains, controls
  std::vector<Region> regions;
  std::vector<std::uint32_t> region_features;    // feature indices, region by region
  std::vector<std::uint32_t> coordinate_region;  // region of each coordinate
  // P: per region coordinate_count rows of feature_count halves, two a word (low half first). A row begins at a word:
  // after an odd count, the last word's high half is unused.
  std::vector<std::uint32_t> projections;
  std::vector<std::uint32_t> centre_region;  // region of each centre
  std::vector<std::uint32_t> centres;        // per region centre_count rows of coordinate_count halves, in words as P
  std::vector<std::uint32_t> coefficient_region;  // region of each coefficient
  std::vector<float> weights;  // per region coefficient_count x (1 + coordinate_count + centre_count), row-major
  std::vector<std::uint32_t> blend_begin;  // blocks + 1, into blend
  std::vector<BlendEntry> blend;           // at most 65,536 coefficients
  FadeTable fade;

  std::uint32_t coordinate_count() const { return static_cast<std::uint32_t>(coordinate_region.size()); }
  std::uint32_t coefficient_count() const { return static_cast<std::uint32_t>(coefficient_region.size()); }
  std::uint32_t centre_count() const { return static_cast<std::uint32_t>(centre_region.size()); }
  std::uint32_t feature_count() const { return static_cast<std::uint32_t>(features.size()); }
};

// A joint that goes with a component: turned about an axis in its parent's bind axes, left of its own rotation.
struct ModifierTurn {
  std::uint32_t joint = 0;
  std::uint32_t component = 0;  // of the modifier, from 0 on
  float x = 0, y = 0, z = 0;    // radians per unit of the component's weight
};

struct SkinModifier {
  std::string name;  // of its channels: "breath" is its strength, "breath.rate" a control
  std::string type;  // see skin_modifier_types()
  bool on = true;
  std::map<std::string, float> constants;  // of controls for which a clip has no channel; "strength" among them
  std::uint32_t first_component = 0, component_count = 0;
  std::vector<ModifierTurn> turns;
  std::vector<std::uint32_t> joints;  // what the type says of them
  std::vector<float> numbers;         // what the type says of them
};

// Modifiers of the skin at run time are the last word of an animator on it: breathing, sculpts, morphs. Each adds
//   delta d_i += sum_k w_k b_ki      (un-posed space, metres)
// and may turn joints, or moves the posed skin in the end (PosedSkinType). A function of its type makes the weights w_k
// of channels over time (runtime/modifiers). The trainer makes modifiers; afterwards a shot chooses only order,
// switches, strengths and constants.
struct SkinModifiers {
  std::vector<SkinModifier> stack;         // in the order in which they are applied
  std::vector<std::uint32_t> blend_begin;  // blocks + 1, into blend; empty without modifiers
  std::vector<BlendEntry> blend;           // as of the residual; a component in place of a coefficient

  bool empty() const { return stack.empty(); }
  std::uint32_t component_count() const;
  bool turn_joints() const;
  bool move_posed_skin() const;
  const SkinModifier* of_type(const std::string& type) const;  // the first of a type, or null
};

// The error that the basis expects of itself, by region of the residual: see runtime/coverage/expected_error.h. All
// empty: unknown, as for Direct Delta Mush alone, which was trained without shapes.
struct CoverageTable {
  std::vector<std::string> names;          // of the regions
  std::vector<std::uint32_t> joint_begin;  // regions + 1, into joints
  std::vector<std::uint32_t> joints;       // that move the region's skin, most of all first; at least one
  std::vector<float> sizes;                // per region: its vertices, by their weights, > 0
  std::vector<float> growth;               // per region: of the squared error, summed over its vertices, with each unit
                                           // of squared distance of coordinates, square metres
  std::vector<float> usual;                // per region: squared distance from a held-out frame to the nearest centre
  std::vector<float> local;                // per centre, or one number for a region without: what is left there, RMS
                                           // over the region's vertices, metres
  std::vector<float> motion;               // the same of Direct Delta Mush alone; empty in older files: not known
  std::vector<float> metric;               // per coordinate, what its squared differences count; empty: 1

  bool empty() const { return joint_begin.empty(); }
};

// Training writes strings here: schema, units, topology_hash, skeleton_hash, provenance, report (JSON text).
using Metadata = std::map<std::string, std::string>;

struct Basis {
  Skeleton skeleton;
  MeshTable mesh;
  DdmTable ddm;
  StrainTable strain;      // empty when trained without muscles
  ResidualTable residual;  // empty (no regions, blend_begin of blocks + 1 zeros) for DDM only
  CoverageTable coverage;
  SkinModifiers modifiers;  // empty but where `bodyopt modifiers` gave it some
  Metadata metadata;
};

// Checks every count, offset, index and number of a basis, so that no kernel reads outside a table or makes a NaN of
// it. Throws Error(file) whose text starts with `origin` (a path, or what made the basis).
void validate(const Basis& basis, const std::string& origin);

// Safetensors with a schema version, an xxh3 checksum and the metadata. Written whole or not. Throws Error(file).
void save_basis(const Basis& basis, const std::filesystem::path& path);
Basis load_basis(const std::filesystem::path& path);

// Bytes of the tables a frame needs at run time, by stage: "ddm", "strain", "residual", "modify" with modifiers.
std::map<std::string, std::size_t> table_bytes(const Basis& basis);
std::size_t total_bytes(const Basis& basis);  // of all of them

// xxh3 of the welded triangles and the output map: shapes and bases of one character agree in it.
std::uint64_t topology_hash(const MeshTable& mesh);

}  // namespace bodyopt
