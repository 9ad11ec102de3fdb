// A file that another takes the place of, again and again, as a writer's next version does.
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/support/hostile_bytes.h"

namespace bodyopt::testing {

// While it lives, `path` holds either of the two, whole.
class ReplacedFile {
 public:
  ReplacedFile(const std::filesystem::path& path, const std::string& a, const std::string& b) {
    write_bytes(path, a);
    writer_ = std::thread([this, path, versions = std::array{a, b}] {
      const std::filesystem::path next = path.string() + ".next";
      for (std::size_t k = 0; !done_; ++k) {
        write_bytes(next, versions[k % 2]);
        std::filesystem::rename(next, path);
      }
    });
  }
  ~ReplacedFile() {
    done_ = true;
    writer_.join();
  }
  ReplacedFile(const ReplacedFile&) = delete;
  ReplacedFile& operator=(const ReplacedFile&) = delete;

 private:
  std::atomic<bool> done_{false};
  std::thread writer_;
};

}  // namespace bodyopt::testing
