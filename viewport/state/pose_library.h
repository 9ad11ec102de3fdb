// The poses of a folder, to be chosen by what they look like.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "draw/png.h"
#include "shots/session/view_settings.h"

namespace bodyopt::viewport {

inline constexpr std::uint32_t kPosePicture = 96;  // pixels a side

struct PoseFile {
  std::filesystem::path path;
  std::filesystem::file_time_type written;
  shots::ViewSettings::PoseKey pose{};
  std::string problem{};  // why it cannot be read; empty: it can
  draw::Image picture{};  // no pixels: it is to be drawn yet
  bool is_pose = true;    // or a file of settings, a session, anything else
};

class PoseLibrary {
 public:
  // Files that are new there are read, for a twentieth of a second. Whether anything has changed.
  bool look(const std::filesystem::path& folder);
  // Files that are poses, or damaged, in the order of names.
  const std::vector<PoseFile>& poses() const { return poses_; }
  static constexpr std::size_t kMostPictures = 200;  // of a folder
  std::vector<draw::Image> pictures() const;         // those that there are
  // One that can be drawn, and is not; null: there is none.
  const PoseFile* without_picture() const;
  void set_picture(const std::filesystem::path& path, draw::Image picture);
  bool has_more() const { return has_more_; }  // to be read
  bool has_work() const { return has_more_ || without_picture(); }
  std::uint64_t version() const { return version_; }  // another after each change

 private:
  std::filesystem::path folder_;
  std::vector<PoseFile> files_, poses_;
  bool has_more_ = false;
  std::uint64_t version_ = 0;
};

// Returns the picture beside a pose's file.
std::filesystem::path picture_of_pose(std::filesystem::path pose);

}  // namespace bodyopt::viewport
