#include "trainer/simulate/partial_shapes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr char kMagic[8] = {'B', 'O', 'D', 'Y', 'P', 'A', 'R', 'T'};
constexpr std::size_t kHeaderSize = 24;
constexpr std::size_t kFixedSize = 48;  // of a record, before its values

template <typename T>
void put(std::vector<char>& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof(value));
}

template <typename T>
T get(const std::vector<char>& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

std::vector<char> header(std::uint64_t inputs, std::size_t values) {
  std::vector<char> bytes(kHeaderSize);
  std::memcpy(bytes.data(), kMagic, sizeof(kMagic));
  put(bytes, 8, inputs);
  put(bytes, 16, static_cast<std::uint64_t>(values));
  return bytes;
}

bool read_at(int file, std::uint64_t offset, std::vector<char>& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = pread(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

bool write_at(int file, std::uint64_t offset, const std::vector<char>& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put_count = pwrite(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (put_count < 0 && errno == EINTR) continue;
    if (put_count <= 0) return false;
    done += static_cast<std::size_t>(put_count);
  }
  return true;
}

bool checksum_holds(const std::vector<char>& record) {
  const std::size_t size = record.size() - sizeof(std::uint64_t);
  return get<std::uint64_t>(record, size) == XXH3_64bits(record.data(), size);
}

FrameStatus status_in(const std::vector<char>& record) {
  FrameStatus status;
  status.residual = get<double>(record, 8);
  status.seconds = get<double>(record, 16);
  status.iterations = get<std::int32_t>(record, 24);
  status.inverted_tets = get<std::int32_t>(record, 28);
  status.contact_depth = get<double>(record, 32);
  status.volume_change = get<double>(record, 40);
  return status;
}

}  // namespace

bool is_final(const FrameStatus& status, int give_up_after) {
  return !std::isinf(status.residual) || status.iterations >= give_up_after;
}

PartialShapes::PartialShapes(std::filesystem::path path, std::uint64_t inputs, std::size_t values_per_frame,
                             int give_up_after, const std::function<void(const std::string&)>& warn)
    : path_(std::move(path)), values_(values_per_frame) {
  open_file();
  if (!resume(inputs, give_up_after)) {
    put_aside(warn);
    const std::vector<char> bytes = header(inputs, values_);
    if (ftruncate(file_, 0) != 0 || !write_at(file_, 0, bytes)) fail("written");
    end_ = kHeaderSize;
  } else if (ftruncate(file_, static_cast<off_t>(end_)) != 0) {
    fail("written");
  }
}

PartialShapes::~PartialShapes() {
  if (file_ >= 0) close(file_);
}

std::size_t PartialShapes::record_size() const { return kFixedSize + values_ * sizeof(float) + sizeof(std::uint64_t); }

void PartialShapes::open_file() {
  file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
  struct stat status {};
  if (file_ < 0 || fstat(file_, &status) != 0) fail("opened");
  if (S_ISREG(status.st_mode)) return;
  throw Error(ErrorKind::file, path_.string() + ": is no file; finished frames are kept there: remove it");
}

// Hours of work may be in it: the last of such files is kept.
void PartialShapes::put_aside(const std::function<void(const std::string&)>& warn) {
  struct stat status {};
  if (fstat(file_, &status) != 0) fail("opened");
  if (status.st_size <= static_cast<off_t>(kHeaderSize)) return;  // holds no frame
  const std::string aside = path_.string() + ".old";
  if (rename(path_.c_str(), aside.c_str()) != 0) fail("put aside");
  warn(path_.string() +
       " holds frames of other inputs (character, muscles, materials, tet size or version); they are put aside as " +
       aside + " and the new ones begin");
  close(file_);
  open_file();
}

// Finds the whole records; false when the file is not of these inputs.
bool PartialShapes::resume(std::uint64_t inputs, int give_up_after) {
  std::vector<char> found(kHeaderSize);
  if (!read_at(file_, 0, found) || found != header(inputs, values_)) return false;
  end_ = kHeaderSize;
  std::vector<char> record(record_size());
  while (read_at(file_, end_, record) && checksum_holds(record)) {
    const FrameStatus status = status_in(record);
    if (is_final(status, give_up_after)) record_begin_[get<std::uint64_t>(record, 0)] = end_;
    end_ += record.size();
  }
  return true;
}

void PartialShapes::append(std::uint64_t key, const FrameStatus& status, std::span<const float> values) {
  std::vector<char> record(record_size());
  put(record, 0, key);
  put(record, 8, status.residual);
  put(record, 16, status.seconds);
  put(record, 24, static_cast<std::int32_t>(status.iterations));
  put(record, 28, static_cast<std::int32_t>(status.inverted_tets));
  put(record, 32, status.contact_depth);
  put(record, 40, status.volume_change);
  std::memcpy(record.data() + kFixedSize, values.data(), values_ * sizeof(float));
  const std::size_t size = record.size() - sizeof(std::uint64_t);
  put(record, size, static_cast<std::uint64_t>(XXH3_64bits(record.data(), size)));
  if (!write_at(file_, end_, record)) fail("written");
  record_begin_[key] = end_;
  end_ += record.size();
}

std::vector<float> PartialShapes::read(std::uint64_t key, FrameStatus& status) const {
  std::vector<char> record(record_size());
  if (!read_at(file_, record_begin_.at(key), record) || !checksum_holds(record)) fail("read back");
  status = status_in(record);
  std::vector<float> values(values_);
  std::memcpy(values.data(), record.data() + kFixedSize, values_ * sizeof(float));
  return values;
}

void PartialShapes::remove() {
  close(file_);
  file_ = -1;
  std::error_code ignored;  // a leftover is harmless: its frames would be found again or belong to other inputs
  std::filesystem::remove(path_, ignored);
}

void PartialShapes::fail(const char* doing) const {
  throw Error(ErrorKind::file, path_.string() + ": the finished frames cannot be " + doing + ": " +
                                   std::strerror(errno) + " (is the folder there, writable, with space left?)");
}

}  // namespace bodyopt::trainer
