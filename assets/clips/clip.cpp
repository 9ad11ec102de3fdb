#include "assets/clips/clip.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "assets/clips/bvh_clip.h"
#include "assets/clips/clip_common.h"
#include "assets/clips/clip_source.h"
#include "assets/clips/controls.h"
#include "assets/clips/gltf_clip.h"
#include "assets/clips/motion_up.h"
#include "assets/gltf/gltf_file.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

constexpr double kMaxClipFrames = 1e6, kMaxTransforms = 2e7;  // of a clip: more would not fit in memory

void check_options(const ClipOptions& options) {
  if (!(options.fps > 0) || !(options.fps <= 1e5)) {
    throw Error(ErrorKind::usage, "frames per second must be above 0 and at most 100,000, not ", options.fps);
  }
  if (!(options.unit >= 0) || !std::isfinite(options.unit)) {
    throw Error(ErrorKind::usage, "a unit is a positive number of metres, not ", options.unit);
  }
  if (!options.up.empty() && !named_axis(options.up)) {
    throw Error(ErrorKind::usage, "an axis that is up is x, y, z, -x, -y or -z, not '", options.up, "'");
  }
}

}  // namespace

ClipSource split_source(const std::string& source) {
  const std::size_t hash = source.rfind('#');
  std::error_code ignored;
  if (hash == std::string::npos || std::filesystem::exists(source, ignored)) return {source, ""};
  return {source.substr(0, hash), source.substr(hash + 1)};
}

std::string lower_case_extension(const std::filesystem::path& path) { return lower_case(path.extension().string()); }

bool is_called_scene(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  return extension == ".glb" || extension == ".gltf" || extension == ".vrm" || extension == ".fbx";
}

std::size_t frame_count(const std::string& file, double duration, std::size_t joints, const ClipOptions& options) {
  // Times are rounded (single precision; "Frame Time: .0083333"): the last frame may seem to lie beyond the end.
  const double last = duration * options.fps;
  const double frames = std::floor(last + 1e-3 + std::min(1e-5 * last, 0.5)) + 1;
  if (!(frames <= kMaxClipFrames) || frames * static_cast<double>(joints) > kMaxTransforms) {
    throw Error(ErrorKind::file, file, ": the motion lasts ", duration, " seconds, too many frames at ", options.fps,
                " per second; the file is damaged, or --fps too high");
  }
  if (options.first_frame > std::numeric_limits<int>::max() - static_cast<int>(frames)) {
    throw Error(ErrorKind::usage, "the first frame ", options.first_frame, " is too large");
  }
  return static_cast<std::size_t>(frames);
}

void fail_unmatched(const std::string& file, const Skeleton& skeleton, std::span<const std::string> names) {
  const std::vector<std::string> joints = transformed(skeleton.joints, &Joint::name);
  throw Error(ErrorKind::mismatch, file, ": moves no joint of the character; the clip has ", list_names(names),
              ", the character ", list_names(joints),
              ". Was it made for another skeleton? A joint map (--joint-map) can say what moves what");
}

void check_positions(const Clip& clip, const std::string& file) {
  for (const Pose& pose : clip.poses) {
    for (const JointTransform& t : pose.joints) {
      if (!std::isfinite(length(t.translation))) {
        throw Error(ErrorKind::file, file, ": its positions are out of range; the file is damaged");
      }
    }
  }
}

double clip_unit(const std::string& source, double character_unit) {
  const std::string extension = lower_case_extension(split_source(source).path);
  return extension == ".bvh" || extension == ".fbx" ? 0 : character_unit;
}

namespace {

Clip read_motion(const std::string& source, const SkeletonChoice& choose, const ClipOptions& options) {
  const ClipSource parts = split_source(source);
  if (is_called_scene(parts.path)) {
    if (!options.up.empty()) {
      throw Error(ErrorKind::usage, source, ": only a BVH file does not say what is up; --up is for these");
    }
    return read_gltf_clip(GltfFile(parts.path), parts.name, choose, options);
  }
  if (lower_case_extension(parts.path) != ".bvh") {
    throw Error(ErrorKind::file, source,
                ": not a clip; expected FILE.glb#name, FILE.glb, FILE.gltf, FILE.fbx or FILE.bvh",
                looks_like(parts.path));
  }
  if (!parts.name.empty()) {
    throw Error(ErrorKind::file, source, ": a .bvh file holds a single clip without a name; leave out '#", parts.name,
                "'");
  }
  return read_bvh_clip(parts.path, choose, options);
}

}  // namespace

Clip read_clip(const std::string& source, const Skeleton& skeleton, const ClipOptions& options) {
  return read_clip(
      source, [&](const std::set<std::string>&) { return skeleton; }, options);
}

Clip read_clip(const std::string& source, const SkeletonChoice& choose, const ClipOptions& options) {
  check_options(options);
  Clip clip = read_motion(source, choose, options);
  if (!options.controls.empty()) read_controls(options.controls, clip);
  return clip;
}

std::vector<int> clip_keys(const std::string& source, const ClipOptions& options) {
  const ClipSource parts = split_source(source);
  if (lower_case_extension(parts.path) == ".bvh") return {};
  return read_gltf_keys(parts.path, parts.name, options);
}

std::vector<std::string> clip_names(const std::filesystem::path& path) {
  if (lower_case_extension(path) == ".bvh") {
    require_file(path);
    return {path.stem().string()};
  }
  const GltfFile file(path);
  return transformed(file.model().animations, [&](const tinygltf::Animation& animation) { return animation.name; });
}

}  // namespace bodyopt
