// A .usda that UsdaWriter wrote, read line by line.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace bodyopt {

class UsdaPart {
 public:
  // Throws Error(file) for what UsdaWriter has not written, or what is cut off.
  explicit UsdaPart(const std::filesystem::path& path);

  // Every line of the samples that stand after `opening` (kUsdaPointSamples or kUsdaNormalSamples), in order. Throws
  // Error(file).
  void for_samples(const std::string& opening, const std::function<void(const std::string&)>& take);

  const std::filesystem::path& path() const { return path_; }
  const std::string& head() const { return head_; }  // but for the range of frames
  // The text up to the samples, with another last frame.
  std::string opening(const std::string& last_frame) const;
  const std::string& last_frame() const { return last_frame_; }
  const std::vector<int>& frames() const { return frames_; }
  // The points of frames()[sample], V x 3, metres. Throws Error(file) for numbers that are none or not finite.
  std::vector<float> points(std::size_t sample);
  // The text between the samples of points and of normals; without normals, the end of the file.
  const std::string& between() const { return between_; }
  bool has_normals() const { return has_normals_; }

 private:
  bool next() { return static_cast<bool>(std::getline(file_, line_)); }
  [[noreturn]] void refuse() const;
  void find_frames();

  std::filesystem::path path_;
  std::ifstream file_;
  std::string line_, head_, before_, after_, last_frame_, between_;
  std::streampos samples_begin_;
  std::vector<int> frames_;
  bool has_normals_ = false;
};

}  // namespace bodyopt
