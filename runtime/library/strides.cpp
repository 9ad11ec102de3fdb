#include "runtime/library/strides.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "runtime/basis/basis.h"
#include "runtime/host/rig.h"
#include "runtime/library/guard.h"

namespace bodyopt {
namespace {

constexpr std::size_t kMatrixNumbers = 12;  // of a skinning matrix

[[noreturn]] void refuse(const auto&... what) { throw Error(ErrorKind::usage, what...); }

// `stride`, or `packed` where it is 0. Throws Error(usage) unless it has room for an element and keeps its alignment.
// `part`: of what has that name.
std::size_t checked_stride(std::size_t stride, std::size_t packed, std::size_t unit, const char* name,
                           const char* part) {
  if (stride == 0) return packed;
  if (stride < packed) {
    refuse("the ", name, part, " is ", stride, " bytes, at least ", packed, " are needed (0: without gaps)");
  }
  if (stride % unit != 0) refuse("the ", name, part, " is ", stride, " bytes, which is no multiple of ", unit);
  return stride;
}

// a b + c. Throws Error(usage) where no memory is as large.
std::size_t checked_size(std::size_t a, std::size_t b, std::size_t c, const char* name) {
  std::size_t result = 0;
  if (__builtin_mul_overflow(a, b, &result) || __builtin_add_overflow(result, c, &result)) {
    refuse("the strides of '", name, "' are too large");
  }
  return result;
}

template <typename T>
void require_aligned(const T* data, const char* name) {
  if (reinterpret_cast<std::uintptr_t>(data) % alignof(T) != 0) {
    refuse("'", name, "' is not aligned to ", alignof(T), " bytes");
  }
}

// Looks at an array of `count` numbers a frame. Returns its stride from frame to frame, which is of `one`.
std::size_t checked_numbers(const float* values, std::size_t count, std::size_t stride, std::size_t frames,
                            const char* name, const char* one) {
  require_aligned(values, name);
  stride = checked_stride(stride, count * sizeof(float), sizeof(float), one, "_frame_stride");
  checked_size(frames, stride, 0, name);
  return stride;
}

// Fills in the strides of an array of `element` bytes a joint.
void check_joint_strides(const bodyopt_poses& poses, std::size_t element, std::size_t unit, const char* name,
                         std::size_t& stride, std::size_t& frame_stride) {
  stride = checked_stride(stride, element, unit, name, "_stride");
  const std::size_t frame = checked_size(poses.joint_count, stride, 0, name);
  frame_stride = checked_stride(frame_stride, frame, unit, name, "_frame_stride");
  checked_size(poses.frame_count, frame_stride, 0, name);
}

// The numbers of one frame of such an array.
void read_numbers(const float* values, std::size_t count, std::size_t stride, std::size_t frame,
                  std::vector<float>& numbers) {
  numbers.resize(count);
  if (count == 0) return;
  std::memcpy(numbers.data(), reinterpret_cast<const std::byte*>(values) + frame * stride, count * sizeof(float));
}

void require_count(std::uint32_t found, std::size_t expected, const char* of) {
  if (found == expected) return;
  throw Error(ErrorKind::mismatch, "the poses have ", found, " ", of, ", the basis has ", expected);
}

}  // namespace

GivenPoses::GivenPoses(const bodyopt_poses* poses, const Basis& basis, std::span<const std::string> channels)
    : poses_(read_struct(poses, BODYOPT_POSES_FIRST_SIZE, "poses")), skeleton_(basis.skeleton), channels_(channels) {
  require_count(poses_.joint_count, basis.skeleton.size(), "joints");
  if (poses_.control_count > 0) require_count(poses_.control_count, basis.residual.controls.size(), "controls");
  check_modifiers();
  if (poses_.frame_count == 0) return;
  poses_.skinning != nullptr ? check_skinning() : check_joints();
  if (poses_.control_count == 0) return;
  require(poses_.controls, "poses.controls");
  poses_.control_frame_stride = checked_numbers(poses_.controls, poses_.control_count, poses_.control_frame_stride,
                                                poses_.frame_count, "poses.controls", "poses.control");
}

void GivenPoses::check_joints() {
  require(poses_.joints, "poses.joints");
  require_aligned(poses_.joints, "poses.joints");
  check_joint_strides(poses_, kJointNumbers * sizeof(double), sizeof(double), "poses.joint", poses_.joint_stride,
                      poses_.joint_frame_stride);
}

void GivenPoses::check_skinning() {
  if (poses_.joints != nullptr) refuse("both 'poses.joints' and 'poses.skinning' are given, expected one");
  require_aligned(poses_.skinning, "poses.skinning");
  check_joint_strides(poses_, kMatrixNumbers * sizeof(float), sizeof(float), "poses.skinning", poses_.skinning_stride,
                      poses_.skinning_frame_stride);
}

void GivenPoses::check_modifiers() {
  if (!shows_modifiers()) return;
  constexpr double kLeast = 1e-3, kMost = 1e6;  // so that no phase grows beyond what can be counted
  if (!(poses_.frames_per_second >= kLeast && poses_.frames_per_second <= kMost)) {
    refuse("the poses have ", poses_.frames_per_second, " frames_per_second, expected 0.001 to 1000000");
  }
  if (!has_channels()) return;
  require_count(poses_.channel_count, channels_.size(), "channels");
  poses_.channel_frame_stride = checked_numbers(poses_.channels, poses_.channel_count, poses_.channel_frame_stride,
                                                poses_.frame_count, "poses.channels", "poses.channel");
}

std::vector<float> GivenPoses::read_channels(std::size_t frame) const {
  if (!has_channels()) return {};
  std::vector<float> values;
  read_numbers(poses_.channels, poses_.channel_count, poses_.channel_frame_stride, frame, values);
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (std::isfinite(values[c])) continue;
    throw Error(ErrorKind::mismatch, "the channel '", channels_[c], "' is not a finite number");
  }
  return values;
}

