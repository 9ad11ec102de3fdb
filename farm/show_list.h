// The list of what a show needs evaluated, as its coordinators write it: JSON, JSON lines or CSV.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bodyopt::farm {

// One character in one shot. Paths are absolute.
struct ShowElement {
  std::string place;  // "elements[3]" or "line 5", for messages
  std::string shot, element;
  std::string session;  // of the viewport: in place of the basis and the clip; empty: there is none
  std::string basis, clip, frames, out;
  double frame_ms = 0;  // what a frame takes on one core; 0: as estimated
  // Further options of `bodyopt eval` by name, without "--"; flags have an empty list.
  std::map<std::string, std::vector<std::string>> options;

  bool has(const char* option) const { return options.contains(option); }
  // The option's only value, or `otherwise`.
  std::string option(const char* name, const std::string& otherwise) const;
};

struct ShowList {
  std::string show;  // a name for queues
  std::vector<ShowElement> elements;
  std::vector<std::string> notes;  // for the user
};

// The ending tells the format: .jsonl, .csv, or else JSON. Faults of an element go to `problems`, a sentence each, and
// the element is left out. Throws Error(file) where the file as a whole cannot be read.
ShowList read_show_list(const std::filesystem::path& path, std::vector<std::string>& problems);

// The records of comma-separated values (RFC 4180): quoted fields may hold commas, quotes and ends of lines. Throws
// Error(file) whose text starts with `origin`.
std::vector<std::vector<std::string>> parse_csv(const std::string& text, const std::string& origin);

}  // namespace bodyopt::farm
