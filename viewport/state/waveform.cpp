#include "viewport/state/waveform.h"

#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"

namespace bodyopt::viewport {
namespace {

constexpr double kLongest = 6 * 3600;  // seconds
constexpr int kFinest = 1'000'000, kCoarsest = 1000, kRate = 200;

// Returns the range of so many samples. What is no number is silence.
std::array<float, 2> swing_of(const std::vector<float>& samples, std::size_t count) {
  std::array<float, 2> swing{};
  for (std::size_t k = 0; k < count; ++k) {
    const float value = std::isnan(samples[k]) ? 0 : std::clamp(samples[k], -1.0f, 1.0f);
    swing = {std::min(swing[0], value), std::max(swing[1], value)};
  }
  return swing;
}

}  // namespace

std::array<float, 2> Waveform::swing(double from, double to) const {
  const auto index = [&](double seconds) {
    return static_cast<std::size_t>(std::clamp(seconds * rate, 0.0, static_cast<double>(parts.size())));
  };
  std::array<float, 2> all{};
  for (std::size_t k = index(from), end = index(to + 1 / rate); k < end; ++k) {
    all = {std::min(all[0], parts[k][0]), std::max(all[1], parts[k][1])};
  }
  return all;
}

Waveform read_waveform(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& problem) { throw Error(ErrorKind::file, path, ": ", problem); };
  require_file(path);
  SF_INFO info{};
  const std::unique_ptr<SNDFILE, decltype(&sf_close)> file(sf_open(path.c_str(), SFM_READ, &info), &sf_close);
  if (!file) refuse(std::string("cannot be read as a sound: ") + sf_strerror(nullptr) + looks_like(path));
  const int kind = info.format & SF_FORMAT_TYPEMASK;
  if (kind != SF_FORMAT_WAV && kind != SF_FORMAT_WAVEX) refuse("is a sound of another kind, expected a WAV");
  if (info.samplerate < kCoarsest || info.samplerate > kFinest) {
    refuse("has " + std::to_string(info.samplerate) + " samples a second, expected 1,000 to 1,000,000: it is damaged");
  }
  if (info.frames < 1) refuse("holds no sound: it is cut off, or was never finished");
  if (static_cast<double>(info.frames) > kLongest * info.samplerate) refuse("lasts longer than 6 hours");
  const int together = info.samplerate / kRate;
  Waveform wave;
  wave.rate = static_cast<double>(info.samplerate) / together;
  const auto channels = static_cast<std::size_t>(info.channels);
  std::vector<float> samples(channels * static_cast<std::size_t>(together));
  for (;;) {
    const sf_count_t got = sf_readf_float(file.get(), samples.data(), together);
    if (got <= 0) break;
    const auto [low, high] = wave.parts.emplace_back(swing_of(samples, channels * static_cast<std::size_t>(got)));
    wave.loudest = std::max({wave.loudest, -low, high});
  }
  if (sf_error(file.get()) != SF_ERR_NO_ERROR || wave.parts.empty()) {
    refuse(std::string("is damaged, or cut off: ") + sf_strerror(file.get()));
  }
  return wave;
}

}  // namespace bodyopt::viewport