void GivenPoses::read_joints(std::size_t frame, std::vector<JointTransform>& joints) const {
  joints.clear();
  const std::byte* at = reinterpret_cast<const std::byte*>(poses_.joints) + frame * poses_.joint_frame_stride;
  for (std::size_t j = 0; j < poses_.joint_count; ++j, at += poses_.joint_stride) {
    double n[kJointNumbers];
    std::memcpy(n, at, sizeof(n));
    joints.push_back({{n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]}, {n[7], n[8], n[9]}});
  }
}

Affine GivenPoses::skinning_of(std::size_t frame, std::size_t joint) const {
  float n[kMatrixNumbers];
  std::memcpy(n,
              reinterpret_cast<const std::byte*>(poses_.skinning) + frame * poses_.skinning_frame_stride +
                  joint * poses_.skinning_stride,
              sizeof(n));
  Affine matrix;
  for (std::size_t k = 0; k < kMatrixNumbers; ++k) matrix.m[k / 4][k % 4] = static_cast<double>(n[k]);
  return matrix;
}

void GivenPoses::read_skinning(std::size_t frame, std::vector<JointTransform>& joints) const {
  joints.clear();
  for (std::size_t j = 0; j < poses_.joint_count; ++j) {
    const int parent = skeleton_.joints[j].parent;
    const Affine of_parent = parent < 0 ? Affine{} : skinning_of(frame, static_cast<std::size_t>(parent));
    joints.push_back(local_joint(skeleton_, j, skinning_of(frame, j), of_parent));
  }
}

void GivenPoses::read_pose(std::size_t frame, Pose& pose) const {
  poses_.skinning != nullptr ? read_skinning(frame, pose.joints) : read_joints(frame, pose.joints);
  read_numbers(poses_.controls, poses_.control_count, poses_.control_frame_stride, frame, pose.controls);
  pose.modifiers.clear();
  pose.unmodified.clear();
}

void GivenPoses::read(std::size_t begin, std::size_t count, std::vector<Pose>& poses) const {
  poses.resize(count);
  for (std::size_t f = 0; f < count; ++f) read_pose(begin + f, poses[f]);
}

std::span<const int> GivenPoses::frame_numbers() const {
  if (count() == 0) return {};
  return {&required(poses_.frame_numbers, "poses.frame_numbers"), count()};
}

std::vector<float> read_texture(const bodyopt_load_options& options, const Basis& basis) {
  const std::size_t vertices = basis.mesh.output_count(), both = 2 * sizeof(float);
  if (options.texture == nullptr || vertices == 0) return {};
  if (options.texture_count != vertices) {
    throw Error(ErrorKind::mismatch, "the texture coordinates are of ", options.texture_count,
                " vertices, the model has ", vertices, " (each level of detail has its own)");
  }
  require_aligned(options.texture, "options.texture");
  const std::size_t stride = checked_stride(options.texture_stride, both, sizeof(float), "options.texture", "_stride");
  const std::size_t needed = checked_size(vertices - 1, stride, both, "options.texture");
  if (options.texture_size < needed) {
    refuse("'options.texture' has ", options.texture_size, " bytes, ", needed, " are needed for ", vertices,
           " vertices");
  }
  std::vector<float> texture(2 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    std::memcpy(&texture[2 * v], reinterpret_cast<const std::byte*>(options.texture) + v * stride, both);
    if (std::isfinite(texture[2 * v]) && std::isfinite(texture[2 * v + 1])) continue;
    throw Error(ErrorKind::mismatch, "a texture coordinate of vertex ", v, " is not finite");
  }
  return texture;
}

