// Buffers of the batches of an instance on a device.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/host/backend.h"
#include "runtime/host/output_steps.h"
#include "runtime/host/stages.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/buffer.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {

// Values of a batch: a buffer of F x count floats, on the device. Batches of fewer frames use its beginning.
struct Values {
  Values(const Device& device, std::uint32_t frames, std::uint64_t count, const char* name,
         Memory memory = Memory::device)
      : frame_bytes(count * sizeof(float)), buffer(device, frames * frame_bytes, memory, name) {}

  BufferRange of(std::uint32_t frames) const { return {buffer, 0, frames * frame_bytes}; }

  VkDeviceSize frame_bytes;
  Buffer buffer;
};

// For so many frames at most. Batches use them one after the other.
struct BatchBuffers {
  BatchBuffers(const Device& device, const FrameCounts& n, std::uint32_t frames_)
      : frames(frames_),
        skinning(device, frames, std::uint64_t{12} * n.joints, "the skinning matrices"),
        origins(device, frames, 4, "the origins"),
        joint_features(device, frames, n.joint_features, "the joint features"),
        controls(device, frames, n.controls, "the controls"),
        fades(device, frames, n.regions, "the fades"),
        modifiers(device, frames, n.components, "the modifiers' weights"),
        learned_skinning(device, frames, std::uint64_t{12} * n.turned_joints, "the skinning matrices of the strains"),
        strain_positions(device, frames, std::uint64_t{3} * n.strain_vertices, "the strain positions"),
        strains(device, frames, n.fibres, "the strains"),
        features(device, frames, n.features, "the features"),
        excess(device, frames, n.features, "the features' excess"),
        coordinates(device, frames, n.coordinates, "the coordinates"),
        kernels(device, frames, n.centres, "the kernels"),
        coefficients(device, frames, n.coefficients, "the coefficients"),
        displacements(device, frames, std::uint64_t{3} * n.vertices, "the displacements"),
        positions(device, frames, std::uint64_t{3} * n.vertices, "the positions"),
        finished{Values(device, frames, n.finished, "the finished skin"),
                 Values(device, frames, n.finished, "the finished skin"),
                 Values(device, frames, n.finished, "the finished skin")},
        boxes(device, frames, std::uint64_t{6} * n.boxes, "the boxes of triangles"),
        normals(device, frames, std::uint64_t{3} * n.vertices, "the normals") {}

  // The inputs of a batch, in the order in which they are staged.
  std::array<const Values*, 7> inputs() const {
    return {&skinning, &origins, &joint_features, &controls, &fades, &modifiers, &learned_skinning};
  }
  static std::array<std::span<const float>, 7> inputs_of(const Batch& b) {
    return {b.skinning, b.origins, b.joint_features, b.controls, b.fades, b.modifiers, b.learned_skinning};
  }
  VkDeviceSize input_bytes() const {  // of a frame
    VkDeviceSize sum = 0;
    for (const Values* part : inputs()) sum += part->frame_bytes;
    return sum;
  }
  // Strains are of the pose before modifiers turned joints.
  const Buffer& skinning_of_strains() const {
    return learned_skinning.frame_bytes > 0 ? learned_skinning.buffer : skinning.buffer;
  }

  std::uint32_t frames;
  Values skinning, origins, joint_features, controls, fades, modifiers, learned_skinning;
  Values strain_positions, strains, features, excess, coordinates, kernels, coefficients, displacements;
  Values positions;
  std::array<Values, 3> finished;  // before a modifier, and by one of its steps and the next
  Values boxes;
  Values normals;
};

// A skin in output order, which is fetched while the next batch runs.
struct OrderedSkin {
  OrderedSkin(const Device& device, const FrameCounts& n, std::uint32_t frames_)
      : frames(frames_),
        positions(device, frames, std::uint64_t{3} * n.outputs, "the skin", Memory::fetched),
        normals(device, frames, std::uint64_t{3} * n.outputs, "the skin's normals", Memory::fetched),
        tangents(device, frames, n.tangents, "the tangents", Memory::fetched),
        staging(device, frames * (positions.frame_bytes + normals.frame_bytes + tangents.frame_bytes), Memory::staging,
                "staging") {}

  std::uint32_t frames;
  Values positions, normals, tangents;
  Buffer staging;
};

// An output that goes to the host, and where it is staged.
struct Download {
  BufferRange from;
  const Buffer* staging;
  VkDeviceSize staged;  // bytes
  std::vector<float> BatchResult::*to;

  bool is_of_skin() const {
    return to == &BatchResult::positions || to == &BatchResult::normals || to == &BatchResult::tangents ||
           to == &BatchResult::posed;
  }
  std::span<const float> values() const {
    if (from.size == 0) return {};
    return {reinterpret_cast<const float*>(staging->mapped() + staged), from.size / sizeof(float)};
  }
};

// What a batch is recorded for.
struct RecordedBatch {
  std::uint32_t frames = 0;
  bool stays_on_device = false, keeps_posed = false, wants_normals = true, wants_tangents = false;
  bool is_ordered = false;  // the skin is fetched in output order
  std::vector<OutputStep> output_steps{};
  bool operator==(const RecordedBatch&) const = default;
};

// A batch under way: it is sent and fetched by memory of its own, so that the host is at one while the device runs
// another.
struct BatchSlot {
  explicit BatchSlot(const Device& device) : commands(device) {}

  Buffer staging_in, staging_out;
  std::optional<OrderedSkin> skin;  // where one was fetched
  RecordedBatch recorded;
  bool is_recorded = false;     // and can be submitted again
  bool has_new_buffers = true;  // that no descriptor set is of
  std::vector<Stage> stages;
  std::vector<Download> downloads;
  Commands commands;  // last: it waits before its buffers go
};

}  // namespace bodyopt::vulkan
