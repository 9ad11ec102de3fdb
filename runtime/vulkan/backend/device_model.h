// Tables and pipelines of a character, which are on a device once, however many instances evaluate it there.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "runtime/host/character_model.h"
#include "runtime/host/output_steps.h"
#include "runtime/host/skin_tables.h"
#include "runtime/vulkan/kernels/windows.h"

namespace bodyopt::vulkan {

// A block inverse's solve on the device: all levels up, then down (runtime/cpu/dynamics_kernels.h, block_solve).

class BlockSolve {
 public:
  // gathered, results: scratch, right_side_count x slot_count floats each. right_sides and solutions may be one buffer.
  struct Buffers {
    const InverseBuffers& inverse;
    BufferRange right_sides, gathered, results, solutions;
  };

  explicit BlockSolve(const Device& device);
  void record(Commands& commands, const Buffers& buffers, std::uint32_t right_side_count,
              std::uint32_t interleave) const;

 private:
  BlockGather gather_;
  BlockUp up_;
  BlockDown down_;
};

// Counts of a basis, in the units of a frame.
struct FrameCounts {
  FrameCounts(const Basis& basis, const TangentTables& tangent_tables)
      : vertices(basis.mesh.vertex_count()),
        outputs(basis.mesh.output_count()),
        joints(static_cast<std::uint32_t>(basis.skeleton.size())),
        strain_vertices(static_cast<std::uint32_t>(basis.strain.vertices.size())),
        fibres(basis.strain.fibre_count()),
        features(basis.residual.feature_count()),
        controls(features == 0 ? 0 : static_cast<std::uint32_t>(basis.residual.controls.size())),
        joint_features(features == 0 ? 0 : features - fibres - controls),
        regions(static_cast<std::uint32_t>(basis.residual.regions.size())),
        coordinates(basis.residual.coordinate_count()),
        centres(basis.residual.centre_count()),
        coefficients(basis.residual.coefficient_count()),
        components(basis.modifiers.component_count()),
        turned_joints(basis.modifiers.turn_joints() ? joints : 0),
        finished(basis.modifiers.move_posed_skin() ? 3 * vertices : 0),
        boxes(basis.modifiers.of_type(kPushOut.name) ? bound_push(basis).box_count : 0),
        tangents(4 * static_cast<std::uint32_t>(tangent_tables.vertices.size())) {}

  std::uint32_t vertices, outputs, joints, strain_vertices, fibres, features, controls, joint_features;
  std::uint32_t regions, coordinates, centres, coefficients, components;
  std::uint32_t turned_joints;  // all joints where modifiers turn some; 0 where none do
  std::uint32_t finished;       // numbers of a skin that modifiers move in the end; 0 where none do
  std::uint32_t boxes;          // of triangles; 0 without push-out
  std::uint32_t tangents;       // numbers; 0 without texture coordinates
};

struct FoldBuffers {
  FoldBuffers(Uploads& uploads, const FoldTables& tables, const DeviceInfo& limits);

  Buffer triangles, sides;
};

struct TangentBuffers {
  TangentBuffers(Uploads& uploads, const TangentTables& tables, const DeviceInfo& limits);

  Buffer vertices, corners;
};

struct SkinTables {
  SkinTables(Uploads& uploads, const Basis& basis, const FoldTables& fold_tables, const TangentTables& tangent_tables,
             const DeviceInfo& limits);

  DdmBuffers ddm;
  BlendBuffers blend, modifiers;
  Buffer strain_vertices, points, fibre_begin, rest_length;
  Buffer ranges, regions, region_features, coordinate_region, projections, centre_region, centres;
  Buffer coefficient_region, weights, rest;
  FoldBuffers folds;  // without push-out empty
  FanBuffers fans;
  TangentBuffers tangents;  // without texture coordinates empty
  Buffer output_vertex;
};

// All models on a device share its kernels.
struct SkinKernels {
  explicit SkinKernels(const Device& device);

  StrainSkin strain_skin;
  StrainMeasure strain_measure;
  ResidualFeatures residual_features;
  ResidualProject residual_project;
  ResidualKernels residual_kernels;
  ResidualCoefficients residual_coefficients;
  ResidualBlend residual_blend;
  ModifyBlend modify_blend;
  PoseSkin pose_skin;
  OutputRelax output_relax;
  OutputBound output_bound;
  OutputSeparate output_separate;
  OutputNormals output_normals;
  OutputTangents output_tangents;
  OutputPlace output_place;
};

struct DynamicsTables {
  DynamicsTables(Uploads& uploads, const Dynamics& dynamics, const DeviceInfo& limits);

  Buffer tets, shapes, corner_begin, corners, surface, skin, limit;
  Buffer row_begin, columns, values;
  InverseBuffers diffuse_inverse;
  Buffer nodes;
  InverseBuffers jiggle_inverse;
};

struct DynamicsKernels {
  explicit DynamicsKernels(const Device& device);

  DiffuseSurface diffuse_surface;
  DiffuseGather diffuse_gather;
  BlockSolve block_solve;
  JiggleRotate jiggle_rotate;
  JiggleKick jiggle_kick;
  JiggleBegin jiggle_begin;
  JiggleAdvance jiggle_advance;
  JiggleEnd jiggle_end;
  JiggleSkin jiggle_skin;
};

class DeviceModel {
 public:
  struct Jiggling {
    DynamicsTables tables;
    const DynamicsKernels& kernels;
  };

  // Uploads the basis. Throws Error(device) when the tables do not fit the device. Tables that kernels read block by
  // block may be larger than a binding can be. The error names a table that is read here and there and is larger, or
  // whose threads are more than the device starts at once.
  DeviceModel(std::shared_ptr<const Device> device, std::shared_ptr<const CharacterModel> model);
  // Treats the device as one whose bindings are limited further.
  DeviceModel(std::shared_ptr<const Device> device, std::shared_ptr<const CharacterModel> model,
              const DeviceInfo& limits);

  const Device& device() const { return *device_; }
  const DeviceInfo& limits() const { return limits_; }
  const CharacterModel& model() const { return *model_; }
  const std::shared_ptr<const CharacterModel>& shared_model() const { return model_; }
  const FrameCounts& counts() const { return counts_; }
  const SkinTables& tables() const { return tables_; }
  const SkinKernels& kernels() const { return kernels_; }
  // The model must have dynamics, which are uploaded when this is first called, from any thread. Throws Error(device).
  const Jiggling& jiggling() const;

 private:
  std::shared_ptr<const Device> device_;
  std::shared_ptr<const CharacterModel> model_;
  DeviceInfo limits_;
  FrameCounts counts_;
  SkinTables tables_;
  const SkinKernels& kernels_;
  mutable std::once_flag jiggles_;
  mutable std::optional<Jiggling> jiggling_;
};

}  // namespace bodyopt::vulkan
