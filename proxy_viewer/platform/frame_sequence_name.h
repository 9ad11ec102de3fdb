// Names of the pictures of a sequence.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace bodyopt {

// A file name with a place for the frame: `img.####.png` (as many digits at least as there are #) or `img.%04d.png`.
// Both write a minus before the digits and count it among them.
class FrameSequenceName {
 public:
  // Without a place the name is that of a single picture. Throws Error(usage) for more than one place, and for
  // more than one frame without a place.
  FrameSequenceName(const std::filesystem::path& pattern, std::size_t frame_count);

  std::filesystem::path operator()(int frame) const;

 private:
  std::filesystem::path folder_;
  std::string before_, after_;  // the place
  std::size_t digits_ = 0;      // 0: no place
};

}  // namespace bodyopt
