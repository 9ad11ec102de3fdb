// Finished frames of a simulation that is not yet whole: kept in a file that survives being killed at any moment.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "dataset/dataset.h"

namespace bodyopt::trainer {

// Was a frame solved to its end, or given up after no fewer iterations than these?
bool is_final(const FrameStatus& status, int give_up_after);

// Layout, little-endian: "BODYPART", uint64 inputs, uint64 values per frame; then records. A record is uint64 key,
// double residual, double seconds, int32 iterations, int32 inverted tets, double contact depth, double volume change,
// float values, uint64 checksum. The checksum is the xxh3 of the record before it. Records are only ever appended, so a
// kill harms at most the last one, and that is cut off when the file is opened again.
class PartialShapes {
 public:
  // Opens the file or starts a new one. What is there of other inputs is put aside as `path`.old, with a warning.
  // Frames that are not final are as if they were not there. Throws Error(file).
  PartialShapes(std::filesystem::path path, std::uint64_t inputs, std::size_t values_per_frame, int give_up_after,
                const std::function<void(const std::string&)>& warn);
  ~PartialShapes();
  PartialShapes(const PartialShapes&) = delete;
  PartialShapes& operator=(const PartialShapes&) = delete;

  bool has(std::uint64_t key) const { return record_begin_.contains(key); }
  // values: as many as values_per_frame.
  void append(std::uint64_t key, const FrameStatus& status, std::span<const float> values);
  // The record of a key that is there. It does not know the frame of `status`, `converged`, inputs and
  // discretisation_error.
  std::vector<float> read(std::uint64_t key, FrameStatus& status) const;
  // Closes and deletes the file: its frames are elsewhere now.
  void remove();

 private:
  std::size_t record_size() const;
  void open_file();
  bool resume(std::uint64_t inputs, int give_up_after);
  void put_aside(const std::function<void(const std::string&)>& warn);
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_;
  std::size_t values_;
  int file_ = -1;
  std::uint64_t end_ = 0;
  std::map<std::uint64_t, std::uint64_t> record_begin_;  // by key, bytes from the start of the file
};

}  // namespace bodyopt::trainer
