// The CPU path: one function per kernel over the GPU's own tables, one file each. What every Vulkan kernel is compared
// with, and the backend of machines without one. The heavy ones work on the lanes of a block (runtime/cpu/lanes.h). All
// arrays are frame-major over frame_count frames; shapes are those of runtime/basis/basis.h and
// runtime/deformer/deformer.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "runtime/basis/basis.h"

namespace bodyopt {
struct FoldTables;
struct TangentTables;
}  // namespace bodyopt

namespace bodyopt::cpu {

// Strain stage: DDM base positions (delta d = 0), relative to the frame's origin, of the strain table's vertices. Takes
// skinning F x J x 12 -> positions F x P x 3, metres.
void strain_skin(const DdmTable& ddm, const StrainTable& strain, std::uint32_t joint_count,
                 std::span<const float> skinning, std::span<float> positions);

// Does one frame, where the frames of all blocks are known (runtime/cpu/ddm_frames.h).
void place_strain_vertices(const DdmTable& ddm, const StrainTable& strain, std::span<const float> frames,
                           std::span<float> positions);

// Strain stage: length of every fibre over its rest length, minus one. positions F x P x 3 -> strains F x S.
void strain_measure(const StrainTable& strain, std::span<const float> positions, std::span<float> strains);

// Residual stage: clamps joint features, strains and controls, one after the other, to the trained range, and
// standardises them. Their `excess` is the distance outside that range times inverse_scale. `ranges`: of each feature.
// -> features, excess F x feature_count.
void residual_features(std::span<const FeatureRange> ranges, std::span<const float> joint_features,
                       std::span<const float> strains, std::span<const float> controls, std::uint32_t frame_count,
                       std::span<float> features, std::span<float> excess);

// Residual stage: p_r = P_r f_r. features -> coordinates F x coordinate_count.
void residual_project(const ResidualTable& residual, std::span<const float> features, std::uint32_t frame_count,
                      std::span<float> coordinates);
// Does one frame and one region.
void region_coordinates(const ResidualTable& residual, std::size_t region, const float* features, float* coordinates);

// Residual stage: phi = exp(-|p_r - centre|^2 inverse_width2). coordinates -> kernels F x centre_count.
void residual_kernels(const ResidualTable& residual, std::span<const float> coordinates, std::uint32_t frame_count,
                      std::span<float> kernels);
// Does one frame and one region.
void region_kernels(const ResidualTable& residual, std::size_t region, const float* coordinates, float* kernels);

// Residual stage: c_r = fade_r (W_r [1, p_r, phi_r] - c_r at rest). fades: F x regions.
// -> coefficients F x coefficient_count.
void residual_coefficients(const ResidualTable& residual, std::span<const float> coordinates,
                           std::span<const float> kernels, std::span<const float> rest_coefficients,
                           std::span<const float> fades, std::uint32_t frame_count, std::span<float> coefficients);
// Does one frame and one region.
void region_coefficients(const ResidualTable& residual, std::size_t region, const float* coordinates,
                         const float* kernels, std::span<const float> rest_coefficients, float fade,
                         float* coefficients);

// Residual stage: weight x un-posed displacement of every vertex. coefficients -> displacements F x V x 3, metres.
void residual_blend(const ResidualTable& residual, std::span<const float> coefficients, std::uint32_t frame_count,
                    float weight, std::span<float> displacements);
// Does one frame and as many blocks as displacements hold, from first_block on.
void blend_blocks(const ResidualTable& residual, const float* coefficients, float weight, std::uint32_t first_block,
                  std::span<float> displacements);

// Modify stage: adds what the modifiers' components give, sum_k w_k b_ki. weights: F x component_count. ->
// displacements F x V x 3, un-posed, metres. Weights of 0 change no bit.
void modify_blend(const SkinModifiers& modifiers, std::span<const float> weights, std::uint32_t frame_count,
                  std::span<float> displacements);
// Does one frame and some blocks, as blend_blocks.
void modify_blocks(const SkinModifiers& modifiers, const float* weights, std::uint32_t first_block,
                   std::span<float> displacements);

// Pose stage: x_i = t_i + R_i (d_i + delta d_i) + origin. -> positions F x V x 3, metres, posed (world).
void pose_skin(const DdmTable& ddm, std::uint32_t joint_count, std::span<const float> skinning,
               std::span<const float> origins, std::span<const float> displacements, std::span<float> positions);
// Does one frame (skinning J x 12, origin 3) and as many blocks as positions hold, from first_block on. `frames`: of
// these blocks where they are known (runtime/cpu/ddm_frames.h), or null.
void pose_blocks(const DdmTable& ddm, const float* skinning, const float* frames, const float* origin,
                 std::uint32_t first_block, std::span<const float> displacements, std::span<float> positions);

// Output stage: one of kRelaxSteps steps in which compressed skin is evened out along itself (shaders/include/relax.h).
// A vertex moves where its triangles have lost more than a tenth of their area at rest. From three tenths on it goes
// half the way, within its tangent plane, on which they would get it back, as far as they agree. Takes weights F x
// component_count, current F x V x 3, metres, posed -> relaxed F x V x 3. Weights of 0, and skin that is not
// compressed, change no bit.
void output_relax(const MeshTable& mesh, const OutputRelaxPush& push, std::span<const float> weights,
                  std::span<const float> current, std::span<float> relaxed);
// Does one frame and as many vertices as relaxed holds, from first_vertex on.
void relax_part(const MeshTable& mesh, float weight, std::span<const float> current, std::size_t first_vertex,
                std::span<float> relaxed);

// Output stage: the box around each kBoxTriangles triangles, and around each kLargeBox boxes. Takes positions F x V x 3
// -> boxes F x box_count x 6: the least of x, y and z, and the most.
void output_bound(std::span<const std::uint32_t> triangles, const OutputBoundPush& push,
                  std::span<const float> positions, std::span<float> boxes);

// The skin that output_separate moves, of one frame or of all: V x 3, metres, before the first step and now.
struct SeparateFrame {
  std::span<const float> posed, current;
};

// Output stage: one of kSeparateSteps steps in which skin that has crossed skin in a fold goes half its depth. It goes
// along the fold's normal (shaders/include/fold.h), so that both sides meet; of several folds by the shortest way. Only
// vertices that faced the other side before the first step move, after it only those that it moved. Takes boxes F x
// box_count x 6 of the skin now, weights F x component_count -> moved F x V x 3. The folds' normals in the weights are
// as long as how much is shown. What has crossed nothing keeps its bits.
void output_separate(const MeshTable& mesh, const FoldTables& tables, const OutputSeparatePush& push,
                     std::span<const float> boxes, std::span<const float> weights, const SeparateFrame& batch,
                     std::span<float> moved);

// A fold that is bent, and where the boxes of triangles lie along its axes u and w across its normal n, and along that.
struct BentFold {
  std::uint32_t fold = 0;
  float n[3] = {}, u[3] = {}, w[3] = {};
  std::span<const float> from[3], to[3];  // of u, w and n: box_count
};
// The bent folds of one frame. Kept from frame to frame, so that their memory is.
class BentFolds {
 public:
  void find(const OutputSeparatePush& push, std::span<const float> weights, std::span<const float> boxes);
  std::span<const BentFold> all() const { return folds_; }

