#include "cli/arguments/dataset_arguments.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>

#include "assets/clip_source.h"
#include "assets/frame_range.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

// A clip's source with its file made relative to a folder.
std::string relative_source(const fs::path& folder, const std::string& source) {
  const ClipSource split = split_source(source);
  return relative_to(folder, split.path.string()) + (split.name.empty() ? "" : '#' + split.name);
}

std::string called(const std::string& source) {
  const ClipSource split = split_source(source);
  std::string name = split.name.empty() ? split.path.stem().string() : split.name;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  }
  return name;
}

// Files are called by a take's name, in the dataset's folder and nowhere else.
std::string refuse_as_name(const std::string& name) {
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.';
  };
  if (!name.empty() && name.front() != '.' && std::ranges::all_of(name, fits)) return "";
  return "expected a name of letters, digits, '-', '_' and '.', and no '.' first, found '" + name + "'";
}

bool has(const std::vector<int>& frames, int frame) { return std::ranges::find(frames, frame) != frames.end(); }

}  // namespace

std::string TakeArguments::take_name() const { return name.empty() ? called(clip.source) : name; }

void TakeArguments::add(CLI::App& verb) {
  clip.add(verb);
  add_option(verb, "--name", name, "Name of the take (default: the clip's)")->check(refuse_as_name);
  add_option(verb, "--heldout", heldout, "R", "Frames never to train on, as a range, or 'all'");
}

DatasetTake TakeArguments::take(const std::vector<int>& frames, const fs::path& folder) const {
  DatasetTake take;
  take.name = take_name();
  take.clip = relative_source(folder, clip.source);
  take.fps = clip.options.fps;
  take.first_frame = clip.options.first_frame;
  take.controls = relative_to(folder, clip.options.controls);
  take.joint_map = relative_to(folder, clip.options.joint_map);
  take.up = clip.options.up;
  take.frames = frames;
  if (heldout == "all") {
    take.heldout = frames;
  } else if (!heldout.empty()) {
    take.heldout = parse_frame_range(heldout);
    for (const int frame : take.heldout) {
      if (has(frames, frame)) continue;
      throw Error(ErrorKind::usage,
                  format("--heldout names frame {}, which is not among the frames of --frames", frame));
    }
  }
  return take;
}

std::string relative_to(const fs::path& folder, const std::string& path) {
  return path.empty() ? path : fs::proximate(path, folder).string();
}

void say_heldout(const DatasetTake& take, const DatasetTake& asked) {
  const auto kept = std::ranges::count_if(
      asked.frames, [&](int frame) { return has(take.heldout, frame) && !has(asked.heldout, frame); });
  if (kept == 0) return;
  spdlog::warn("{} of {} frames are held out: train will not learn from them", kept, asked.frames.size());
}

}  // namespace bodyopt::cli
