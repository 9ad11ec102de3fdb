// Shared functions of the readers and writers of clips.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "assets/clips/clip.h"

namespace bodyopt {

// The number of frames from time 0 to the end, both included, at options.fps. An end short of a frame by 1e-5 of the
// duration counts as that frame. Throws Error(file) for a motion of `joints` joints too long to hold and Error(usage)
// when the frame numbers overflow.
std::size_t frame_count(const std::string& file, double duration, std::size_t joints, const ClipOptions& options);

// Throws Error(mismatch) with both lists of names.
[[noreturn]] void fail_unmatched(const std::string& file, const Skeleton& skeleton, std::span<const std::string> names);

// Throws Error(file) where a joint's place is no finite number.
void check_positions(const Clip& clip, const std::string& file);

// Throws Error(file) for a clip that cannot be written: without frames, or with other joints than the skeleton's.
void require_poses(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path);

}  // namespace bodyopt
