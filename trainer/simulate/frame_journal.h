// Frames finished so far by a run of simulate, on disk: what lets a killed run go on.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "trainer/dataset/dataset.h"

namespace bodyopt {

// An append-only file beside the cache. Each record carries its own checksum: one cut off by a kill is dropped.
class FrameJournal {
 public:
  // Opens or starts the journal of a run. Records of a run with other inputs (`inputs_hash`) are thrown away.
  // Throws Error(file).
  FrameJournal(const std::filesystem::path& path, std::uint64_t inputs_hash, std::size_t floats_per_frame);
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  bool has(int frame) const { return offsets_.contains(frame); }
  const FrameStatus& status(int frame) const { return status_.at(frame); }
  // Stores one finished frame; it is on its way to the disk when this returns.
  void append(const FrameStatus& status, std::span<const float> shape);
  std::vector<float> shape(int frame);
  // The cache is written: the journal has done its work.
  void remove();

 private:
  void read_records();
  [[noreturn]] void fail(const char* doing) const;

  std::filesystem::path path_;
  std::uint64_t inputs_hash_;
  std::size_t floats_per_frame_;
  std::FILE* file_ = nullptr;
  std::map<int, long> offsets_;  // of the shape's floats in the file
  std::map<int, FrameStatus> status_;
};

}  // namespace bodyopt
