// Keeps processes that change one file from doing so at the same time.
#pragma once

#include <chrono>
#include <filesystem>
#include <string>

namespace bodyopt {

// A lock of the system on a file of its own, held while this lives. The system gives it up when the process dies,
// however it dies; what is left of the file then locks nothing. Over NFS it holds between machines where the server
// gives locks.
class [[nodiscard]] FileLock {
 public:
  // Holds the lock, or does not where another does. Makes `lock`, a file that is nothing else and no link. Throws
  // Error(file) where it cannot be made, and where the file system gives no locks.
  explicit FileLock(std::filesystem::path lock);
  FileLock(FileLock&&) noexcept;
  FileLock& operator=(FileLock&&) = delete;
  ~FileLock();

  [[nodiscard]] bool is_held() const { return file_ >= 0; }
  // While it is held. A process that opened the file before finds that it is not at its path any more; over NFS it may
  // not, where its machine remembers the folder as it was.
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

// A change takes milliseconds; one that takes so long stands still.
constexpr std::chrono::milliseconds kPatienceForChanges = std::chrono::minutes(1);

// The right to change `file`, which may not be there yet: to be held from before it is read until it is renamed into
// place, so that no change of another process is lost. Waits while another has it; throws Error(file) where that does
// not end in time. `.NAME.lock` beside the file stays there, empty: removing it would not be safe over NFS.
FileLock lock_to_change(const std::filesystem::path& file, std::chrono::milliseconds patience = kPatienceForChanges);

}  // namespace bodyopt
