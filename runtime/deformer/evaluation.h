// The results of a deformer for poses.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "runtime/host/jiggle.h"
#include "runtime/host/stages.h"

namespace bodyopt {

// Seconds of the calling thread, summed over the batches of a call, beside those of the rig (Stage::rig).
struct HostSeconds {
  double upload = 0;    // what a batch brings, and its commands, to the device
  double wait = 0;      // for the device, or for the kernels of the CPU; of calls together the first has it
  double download = 0;  // out of the memory that the device wrote
  double order = 0;     // into output order, and what is told of the frames
};

inline constexpr std::array<std::pair<const char*, double HostSeconds::*>, 4> kHostParts{
    {{"upload", &HostSeconds::upload},
     {"wait", &HostSeconds::wait},
     {"download", &HostSeconds::download},
     {"order", &HostSeconds::order}}};

// The result of a batch of F frames, in output vertex order (as in the character's file).
struct Evaluation {
  std::vector<float> positions;  // F x O x 3, metres, posed (world)
  std::vector<float> normals;    // F x O x 3, unit (zero where all triangles around a vertex are degenerate); see
                                 // Deformer::set_normals
  std::vector<float> strains;    // F x S
  std::vector<float> outside;    // F: how far the worst feature lies outside its trained range, in standard
                                 // deviations of training; 0 when the frame is covered
  std::vector<std::uint32_t> outside_feature;  // F: that feature, see feature_name
  std::vector<float> outside_by;               // F: how far: degrees that a joint is turned beyond
                                  // what was shown, metres that it slid, share of a fibre's length, or of a control
  std::vector<float> excess;        // F x feature count: how far each lies outside, as the worst does
  std::vector<float> coordinates;   // F x coordinate count: the features as the regions see them
  std::vector<float> fades;         // F x regions: how much of what was learned is left, see region_fades
  std::vector<int> fading_joint;    // F: the joint that takes most of it; -1: nothing fades
  std::vector<JiggleStart> starts;  // F where frames jiggle: how each began
  StageSeconds stage_seconds;       // summed over the batch
  HostSeconds host_seconds;
};

// Memory of the caller for three numbers of each vertex, or four of each tangent. They are at
// data + frame x frame_stride + output vertex x element_stride, bytes.
struct PlacedVertices {
  std::byte* data = nullptr;  // null: not wanted
  std::size_t element_stride = 0, frame_stride = 0;
};

// The place that a skin is written to instead of an Evaluation. Unwanted normals and tangents are not computed.
struct SkinPlace {
  PlacedVertices positions, normals;
  // x, y, z and the bitangent's sign, see cpu::output_tangents; of a model that texture coordinates were given for.
  PlacedVertices tangents{};
};

// Standard deviations beyond the trained range (Evaluation::outside) that are worth reporting: less is written as 0.0.
constexpr float kOutsideWorthTelling = 0.05f;

}  // namespace bodyopt
