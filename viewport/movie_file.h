// Movies that players show: MP4, which the program ffmpeg encodes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "base/child_process.h"
#include "draw/png.h"
#include "runtime/core/atomic_file.h"

namespace bodyopt::viewport {

// A file that is there whole or not at all, as AtomicFile. Sides that are odd lose a pixel, as its colours need pairs.
class MovieFile {
 public:
  struct Plan {
    double fps;               // frames a second
    std::size_t count = 1;    // frames: a sound ends with them
    std::string sound{};      // a file; empty: none
    double sound_begins = 0;  // seconds after the first frame, or before it
  };
  // Throws Error(file).
  MovieFile(const std::filesystem::path& path, Plan plan) : path_(path), plan_(std::move(plan)), file_(path) {}

  // Frames have one size. Throw Error(usage) where there is no ffmpeg, Error(file) with its reason where it fails.
  void add(const draw::Image& frame);
  void finish();

 private:
  void end_encoder();

  const std::filesystem::path path_;
  const Plan plan_;
  AtomicFile file_;
  std::optional<ChildProgram> encoder_;  // from the first frame on
};

}  // namespace bodyopt::viewport
