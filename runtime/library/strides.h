// The caller's arrays: what is read of poses, and where frames are written.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "include/bodyopt/bodyopt.h"
#include "runtime/basis/skeleton.h"
#include "runtime/deformer/deformer.h"

namespace bodyopt {

constexpr std::size_t kJointNumbers = 10;  // of a joint: translation, quaternion, scale

// The poses as a caller gives them, looked at once and read frame by frame. Throws Error(usage) for strides that are
// too small, Error(mismatch) for another number of joints, controls or channels than the basis has.
class GivenPoses {
 public:
  // `channels`: names of the model's. All must outlive it.
  GivenPoses(const bodyopt_poses* poses, const Basis& basis, std::span<const std::string> channels);

  std::size_t count() const { return poses_.frame_count; }
  // Into the memory of earlier ones.
  void read(std::size_t begin, std::size_t count, std::vector<Pose>& poses) const;
  // Throws Error(usage) where there are none.
  std::span<const int> frame_numbers() const;

  bool shows_modifiers() const { return poses_.shows_modifiers != 0; }
  bool goes_on() const { return poses_.goes_on != 0; }
  double frames_per_second() const { return poses_.frames_per_second; }
  bool has_channels() const { return poses_.channels != nullptr; }
  // Empty without channels. Throws Error(mismatch) for one that is not finite.
  std::vector<float> read_channels(std::size_t frame) const;

 private:
  void check_modifiers();
  void check_joints();
  void check_skinning();
  void read_pose(std::size_t frame, Pose& pose) const;
  void read_joints(std::size_t frame, std::vector<JointTransform>& joints) const;
  void read_skinning(std::size_t frame, std::vector<JointTransform>& joints) const;
  Affine skinning_of(std::size_t frame, std::size_t joint) const;

  bodyopt_poses poses_;
  const Skeleton& skeleton_;
  std::span<const std::string> channels_;
};

// O x 2: the texture coordinates of the options; empty where none were given. Throws Error(usage) for a stride that is
// too small or memory that does not hold all. Throws Error(mismatch) for another number of vertices, and for
// coordinates that are not finite.
std::vector<float> read_texture(const bodyopt_load_options& options, const Basis& basis);

// Looks at an output of `elements` elements a frame, of `numbers` numbers each, and fills in its strides. Throws
// Error(usage) for strides that are too small or memory that does not hold all frames.
void check_output(bodyopt_floats& output, std::size_t frames, std::size_t elements, std::size_t numbers,
                  const char* name);
// Writes `values` into such an output, from frame `begin` on.
void scatter(std::span<const float> values, const bodyopt_floats& output, std::size_t begin, std::size_t elements,
             std::size_t numbers = 1);

// The caller's memory for a skin. Throws Error(usage) for strides that are too small or memory that does not hold all
// frames.
class WantedSkin {
 public:
  WantedSkin(const bodyopt_skin* skin, const Basis& basis, std::size_t frames);

  const bodyopt_skin& outputs() const { return skin_; }
  // Returns the place of frames `begin` and after.
  SkinPlace place(std::size_t begin) const;
  bool wants_expected_errors() const { return skin_.expected_errors.data != nullptr; }
  void write_expected_error(float metres, std::size_t frame) const;
  bool wants_vertex_errors() const { return skin_.vertex_errors.data != nullptr; }
  // `metres`: of each output vertex.
  void write_vertex_errors(std::span<const float> metres, std::size_t frame) const;
  bool wants_nothing() const;
  // Writes what is not placed, from frame `begin` on, for as many frames as were evaluated.
  void write(const Evaluation& evaluation, std::size_t begin) const;

 private:
  bodyopt_skin skin_;
  std::size_t vertices_, strains_, features_;
};

}  // namespace bodyopt
