#include "trainer/simulate/frame_journal.h"

#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

struct JournalHeader {
  char magic[8] = {'b', 'o', 'd', 'y', 'o', 'p', 't', '1'};
  std::uint64_t inputs_hash = 0, floats_per_frame = 0;
};

struct RecordHeader {
  std::uint64_t checksum = 0;  // of the rest of the record
  double residual = 0, seconds = 0;
  std::int32_t frame = 0, iterations = 0, inverted_tets = 0, converged = 0;
};

std::uint64_t checksum_of(const RecordHeader& record, std::span<const float> shape) {
  const auto* fields = reinterpret_cast<const char*>(&record) + sizeof(record.checksum);
  const std::uint64_t own = XXH3_64bits(fields, sizeof(record) - sizeof(record.checksum));
  return XXH3_64bits_withSeed(shape.data(), shape.size_bytes(), own);
}

}  // namespace

FrameJournal::FrameJournal(const std::filesystem::path& path, std::uint64_t inputs_hash, std::size_t floats_per_frame)
    : path_(path), inputs_hash_(inputs_hash), floats_per_frame_(floats_per_frame) {
  file_ = std::fopen(path.c_str(), "r+b");
  if (file_ != nullptr) {
    read_records();
    return;
  }
  file_ = std::fopen(path.c_str(), "w+b");
  if (file_ == nullptr) fail("cannot be created");
  JournalHeader header;
  header.inputs_hash = inputs_hash_;
  header.floats_per_frame = floats_per_frame_;
  if (std::fwrite(&header, sizeof(header), 1, file_) != 1 || std::fflush(file_) != 0) fail("cannot be written");
}

FrameJournal::~FrameJournal() {
  if (file_ != nullptr) std::fclose(file_);
}

void FrameJournal::fail(const char* doing) const {
  throw Error(ErrorKind::file, path_.string() + ": " + doing + ": " + std::strerror(errno) +
                                   " (is the folder writable, and is the disk not full?)");
}

// Keeps the valid records at the file's start; the file goes on behind the last of them.
void FrameJournal::read_records() {
  JournalHeader header, expected;
  long end = static_cast<long>(sizeof(header));
  expected.inputs_hash = inputs_hash_;
  expected.floats_per_frame = floats_per_frame_;
  const bool same =
      std::fread(&header, sizeof(header), 1, file_) == 1 && std::memcmp(&header, &expected, sizeof(header)) == 0;
  std::vector<float> shape(floats_per_frame_);
  RecordHeader record;
  while (same && std::fread(&record, sizeof(record), 1, file_) == 1 &&
         std::fread(shape.data(), sizeof(float), shape.size(), file_) == shape.size() &&
         record.checksum == checksum_of(record, shape)) {
    offsets_[record.frame] = end + static_cast<long>(sizeof(record));
    status_[record.frame] = {record.frame,      record.residual, record.converged != 0,
                             record.iterations, record.seconds,  record.inverted_tets};
    end += static_cast<long>(sizeof(record) + floats_per_frame_ * sizeof(float));
  }
  std::rewind(file_);
  if (std::fwrite(&expected, sizeof(expected), 1, file_) != 1 || std::fflush(file_) != 0 ||
      ftruncate(fileno(file_), end) != 0 || std::fseek(file_, 0, SEEK_END) != 0) {
    fail("cannot be written");
  }
}

void FrameJournal::append(const FrameStatus& status, std::span<const float> shape) {
  RecordHeader record;
  record.residual = status.residual;
  record.seconds = status.seconds;
  record.frame = status.frame;
  record.iterations = status.iterations;
  record.inverted_tets = status.inverted_tets;
  record.converged = status.converged ? 1 : 0;
  record.checksum = checksum_of(record, shape);
  if (std::fseek(file_, 0, SEEK_END) != 0) fail("cannot be written");
  const long begin = std::ftell(file_);
  if (std::fwrite(&record, sizeof(record), 1, file_) != 1 ||
      std::fwrite(shape.data(), sizeof(float), shape.size(), file_) != shape.size() || std::fflush(file_) != 0) {
    fail("cannot be written");
  }
  offsets_[status.frame] = begin + static_cast<long>(sizeof(record));
  status_[status.frame] = status;
}

std::vector<float> FrameJournal::shape(int frame) {
  std::vector<float> shape(floats_per_frame_);
  if (std::fseek(file_, offsets_.at(frame), SEEK_SET) != 0 ||
      std::fread(shape.data(), sizeof(float), shape.size(), file_) != shape.size()) {
    fail("cannot be read back");
  }
  return shape;
}

void FrameJournal::remove() {
  std::fclose(file_);
  file_ = nullptr;
  std::filesystem::remove(path_);
}

}  // namespace bodyopt
