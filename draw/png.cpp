#include "draw/png.h"

#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <new>
#include <span>
#include <string_view>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/threads/tbb_executor.h"

namespace bodyopt {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;  // a band's size fits in an uInt of zlib
constexpr std::uint32_t kBandRows = 64;
constexpr std::uint8_t kSub = 1;  // PNG's filter type: each pixel less the one to its left
// Of the levels and filters, the fastest whose files are no larger than stb's were.
constexpr int kLevel = 1;

// Rows that are compressed on their own; their streams follow each other as one.
struct Band {
  Bytes deflated;
  uLong checksum = 0;     // Adler-32 of its filtered rows
  std::size_t bytes = 0;  // of them
};

Bytes filtered(const Image& image, std::uint32_t first, std::uint32_t last) {
  const std::size_t row = std::size_t{image.width} * 4;
  Bytes bytes;
  bytes.reserve((last - first) * (row + 1));
  for (std::uint32_t y = first; y < last; ++y) {
    const std::uint8_t* const pixels = image.rgba.data() + y * row;
    bytes.push_back(kSub);
    bytes.insert(bytes.end(), pixels, pixels + row);
    std::uint8_t* const to = bytes.data() + bytes.size() - row;
    for (std::size_t k = 4; k < row; ++k) to[k] = static_cast<std::uint8_t>(pixels[k] - pixels[k - 4]);
  }
  return bytes;
}

Band compress(const Image& image, std::uint32_t first) {
  const std::uint32_t last = std::min(first + kBandRows, image.height);
  Bytes rows = filtered(image, first, last);
  Band band{{}, adler32(adler32(0, nullptr, 0), rows.data(), static_cast<uInt>(rows.size())), rows.size()};
  z_stream stream{};
  constexpr int kRaw = -15, kMemory = 8;  // no header; as by default
  bool is_done = deflateInit2(&stream, kLevel, Z_DEFLATED, kRaw, kMemory, Z_DEFAULT_STRATEGY) == Z_OK;
  if (is_done) {
    constexpr uLong kFlushed = 16;  // an empty block that ends on a byte
    band.deflated.resize(deflateBound(&stream, static_cast<uLong>(rows.size())) + kFlushed);
    stream.next_in = rows.data();
    stream.avail_in = static_cast<uInt>(rows.size());
    stream.next_out = band.deflated.data();
    stream.avail_out = static_cast<uInt>(band.deflated.size());
    const bool ends = last == image.height;
    is_done = deflate(&stream, ends ? Z_FINISH : Z_SYNC_FLUSH) == (ends ? Z_STREAM_END : Z_OK) && stream.avail_out > 0;
    band.deflated.resize(stream.total_out);
    deflateEnd(&stream);
  }
  if (!is_done) throw std::bad_alloc();
  return band;
}

void append_number(std::uint32_t number, Bytes& png) {
  for (int shift = 24; shift >= 0; shift -= 8) png.push_back(static_cast<std::uint8_t>(number >> shift));
}

void append_chunk(std::string_view type, const Bytes& content, Bytes& png) {
  append_number(static_cast<std::uint32_t>(content.size()), png);
  const std::size_t begin = png.size();
  png.insert(png.end(), type.begin(), type.end());
  png.insert(png.end(), content.begin(), content.end());
  append_number(static_cast<std::uint32_t>(crc32(0, png.data() + begin, static_cast<uInt>(png.size() - begin))), png);
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image) {
  const std::uint64_t bytes = std::uint64_t{image.width} * image.height * 4;
  if (bytes == 0 || bytes > kMaxBytes || image.rgba.size() != bytes) {
    throw Error(ErrorKind::usage, "an image of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                                      " pixels with " + std::to_string(image.rgba.size()) + " bytes is no PNG");
  }
  std::vector<Band> bands((image.height + kBandRows - 1) / kBandRows);
  static const std::unique_ptr<Executor> executor = make_tbb_executor();
  std::atomic<bool> out_of_memory{false};
  parallel_each(*executor, bands.size(), 1, [&](std::size_t k) {
    try {
      bands[k] = compress(image, static_cast<std::uint32_t>(k) * kBandRows);
    } catch (const std::bad_alloc&) {
      out_of_memory = true;
    }
  });
  if (out_of_memory) throw Error(ErrorKind::file, "an image could not be encoded as PNG: out of memory");

  Bytes header, pixels = {0x78, 0x01};  // of zlib: deflate, fastest
  append_number(image.width, header);
  append_number(image.height, header);
  header.insert(header.end(), {8, 6, 0, 0, 0});  // eight bits, RGBA, no choice, no interlacing
  uLong checksum = adler32(0, nullptr, 0);
  for (const Band& band : bands) {
    pixels.insert(pixels.end(), band.deflated.begin(), band.deflated.end());
    checksum = adler32_combine(checksum, band.checksum, static_cast<z_off_t>(band.bytes));
  }
  append_number(static_cast<std::uint32_t>(checksum), pixels);

  Bytes png = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  append_chunk("IHDR", header, png);
  append_chunk("IDAT", pixels, png);
  append_chunk("IEND", {}, png);
  return png;
}

void write_png(const Image& image, const std::filesystem::path& path) {
  const std::vector<std::uint8_t> png = encode_png(image);
  write_file_atomically(path, std::as_bytes(std::span(png)));
}

}  // namespace bodyopt
