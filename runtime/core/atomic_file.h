// Files that are there whole or not at all: written under a temporary name in the same folder, then renamed.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace bodyopt {

// The target of a symbolic link, which may not exist yet, since that is replaced and not the link; any other path as it
// is. Throws Error(file) for a link that leads back to itself.
[[nodiscard]] std::filesystem::path link_target(const std::filesystem::path& path);

// A file being written. commit() flushes it to the disk and renames it; destroyed before that, it leaves nothing
// behind. A killed process leaves `.bodyopt.HOST.PROCESS.RANDOM.tmp` beside the file, until another on the same host
// first writes into that folder. Links in the place of the temporary file are not followed; devices and pipes in the
// place of the file are not replaced. Every failure throws Error(file) naming the path and the system's reason.
class [[nodiscard]] AtomicFile {
 public:
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  // Where it is until then: another program may write it.
  const std::filesystem::path& temporary() const { return temporary_; }
  // Drops what was written so far.
  void restart();
  // Appends the bytes of a file.
  void write_file(const std::filesystem::path& file);
  // Appends what another, which stays unfinished, holds so far.
  void write_unfinished(AtomicFile& other);
  void commit();
  // Renames it without waiting for the disk: where the machine fails soon after, the file may be there and hold
  // anything. Use it for what is checked when it is read, and can be made again.
  void commit_unflushed();
  // Puts what was written so far aside under another name in the same file system, whole; nothing is left to commit.
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
inline void write_file_atomically(const std::filesystem::path& path, std::string_view text) {
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

// Keeps processes that change one file from doing so at the same time.

// A lock of the system on a file of its own, held while this lives. The system gives it up when the process dies; what
// is left of the file locks nothing. Over NFS it holds where the server gives locks.
class [[nodiscard]] FileLock {
 public:
  // Holds the lock, or does not where another does. Makes `lock`, a file that is nothing else and no link. Throws
  // Error(file) where it cannot be made, and where the file system gives no locks.
  explicit FileLock(std::filesystem::path lock);
  FileLock(FileLock&&) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

  [[nodiscard]] bool is_held() const { return file_ >= 0; }
  // Only while it is held. A process that opened the file before finds it gone from its path. Over NFS it may not,
  // where its machine remembers the folder as it was.
  void remove_file() const;

 private:
  [[nodiscard]] bool take();

  std::filesystem::path path_;
  int file_ = -1;
};

// Keeps a second run from doing the same work, which would mix up what both write. The lock's file goes with it.
class [[nodiscard]] RunLock {
 public:
  // Throws Error(file), saying `why`, where another run holds it.
  RunLock(const std::filesystem::path& lock, const std::string& why);
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  FileLock lock_;
};

// A change takes milliseconds; one that takes so long hangs.
constexpr std::chrono::milliseconds kPatienceForChanges = std::chrono::minutes(1);

// The right to change `file`, which may not exist yet. Hold it from before reading until the new file is renamed into
// place, so that no change of another process is lost. Waits while another has it; throws Error(file) where that does
// not end in time. `.NAME.lock` beside the file stays there, empty: removing it would not be safe over NFS.
FileLock lock_to_change(const std::filesystem::path& file, std::chrono::milliseconds patience = kPatienceForChanges);

}  // namespace bodyopt
