// modifiers/exported/: which frames were given out to be sculpted, and what stack made them, a file each: what two
// artists give out merges.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/modifier.h"

namespace bodyopt {

// As the file has it.
struct ExportRecord {
  std::string take;
  int frame = 0;
  std::string skin;                 // a PC2 cache of one sample, un-posed, relative to the dataset's folder
  std::vector<Modifier> modifiers;  // the stack that made it
  bool operator==(const ExportRecord&) const = default;
};

// A hash of it, as export_mark() writes it: what its mesh is named by.
std::string mark_of(const ExportRecord& record);

// The files that exports are written down in, the latest last; the first may be of an earlier version, which wrote all
// into modifiers/exported.json.
std::vector<std::filesystem::path> export_files(const Dataset& dataset);
// One record, or those of an earlier version's file, the latest last. Throws Error(file).
std::vector<ExportRecord> read_export_file(const std::filesystem::path& path);
// Writes one down as the latest; 200 stay. The caller holds the dataset's lock. Throws Error(file).
void write_export(const ExportRecord& record, const Dataset& dataset);
// Takes the files away. The caller holds the dataset's lock. Throws Error(file).
void forget_exports(const Dataset& dataset);

}  // namespace bodyopt
