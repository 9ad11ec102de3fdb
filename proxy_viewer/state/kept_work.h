// What outlives the viewport, in a folder of the user's: which files were open lately, and sessions that nobody saved.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt {

class KeptWork {
 public:
  static constexpr std::size_t kMostRecent = 10;

  // An empty folder: nothing is kept.
  explicit KeptWork(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // The last first.
  std::vector<std::string> recent() const;
  void remember(const std::string& file) const;  // throws Error(file)

  // Where this process puts its session aside, in a folder that is there; empty: nowhere. Throws Error(file).
  std::filesystem::path aside() const;
  // The newest that a process put aside which has ended since; empty: none.
  std::filesystem::path left_behind() const;
  // That is this process' own from now on.
  void take_over(const std::filesystem::path& left) const;
  void forget() const;  // this process' own

 private:
  std::filesystem::path own() const;

  std::filesystem::path folder_;
};

}  // namespace bodyopt
