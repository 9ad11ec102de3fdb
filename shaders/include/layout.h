// Shared by GLSL and C++: records of the tables, push constants, sizes. Only 4-byte scalars, so that std430 and C++
// agree; static_assert holds the sizes.
#ifndef BODYOPT_LAYOUT_H
#define BODYOPT_LAYOUT_H

#ifdef __cplusplus
#include <cstdint>
namespace bodyopt {
using uint = std::uint32_t;
#define BODYOPT_CHECK_SIZE(type, bytes) static_assert(sizeof(type) == bytes, #type " differs between C++ and GLSL");
#else
#define BODYOPT_CHECK_SIZE(type, bytes)
#endif

const uint kWorkgroupSize = 64u;

// Frames that an invocation of a kernel with kFrames takes, where there are as many: it reads the tables once for them.
const uint kFramesTogether = 4u;

// Vertices stand in blocks of 16 in Morton order; the vertices of a block share one list of joints.
const uint kBlockSize = 16u;

// One (block, joint) entry of the DDM table is kMomentWords x kBlockSize words, word-major. Word w of lane l stands at
// (entry * kMomentWords + w) * kBlockSize + l.
//   Words 0..2: six halves, S_xx S_xy | S_xz S_yy | S_yz S_zz  (low half first), divided by r^2.
//   Words 3..5: floats, s_x s_y s_z, divided by r^2.
//   Word  6:    float, omega.
const uint kMomentWords = 7u;

// Per vertex of the DDM table (rest space, metres).
struct DdmVertex {
  float centre_x, centre_y, centre_z;  // p_i, the smoothed rest position
  float radius2;                       // r_i^2 = tr(sum_j S_ij), the moments' scale
  float offset_x, offset_y, offset_z;  // d_i = u_i - p_i
  uint base_joint;                     // the joint with the largest omega
};
BODYOPT_CHECK_SIZE(DdmVertex, 32)

// An output vertex, as its tangent needs it: its vertex of the skin, its corners of triangles, and the tangent's sign.
struct TangentVertex {
  uint vertex, corner_begin, corner_end;
  float sign;
};
BODYOPT_CHECK_SIZE(TangentVertex, 16)

// A corner of a triangle there: the other two corners, vertices of the skin. The triangle's tangent is along_b of the
// edge to b, and along_c of that to c.
struct TangentCorner {
  uint b, c;
  float along_b, along_c;
};
BODYOPT_CHECK_SIZE(TangentCorner, 16)

// A point of a fibre on the skin: barycentric over three entries of the strain table's vertex list.
struct FibrePoint {
  uint a, b, c;
  float wa, wb, wc;
};
BODYOPT_CHECK_SIZE(FibrePoint, 24)

// How one feature is clamped to the trained range, then standardised: (clamp(x, low, high) - mean) * inverse_scale.
struct FeatureRange {
  float low, high, mean, inverse_scale;
};
BODYOPT_CHECK_SIZE(FeatureRange, 16)

// A region of the residual. Offsets are in elements of the table named.
struct Region {
  uint feature_begin, feature_count;          // into region_features
  uint coordinate_begin, coordinate_count;    // coordinate index over all regions
  uint projection_values;                     // word of projections at which the region's rows begin
  uint centre_begin, centre_count;            // centre index over all regions; kernel values have the same index
  uint centre_values;                         // word of centres at which the region's centres begin
  uint coefficient_begin, coefficient_count;  // coefficient index over all regions
  uint weight_values;                         // offset of the region's rows in weights
  float inverse_width2;                       // 1 / (2 width^2), in units of the coordinates
};
BODYOPT_CHECK_SIZE(Region, 48)

// Words of one signed byte per lane of a block.
const uint kLaneWords = kBlockSize / 4u;

// One (block, coefficient) entry of the residual's blend, or (block, component) entry of the modifiers'. The numbers
// are x of all lanes, then y, then z, four lanes to a word, the lowest lane in the lowest byte. The basis vector at a
// lane is scale * kBlendFraction times its three numbers; the lanes after V hold zeros.
struct BlendEntry {
  uint scale_coefficient;         // half scale (low), coefficient index (high 16 bits)
  uint numbers[3u * kLaneWords];  // four signed bytes each
};
BODYOPT_CHECK_SIZE(BlendEntry, 52)

// A power of two: its product with a half is exact. It stands beside the scale, not in it, so that scales stay far from
// the subnormal halves, which a device may read as 0.
const float kBlendFraction = 1.0f / 128.0f;

// Rows of a dense matrix of a block inverse (runtime/basis/dynamics.h), kBlockSize of them (the last may be less:
// its other rows hold zeros). Column c of the panel's rows stands at value first_value + c * kBlockSize.
struct InversePanel {
  uint first_slot, row_count;     // slots that the rows give
  uint first_input, input_count;  // slots that the columns take
  uint first_value;
};
BODYOPT_CHECK_SIZE(InversePanel, 20)

// The numbers of W are read the other way on the way down. Own slots, kBlockSize of them (the last strip of a front may
// have less), take the panels of W^T. These stand one after the other, panel_step values apart.
struct InverseStrip {
  uint first_slot, row_count;     // own slots that get a solution
  uint first_input, input_count;  // boundary slots
  uint first_value, panel_step;   // of the first panel's column of first_slot
};
BODYOPT_CHECK_SIZE(InverseStrip, 24)

// No boundary slot of a child hands up to this one.
const uint kNoSlot = 0xffffffffu;

// A row times a vector is summed on the way up in four parts: columns 0 4 8.., 1 5 9.., and so on. Then the parts are
// added: (0 + 1) + (2 + 3).
const uint kSumParts = 4u;
// A row is summed on the way down in kBlockSize parts, one per row of the panels. Then halves are added: 0 + 8, 1 + 9,
// .., 0 + 4, .., 0 + 2, .., 0 + 1.

// A tet at rest: D^-1 (row-major), D the edges from corner 0 to the others as columns, 1/m; its volume, m^3.
struct TetShape {
  float inverse_edges[9];
  float volume;
};
BODYOPT_CHECK_SIZE(TetShape, 40)

// A node that lies on the skin: barycentric over three skin vertices.
struct SurfacePoint {
  uint a, b, c;
  float wa, wb, wc;
};
BODYOPT_CHECK_SIZE(SurfacePoint, 24)

// A skin vertex in a tet: barycentric weights (below 0 where it lies a little outside), and how much of the tet's
// displacement it takes.
struct TetPoint {
  uint tet;
  float w0, w1, w2, w3;
  float amount;
};
BODYOPT_CHECK_SIZE(TetPoint, 24)

const float kNoLimit = 1e18f;  // metres: no displacement of a skin vertex is cut; its square is a float, too

// A node of the jiggle step. A muscle that is active holds its nodes by springs of their own.
struct JiggleNode {
  float mass;                     // kg, lumped: a quarter of each tet's
  float inertia;                  // mass / d^2 + alpha mass / d, kg/s^2
  uint first_fibre, fibre_count;  // of the muscle the node is in, in the strain table; 0: none
  uint control;                   // that flexes the muscle, or kNoControl
  float stiffening;               // squared angular frequency of the springs at full activation, 1/s^2
};
BODYOPT_CHECK_SIZE(JiggleNode, 24)
const uint kNoControl = 0xffffffffu;

// Metres and metres a second below which a node stands still. What swings out ever slower would end in subnormal
// numbers, with which processors are slow.
const float kStill = 1e-15f;

// A fibre shorter by this share of its rest length is fully active.
const float kFullActivationStrain = 0.2f;

// The number of steps in which skin is relaxed, and in which skin that has crossed skin is taken out of it.
const uint kRelaxSteps = 4u, kSeparateSteps = 5u;

// So many triangles, one after the other, share a box, which finds those that a line may meet.
const uint kBoxTriangles = 8u;

// Push constants, one record per kernel. Every kernel runs over (element, frame) = (x, y).
struct StrainSkinPush {
  uint strain_vertex_count, joint_count;  // strain_vertex_count: length of the strain table's vertex list
  uint first_vertex, end_vertex;          // the window of the DDM table bound; others are left to other dispatches
  uint first_entry;                       // entry at which the bound moments begin
  uint first_frame;                       // of the dispatch
};
struct StrainMeasurePush {
  uint fibre_count, strain_vertex_count;
};
struct ResidualFeaturesPush {
  uint joint_feature_count, strain_count, control_count;
};
struct ResidualProjectPush {
  uint coordinate_count, feature_count;  // over all regions
};
struct ResidualKernelsPush {
  uint centre_count, coordinate_count;  // over all regions
};
struct ResidualCoefficientsPush {
  uint coefficient_count, coordinate_count, centre_count, region_count;
};
struct ResidualBlendPush {
  uint vertex_count, coefficient_count;
  float weight;                   // of the displacement; 1: as trained
  uint first_vertex, end_vertex;  // the window of the blend bound
  uint first_entry;               // entry at which it begins
  uint first_frame;               // of the dispatch
};
struct ModifyBlendPush {
  uint vertex_count, component_count;
  uint first_vertex, end_vertex;  // the window of the blend bound
  uint first_entry;               // entry at which it begins
  uint first_frame;               // of the dispatch
};
struct PoseSkinPush {
  uint vertex_count, joint_count;
  uint first_vertex, end_vertex;  // the window of the DDM table bound; vertices run from first_vertex
  uint first_entry;               // entry at which the bound moments begin
  uint first_frame;               // of the dispatch
};
struct OutputRelaxPush {
  uint vertex_count, component_count, component;  // the last: whose weight says how much is shown
  uint first_vertex, end_vertex;                  // the window of the fans bound
  uint first_triangle;                            // of the fans, at which it begins
};
struct OutputBoundPush {
  uint vertex_count, triangle_count, box_count;
};
struct OutputSeparatePush {
  uint vertex_count, triangle_count, box_count;
  uint component_count, component;  // the last: the first of three that are a fold's normal
  uint fold_count;
  uint step;    // from 0
  float limit;  // metres that a vertex moves at most
};
struct OutputPlacePush {
  uint output_count, vertex_count;
  uint first_word, element_words, frame_words;  // of what is placed
};
struct OutputTangentsPush {
  uint output_count, vertex_count;
  uint first_word, element_words, frame_words;  // of what is written
};
struct OutputNormalsPush {
  uint vertex_count;
  uint first_vertex, end_vertex;  // the window of the fans bound
  uint first_triangle;            // of the fans, at which it begins
};
struct DiffuseSurfacePush {
  uint surface_count, vertex_count, node_count;
};
struct DiffuseGatherPush {
  uint surface_count, node_count;
};
// The block inverse's elements are slots (gather) or rows of panels (up, down), its "frames" right sides.
struct BlockGatherPush {
  uint first_slot, own_end, end_slot;  // of the level
  uint slot_count, unknown_count, interleave;
};
struct BlockUpPush {
  uint first_panel, panel_count;  // of the window of the level
  uint first_value;               // value at which the bound values begin
  uint own_end, slot_count;
};
struct BlockDownPush {
  uint first_strip, strip_count;  // of the window of the level
  uint first_value;               // value at which the bound values begin
  uint slot_count, unknown_count, interleave;
};
struct JiggleRotatePush {
  uint node_count;
};

// Parts of a motion, of 3 N numbers each: that of the frame before, for instance, is one buffer.
const uint kMotionDisplacement = 0u, kMotionVelocity = 1u, kMotionNodes = 2u, kMotionNodeVelocity = 3u;

// The kernels of a jiggle step run over one frame, the one of this number in arrays that hold a batch.
struct JiggleKickPush {
  uint node_count, frame;
  uint start;              // frames before that are known: 0, 1, or 2 for all that are needed
  float inverse_interval;  // 1/s
  float origin_step_x, origin_step_y, origin_step_z;  // of the origin since the frame before, metres
};
struct JiggleStepPush {
  uint node_count, frame;
  uint fibre_count, control_count;
  float duration;                              // h, seconds
  float stage;                                 // d, seconds
  float gravity_x, gravity_y, gravity_z;       // change of gravity against that of the shapes, m/s^2
  float velocity_weight, displacement_weight;  // of the next right side: 1/s, 1
  float u_from_u, u_from_z;
  float v_from_u, v_from_z, v_from_v;
};
struct JiggleSkinPush {
  uint vertex_count, frame;
  float weight;  // of the displacement; 1: as it is
};

#ifdef __cplusplus
#undef BODYOPT_CHECK_SIZE
}  // namespace bodyopt
#endif
#endif