 private:
  std::vector<BentFold> folds_;
  std::vector<float> spans_;  // of each fold what it has of u, w and n
};
// Does one frame and as many vertices as moved holds, from first_vertex on. Did any move?
bool separate_part(const MeshTable& mesh, const FoldTables& tables, const OutputSeparatePush& push,
                   std::span<const BentFold> folds, const SeparateFrame& frame, std::size_t first_vertex,
                   std::span<float> moved);

// Output stage: normals by the sum of area vectors of the triangles around each vertex, in ascending triangle order.
// Takes positions F x V x 3 -> normals F x V x 3; zero where the sum's length is not above 1e-20.
void output_normals(const MeshTable& mesh, std::span<const float> positions, std::span<float> normals);
// Its halves, of one frame. The first gives twice the area vectors of as many triangles as areas hold, from
// first_triangle on. Each is x, y, z and 0, which a register holds at once. Takes positions V x 3. The triangles and
// those of each vertex are the mesh's, or those of near_triangles().
inline constexpr std::size_t kAreaNumbers = 4;
void area_vectors(std::span<const std::uint32_t> triangles, std::span<const float> positions,
                  std::size_t first_triangle, std::span<float> areas);
// The normals of some vertices, those from first_vertex on, as many as normals hold. areas: of all triangles.
void part_normals(const MeshTable& mesh, std::span<const std::uint32_t> vertex_triangles, std::span<const float> areas,
                  std::size_t first_vertex, std::span<float> normals);
// Gives the normal of one vertex, the same bits.
void vertex_normal(const MeshTable& mesh, std::span<const float> positions, std::size_t vertex, float* normal);

// Output stage: tangents of as many output vertices of one frame as tangents hold, from first_output on. Each is x, y,
// z and the sign s of the bitangent, s times normal x tangent, by the convention of MikkTSpace
// (shaders/include/tangent.h, runtime/host/skin_tables.h). Takes positions, normals V x 3 -> tangents x 4: across the
// normal and of length 1. They are zero where no triangle around the vertex has an area on the texture, or where their
// tangents cancel out.
void output_tangents(const TangentTables& tables, std::span<const float> positions, std::span<const float> normals,
                     std::size_t first_output, std::span<float> tangents);

// Output stage: places three numbers of each of these output vertices, element_stride bytes from one to the next. They
// are of positions or normals of a frame, V x 3. What lies between is left.
void output_place(std::span<const std::uint32_t> output_vertex, std::span<const float> values,
                  std::size_t element_stride, std::byte* placed);

}  // namespace bodyopt::cpu
