#include "viewport/state/pose_library.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "draw/image_decode.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestPose = 1 << 20;  // bytes: other JSON may be larger
constexpr std::chrono::milliseconds kReads{50};

std::string bytes_of(const fs::path& path) { return read_file(path, kLargestPose, "a pose or its picture"); }

// Files of another schema, as manifests, sessions and limits, are none.
bool is_damaged_pose(const fs::path& path) {
  try {
    const Json json = parse_strict_json(bytes_of(path), path.string());
    return json.is_object() && json.value("schema", Json()) == shots::kViewSchema;
  } catch (const Error&) {
    return true;
  }
}

// Returns none where there is no picture, or it is older than the pose.
draw::Image kept_picture(const PoseFile& file) {
  const fs::path path = picture_of_pose(file.path);
  std::error_code absent;
  if (fs::last_write_time(path, absent) < file.written || absent) return {};
  try {
    const std::string bytes = bytes_of(path);
    draw::Image picture = draw::decode_image(std::as_bytes(std::span(bytes)));
    return picture.width == kPosePicture && picture.height == kPosePicture ? picture : draw::Image();
  } catch (const Error&) {
    return {};
  }
}

void read_pose(PoseFile& file) {
  std::error_code gone;
  const std::uintmax_t size = fs::file_size(file.path, gone);
  file.is_pose = !gone && size <= kLargestPose;
  if (!file.is_pose) return;
  try {
    file.pose = shots::read_view_settings(file.path).pose;
    file.is_pose = file.pose != shots::ViewSettings::PoseKey();
    file.picture = kept_picture(file);
  } catch (const Error& error) {
    file.problem = error.what();
    file.is_pose = is_damaged_pose(file.path);
  }
}

std::vector<PoseFile> list_json(const fs::path& folder) {
  std::vector<PoseFile> files;
  std::error_code unreadable;
  for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable)) {
    std::error_code gone;
    const fs::file_time_type written = entry->last_write_time(gone);
    if (!gone && entry->path().extension() == ".json") files.push_back({entry->path(), written});
  }
  std::ranges::sort(files, {}, &PoseFile::path);
  return files;
}

}  // namespace

bool PoseLibrary::look(const fs::path& folder) {
  const auto until = std::chrono::steady_clock::now() + kReads;
  bool changed = std::exchange(folder_, folder) != folder;
  if (changed) files_.clear();
  std::vector<PoseFile> found;
  has_more_ = false;
  for (PoseFile& file : list_json(folder)) {
    const auto known = std::ranges::lower_bound(files_, file.path, {}, &PoseFile::path);  // in the same order
    if (known != files_.end() && known->path == file.path && known->written == file.written) {
      found.push_back(*known);
    } else if (changed && std::chrono::steady_clock::now() > until) {  // one at least is read each time
      has_more_ = true;
    } else {
      read_pose(file);
      found.push_back(std::move(file));
      changed = true;
    }
  }
  changed |= found.size() != files_.size();
  if (!changed) return false;
  files_ = std::move(found);
  poses_.clear();
  std::ranges::copy_if(files_, std::back_inserter(poses_), &PoseFile::is_pose);
  ++version_;
  return true;
}

std::vector<draw::Image> PoseLibrary::pictures() const {
  std::vector<draw::Image> pictures;
  for (const PoseFile& file : poses_) {
    if (file.picture.width > 0 && pictures.size() < kMostPictures) pictures.push_back(file.picture);
  }
  return pictures;
}

const PoseFile* PoseLibrary::without_picture() const {
  if (pictures().size() == kMostPictures) return nullptr;
  const auto found = std::ranges::find_if(
      poses_, [](const PoseFile& file) { return file.picture.width == 0 && file.problem.empty(); });
  return found == poses_.end() ? nullptr : &*found;
}

void PoseLibrary::set_picture(const fs::path& path, draw::Image picture) {
  for (std::vector<PoseFile>* files : {&files_, &poses_}) {
    const auto found = std::ranges::find(*files, path, &PoseFile::path);
    if (found != files->end()) found->picture = picture;
  }
  ++version_;
}

fs::path picture_of_pose(fs::path pose) { return pose.replace_extension(".thumbnail.png"); }

}  // namespace bodyopt::viewport