void check_output(bodyopt_floats& output, std::size_t frames, std::size_t elements, std::size_t numbers,
                  const char* name) {
  if (output.data == nullptr || frames == 0 || elements == 0) return;
  require_aligned(output.data, name);
  const std::size_t element = numbers * sizeof(float);
  output.element_stride = checked_stride(output.element_stride, element, sizeof(float), name, ".element_stride");
  const std::size_t frame = checked_size(elements - 1, output.element_stride, element, name);
  output.frame_stride = checked_stride(output.frame_stride, frame, sizeof(float), name, ".frame_stride");
  const std::size_t needed = checked_size(frames - 1, output.frame_stride, frame, name);
  if (output.size < needed) {
    refuse("'", name, "' has ", output.size, " bytes, ", needed, " are needed for ", frames, " frames");
  }
}

void scatter(std::span<const float> values, const bodyopt_floats& output, std::size_t begin, std::size_t elements,
             std::size_t numbers) {
  if (output.data == nullptr || elements == 0) return;
  const std::size_t frames = values.size() / (numbers * elements);
  const float* from = values.data();
  for (std::size_t f = 0; f < frames; ++f) {
    std::byte* to = reinterpret_cast<std::byte*>(output.data) + (begin + f) * output.frame_stride;
    for (std::size_t e = 0; e < elements; ++e, to += output.element_stride, from += numbers) {
      std::memcpy(to, from, numbers * sizeof(float));
    }
  }
}

WantedSkin::WantedSkin(const bodyopt_skin* skin, const Basis& basis, std::size_t frames)
    : skin_(read_struct(skin, BODYOPT_SKIN_FIRST_SIZE, "skin")),
      vertices_(basis.mesh.output_count()),
      strains_(basis.strain.fibre_count()),
      features_(basis.residual.feature_count()) {
  check_output(skin_.positions, frames, vertices_, 3, "skin.positions");
  check_output(skin_.normals, frames, vertices_, 3, "skin.normals");
  check_output(skin_.strains, frames, strains_, 1, "skin.strains");
  check_output(skin_.outside, frames, 1, 1, "skin.outside");
  check_output(skin_.fades, frames, 1, 1, "skin.fades");
  check_output(skin_.expected_errors, frames, 1, 1, "skin.expected_errors");
  check_output(skin_.tangents, frames, vertices_, 4, "skin.tangents");
  check_output(skin_.vertex_errors, frames, vertices_, 1, "skin.vertex_errors");
  check_output(skin_.outside_features, frames, 1, 1, "skin.outside_features");
  check_output(skin_.excess, frames, features_, 1, "skin.excess");
}

bool WantedSkin::wants_nothing() const {
  const bodyopt_floats* all[] = {
      &skin_.positions,       &skin_.normals,  &skin_.strains,       &skin_.outside,          &skin_.fades,
      &skin_.expected_errors, &skin_.tangents, &skin_.vertex_errors, &skin_.outside_features, &skin_.excess};
  return std::ranges::all_of(all, [](const bodyopt_floats* output) { return output->data == nullptr; });
}

SkinPlace WantedSkin::place(std::size_t begin) const {
  const auto of = [&](const bodyopt_floats& output) {
    if (output.data == nullptr) return PlacedVertices{};
    return PlacedVertices{reinterpret_cast<std::byte*>(output.data) + begin * output.frame_stride,
                          output.element_stride, output.frame_stride};
  };
  return {of(skin_.positions), of(skin_.normals), of(skin_.tangents)};
}

void WantedSkin::write_expected_error(float metres, std::size_t frame) const {
  scatter({&metres, 1}, skin_.expected_errors, frame, 1);
}

void WantedSkin::write_vertex_errors(std::span<const float> metres, std::size_t frame) const {
  scatter(metres, skin_.vertex_errors, frame, vertices_);
}

void WantedSkin::write(const Evaluation& evaluation, std::size_t begin) const {
  scatter(evaluation.strains, skin_.strains, begin, strains_);
  scatter(evaluation.outside, skin_.outside, begin, 1);
  scatter(evaluation.excess, skin_.excess, begin, features_);
  for (std::size_t f = 0; f < evaluation.outside.size(); ++f) {
    const bool is_outside = evaluation.outside[f] > 0;
    const float feature = is_outside ? static_cast<float>(evaluation.outside_feature[f]) : -1.0f,
                fade = static_cast<float>(mean_fade(evaluation, f));
    scatter({&feature, 1}, skin_.outside_features, begin + f, 1);
    scatter({&fade, 1}, skin_.fades, begin + f, 1);
  }
}

}  // namespace bodyopt
