// Motion: a pose per integer frame, sampled from animations of glTF and FBX or from BVH.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// A camera of a clip's file.
struct ClipCamera {
  std::string name{};
  double vertical_angle = 0;     // that it sees, radians; 0: it has no perspective
  double height = 0;             // metres that it sees without perspective
  std::vector<Affine> places{};  // from its space, where it looks along -z and y is up, to the world; of each frame
};

struct Clip {
  std::string name;
  double fps = 24;
  int first_frame = 1;
  std::vector<Pose> poses;            // frame first_frame + k
  std::vector<std::string> controls;  // names of the poses' control values; none without a controls file
  std::vector<std::string> notes;     // unmatched joints, scaled joints, repairs; one sentence each
  std::vector<ClipCamera> cameras{};  // of glTF

  int last_frame() const { return first_frame + static_cast<int>(poses.size()) - 1; }
};

struct ClipOptions {
  double fps = 24;
  int first_frame = 1;
  double unit = 0;  // metres per file unit; 0: what the file tells (glTF: file_unit()), or the length of the bones
  std::string controls{};   // controls.json that goes with the clip; empty: none
  std::string joint_map{};  // joint_map.json: which joint moves which, where names do not tell; empty: none
  std::string up{};         // axis of a BVH that is up: x, y, z, -x, -y, -z; empty: its motion tells
};

// The unit of a clip for a character read with `character_unit`: glTF shares it, BVH is fitted, FBX knows its own (0).
double clip_unit(const std::string& source, double character_unit);

// `source`: FILE.glb#name, FILE.glb (its first clip), so of .gltf and .fbx, or FILE.bvh. Joints match as match_joints()
// says; a clip that matches no joint throws Error(mismatch) with both lists. Throws Error(file).
Clip read_clip(const std::string& source, const Skeleton& skeleton, const ClipOptions& options);

// The skeleton that a clip moves, by the names of all that could be a joint in its file.
using SkeletonChoice = std::function<Skeleton(const std::set<std::string>& names)>;
// Reads a clip whose skeleton depends on it.
Clip read_clip(const std::string& source, const SkeletonChoice& choose, const ClipOptions& options);

// The names of the clips in a .glb, .gltf, .fbx or .bvh (a BVH's is its file's). Throws Error(file).
std::vector<std::string> clip_names(const std::filesystem::path& path);

// Reads the cameras of a .glb, .gltf or .vrm as its nodes stand; another file has none. `unit`: metres per file unit.
// Throws Error(file).
std::vector<ClipCamera> read_still_cameras(const std::filesystem::path& path, double unit);

// Writes an animation-only .glb: the skeleton as a skin that draws nothing, and one LINEAR animation with a key per
// frame. Other programs take the skin for one armature. Throws Error(file).
void write_clip(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);
// Writes the unit of the character's file (metres; 0: metres), as a DCC would export it, and as clip_unit() says.
void write_clip(Clip clip, Skeleton skeleton, double unit, const std::filesystem::path& path);

// The frames of read_clip()'s clip that are nearest to a key of any channel, rising. None of a BVH, which samples its
// motion. Throws Error(file).
std::vector<int> clip_keys(const std::string& source, const ClipOptions& options);

}  // namespace bodyopt
