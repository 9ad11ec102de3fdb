// Keeps unsaved work, for the next viewport to bring back where this one does not end as it should.
#pragma once

#include <filesystem>
#include <optional>

#include "runtime/core/atomic_file.h"

namespace bodyopt::viewport {

// Session files of a user's folder, one of each viewport that runs, which has it locked.
class Autosave {
 public:
  // An empty folder: nothing is kept.
  explicit Autosave(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // This viewport's own file, locked from the first call on, in a folder that is there; empty: none. Throws
  // Error(file).
  std::filesystem::path file();
  // Returns the newest file of a viewport that has ended since; empty: none.
  std::filesystem::path left_behind() const;
  // Makes that this viewport's own from now on. Throws Error(file).
  void take_over(const std::filesystem::path& left);
  void forget();  // this viewport's own
  // Leaves this viewport's own file for another to find; false: there was none.
  bool leave();

 private:
  std::filesystem::path folder_, file_;
  std::optional<FileLock> lock_;
};

}  // namespace bodyopt::viewport
