// Files that are there whole or not at all: written under a temporary name in the same folder, then renamed.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <span>

namespace bodyopt {

// The file that a symbolic link names, which is what is replaced, and not the link; of anything else the path.
[[nodiscard]] std::filesystem::path link_target(const std::filesystem::path& path);

// A file being written. commit() flushes it to the disk and renames it; destroyed before that, nothing is left behind.
// Of a process that is killed `.bodyopt.HOST.PROCESS.RANDOM.tmp` is left beside the file, until another on the same
// host first writes into that folder. Links in the place of the temporary file are not followed; devices and pipes in
// the place of the file are not replaced. Every failure throws Error(file) naming the path and the system's reason.
class [[nodiscard]] AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  // Drops what was written so far.
  void restart();
  // Appends the bytes of a file.
  void write_file(const std::filesystem::path& file);
  // Appends what another, which stays unfinished, holds so far.
  void write_unfinished(AtomicFile& other);
  void commit();
  // Renames it without waiting for the disk: where the machine fails soon after, the file may be there and hold
  // anything. For what is checked when it is read, and can be made again.
  void commit_unflushed();
  // Puts what was written so far aside under another name in the same folder or file system, whole; nothing is left to
  // commit.
  void put_aside(const std::filesystem::path& path);

 private:
  void require_replaceable() const;
  void rename_to(const std::filesystem::path& path);
  void flush_and_rename_to(const std::filesystem::path& path);
  [[noreturn]] void fail(const char* doing) const;
  std::filesystem::path path_, temporary_;
  std::FILE* file_ = nullptr;
};

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace bodyopt
