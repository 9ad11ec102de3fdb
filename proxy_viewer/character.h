// A character of the scene: its basis, the clip it plays, and its skin by several methods, each on the device.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "proxy_viewer/view_settings.h"
#include "proxy_viewer/worn_meshes.h"
#include "runtime/deformer.h"
#include "runtime/vulkan/buffer.h"
#include "trainer/dataset/clip.h"
#include "trainer/dataset/pc2.h"

namespace bodyopt {

// What makes the skin. Direct Delta Mush: what is learned left out; linear: of what is learned the part that is linear
// in joints and strains; truth: a point cache.
enum class Method { ddm, linear, full, jiggle, truth };

// The files of a character; what is empty is none. Dynamics and attached geometry: those beside the basis, where there
// are any.
struct CharacterFiles {
  std::string basis, clip, truth;
};

// A skin where it is: one or more frames of the same vertices.
struct ShownSkin {
  const vulkan::Buffer* positions = nullptr;  // F x V x 3, metres, world
  const vulkan::Buffer* normals = nullptr;
};

class Character {
 public:
  // Throws Error(file), Error(mismatch), Error(device).
  Character(std::shared_ptr<const vulkan::Device> device, const CharacterFiles& files, const ClipOptions& options);

  const CharacterFiles& files() const { return files_; }
  std::string name() const;
  const Basis& basis() const { return basis_; }
  const Clip& clip() const { return clip_; }  // one frame, the bind pose, where there is no file
  bool has(Method method) const;

  // These throw as the constructor, and leave what was there.
  void open_clip(const std::string& source);
  void open_truth(const std::string& path);

  // The clip's pose, turned joint by joint as the settings say. Frames beyond the clip: its first or last.
  Pose pose(int frame, const ViewSettings::Posing& posing) const;

  // Poses of one frame, then of ghosts and instances; `frame`: of the first. The jiggle steps only with that.
  const Evaluation& evaluate(Method method, std::span<const Pose> poses, int frame, const Weights& weights);
  void reset_jiggle();  // which starts anew with the next frame
  // What it wears, on the skin evaluated last by the method that is carried along: full or jiggle; null: nothing.
  const WornMeshes* worn() const { return worn_.get(); }
  // Of the last evaluation by the method.
  ShownSkin skin(Method method) const;

  // The result of a method on the host, output vertex order: of one pose, for figures; nothing where the truth has no
  // such frame. Quasi-static.
  std::vector<float> measure(Method method, const Pose& pose, int frame);

  const vulkan::Buffer& triangles() const { return triangles_; }
  const vulkan::Buffer& fibre_segments() const { return fibre_segments_; }
  const vulkan::Buffer& fibre_points() const { return fibre_points_; }
  std::uint32_t fibre_segment_count() const { return fibre_segment_count_; }

  double size() const { return size_; }      // diagonal of the rest skin, metres
  double ground() const { return ground_; }  // height of its lowest point as the clip begins, metres

 private:
  struct Truth {
    Pc2Reader reader;
    int shown = -1;  // sample that is on the device
    vulkan::Buffer positions, normals;
  };

  enum class Use { show, measure };  // what is measured must not take the place of what is shown

  Deformer& deformer(Method method, Use use);
  void show_truth(int frame);
  std::optional<std::uint32_t> truth_sample(int frame) const;
  void measure_ground();

  std::shared_ptr<const vulkan::Device> device_;
  CharacterFiles files_;
  ClipOptions clip_options_;
  Basis basis_;
  std::optional<Dynamics> dynamics_;
  Clip clip_;
  double size_ = 1, ground_ = 0;
  vulkan::Buffer triangles_, fibre_segments_, fibre_points_;
  std::uint32_t fibre_segment_count_ = 0;
  std::map<std::pair<Method, Use>, std::unique_ptr<Deformer>> deformers_;  // made when they are first wanted
  // What a method has evaluated last, and of what: the same is not evaluated again.
  struct Evaluated {
    std::vector<Pose> poses;
    int frame = 0;
    Weights weights;
    Evaluation result;
  };
  std::map<Method, Evaluated> evaluated_;
  std::optional<Truth> truth_;
  std::unique_ptr<WornMeshes> worn_;
};

// The basis without its kernels: what a linear map of joints and strains makes of it.
Basis linear_part(Basis basis);

}  // namespace bodyopt
