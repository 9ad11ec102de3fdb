#include "viewport/state/file_dialog.h"

#include <algorithm>
#include <map>
#include <system_error>
#include <tuple>

#include "assets/clips/clip_source.h"
#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

struct FileKind {
  std::vector<std::string> endings;
  std::string proposed;  // a name, where the command writes
};

// Kinds of files by command.
const std::map<std::string, FileKind>& kinds() {
  static const std::map<std::string, FileKind> all = {
      {"open", {{".safetensors", ".glb", ".gltf", ".vrm", ".fbx", ".bvh", ".pc2", ".mdd", ".json"}, ""}},
      {"character", {{".safetensors", ".glb", ".gltf", ".vrm", ".fbx"}, ""}},
      {"save", {{".json"}, "session.json"}},
      {"save-state", {{".json"}, "view.json"}},
      {"load-state", {{".json"}, ""}},
      {"limits", {{".json"}, ""}},
      {"sound", {{".wav"}, ""}},
      {"image-plane", {{".png", ".jpg", ".jpeg", ".webp"}, ""}},
      {"save-pose", {{".json"}, "pose.json"}},
      {"load-pose", {{".json"}, ""}},
      {"export-clip", {{".glb", ".bvh", ".usda"}, "motion.glb"}},
      {"export-skin", {{".glb", ".pc2", ".mdd", ".usda"}, "skin.glb"}},
      {"screenshot", {{".png"}, "picture.png"}},
      {"sequence", {{".webp", ".mp4", ".png"}, "movie.webp"}},
      {"turntable", {{".png"}, "turntable.####.png"}}};
  return all;
}

// Whether a file is of that name, in which each '#' is a digit of a picture's number.
bool is_named(const std::string& file, const std::string& name) {
  return std::ranges::equal(name, file, [](char in_name, char in_file) {
    return in_name == '#' ? in_file >= '0' && in_file <= '9' : in_name == in_file;
  });
}

bool is_taken(const fs::path& folder, const std::string& name) {
  std::error_code unreadable;
  for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable)) {
    if (is_named(entry->path().filename().string(), name)) return true;
  }
  return false;
}

// The name, or the first with a number before its first dot that no file of the folder has.
std::string free_name(const fs::path& folder, const std::string& name) {
  const std::size_t dot = name.find('.');
  std::string free = name;
  for (int k = 2; is_taken(folder, free); ++k) free = name.substr(0, dot) + "_" + std::to_string(k) + name.substr(dot);
  return free;
}

bool is_hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

}  // namespace

bool FileDialog::replaces() const {
  return std::ranges::any_of(entries, [&](const FolderEntry& e) { return !e.is_folder && is_named(e.name, name); });
}

std::vector<std::string> browsed_commands() {
  std::vector<std::string> names;
  for (const auto& [name, kind] : kinds()) names.push_back(name);
  return names;
}

std::string proposed_name(const std::string& command, const fs::path& folder) {
  const std::string& name = kinds().at(command).proposed;
  return name.empty() ? name : free_name(folder, name);
}

bool writes_file(const std::string& command) { return !kinds().at(command).proposed.empty(); }

FileDialog browse_folder(const std::string& command, const fs::path& folder, std::string name) {
  const auto kind = kinds().find(command);
  if (kind == kinds().end()) throw Error(ErrorKind::usage, "'" + command + "' takes no file that could be chosen");
  FileDialog dialog{command, fs::absolute(folder).lexically_normal(), std::move(name)};
  std::error_code problem;
  fs::directory_iterator entries(dialog.folder, problem);
  if (problem) {
    throw Error(ErrorKind::file, dialog.folder.string() + ": cannot be listed: " + problem.message() +
                                     " (is it a folder that you may read?)");
  }
  for (; entries != fs::directory_iterator(); entries.increment(problem)) {
    if (problem) break;
    const fs::path& path = entries->path();
    if (is_hidden(path)) continue;
    std::error_code gone;
    const bool is_folder = fs::is_directory(path, gone);
    const bool is_known =
        std::ranges::find(kind->second.endings, lower_case_extension(path)) != kind->second.endings.end();
    if (is_folder || is_known) dialog.entries.push_back({path.filename().string(), is_folder});
  }
  std::ranges::sort(dialog.entries, {}, [](const FolderEntry& e) { return std::tuple(!e.is_folder, e.name); });
  dialog.entries.insert(dialog.entries.begin(), {"..", true});
  return dialog;
}

}  // namespace bodyopt::viewport
