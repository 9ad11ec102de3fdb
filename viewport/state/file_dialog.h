// A file that is being chosen for a command.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt::viewport {

struct FolderEntry {
  std::string name;
  bool is_folder = false;
  bool operator==(const FolderEntry&) const = default;
};

struct FileDialog {
  std::string command;           // that takes it
  std::filesystem::path folder;  // absolute
  std::string name;              // as chosen or typed so far
  std::vector<FolderEntry> entries{};
  bool is_typed = false;  // the name, before its field heard

  std::string file() const { return (folder / name).string(); }
  // Whether there is a file of the name already.
  bool replaces() const;
};

// Commands that a file can be chosen for: one of these names.
std::vector<std::string> browsed_commands();

// A name for what one of them writes, which no file of the folder has; empty for one that reads.
std::string proposed_name(const std::string& command, const std::filesystem::path& folder);
bool writes_file(const std::string& command);

// Lists a folder for a command: ".." and other folders, then files of the command's kinds; by name, nothing hidden.
// Throws Error(file) where it cannot be read, Error(usage) at another command.
FileDialog browse_folder(const std::string& command, const std::filesystem::path& folder, std::string name = "");

}  // namespace bodyopt::viewport
