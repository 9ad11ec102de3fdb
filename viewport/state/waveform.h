// A sound as it is drawn: how far it swings, part by part.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

namespace bodyopt::viewport {

struct Waveform {
  double rate = 200;                        // parts a second
  std::vector<std::array<float, 2>> parts;  // the least and the greatest of all channels, -1 to 1
  float loudest = 0;                        // of them all

  // Returns the range between two times, seconds from its beginning; nothing is silence.
  std::array<float, 2> swing(double from, double to) const;
};

// A WAV of integers or floats, however many channels. Throws Error(file).
Waveform read_waveform(const std::filesystem::path& path);

}  // namespace bodyopt::viewport
