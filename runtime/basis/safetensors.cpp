#include "runtime/basis/safetensors.h"

#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "runtime/basis/file_schema.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/file_problem.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

constexpr std::uint64_t kLargestHeader = 16 << 20;  // bytes; parsed JSON takes many times its text in memory
constexpr const char* kChecksum = "checksum";

[[noreturn]] void refuse(const std::filesystem::path& path, const auto&... what) {
  throw Error(ErrorKind::file, path, ": ", what..., " (not a safetensors file, or a damaged or cut-off one)");
}

// Elements x size, or refusal when the product does not fit what is there.
std::uint64_t checked_bytes(const std::filesystem::path& path, const std::string& name, const Tensor& tensor,
                            std::uint64_t available) {
  std::uint64_t bytes = dtype_size(tensor.dtype);
  if (std::ranges::find(tensor.shape, 0u) != tensor.shape.end()) return 0;
  for (const std::uint64_t n : tensor.shape) {
    if (n > available / bytes) refuse(path, "tensor '", name, "' is larger than the file");
    bytes *= n;
  }
  return bytes;
}

// The bytes of a tensor, counted from the end of the header.
struct Range {
  std::uint64_t begin, end;
  std::string name;
  auto operator<=>(const Range&) const = default;
};

Range parse_tensor(const std::filesystem::path& path, const std::string& name, const Json& entry, std::uint64_t size,
                   Tensor& tensor) {
  const auto dtype = entry.find("dtype"), shape = entry.find("shape"), offsets = entry.find("data_offsets");
  if (dtype == entry.end() || !dtype->is_string() || shape == entry.end() || !shape->is_array() ||
      offsets == entry.end() || !offsets->is_array() || offsets->size() != 2 || !(*offsets)[0].is_number_unsigned() ||
      !(*offsets)[1].is_number_unsigned() || entry.size() != 3) {
    refuse(path, "tensor '", name, "' is not described by a dtype, a shape and two data_offsets");
  }
  tensor.dtype = dtype->get<std::string>();
  if (dtype_size(tensor.dtype) == 0) {
    refuse(path, "tensor '", name, "' has type ", tensor.dtype, ", expected F32, F64, U16 or U32");
  }
  for (const Json& n : *shape) {
    if (!n.is_number_unsigned()) refuse(path, "tensor '", name, "' has a shape that is not of counts");
    tensor.shape.push_back(n.get<std::uint64_t>());
  }
  Range range{(*offsets)[0].get<std::uint64_t>(), (*offsets)[1].get<std::uint64_t>(), name};
  if (range.begin > range.end || range.end > size) {
    refuse(path, "tensor '", name, "' lies at bytes ", range.begin, " to ", range.end, " of ", size);
  }
  const std::uint64_t expected = checked_bytes(path, name, tensor, size), found = range.end - range.begin;
  if (found != expected) {
    refuse(path, "tensor '", name, "' has ", found, " bytes, expected ", expected, " by its shape");
  }
  return range;
}

std::map<std::string, std::string> parse_metadata(const std::filesystem::path& path, const Json& entries) {
  std::map<std::string, std::string> metadata;
  for (const auto& [key, value] : entries.items()) {
    if (!value.is_string()) refuse(path, "metadata '", key, "' is not a string");
    metadata[key] = value.get<std::string>();
  }
  return metadata;
}

// Tensors lie one after the other, without a gap, to the end of the file.
void check_order(const std::filesystem::path& path, std::vector<Range> ranges, std::uint64_t size) {
  std::ranges::sort(ranges);
  std::uint64_t expected = 0;
  for (const Range& range : ranges) {
    if (range.begin != expected) {
      refuse(path, "tensor '", range.name, "' starts at byte ", range.begin, ", expected ", expected,
             ": it leaves a gap or overlaps another");
    }
    expected = range.end;
  }
  if (expected != size) refuse(path, size - expected, " bytes follow the last tensor");
}

std::string header_text(const Safetensors& file, const std::vector<std::string>& order,
                        const std::filesystem::path& path) {
  Json header;
  header["__metadata__"] = file.metadata;
  std::uint64_t offset = 0;
  for (const std::string& name : order) {
    const Tensor& tensor = file.tensors.at(name);
    header[name] = {
        {"dtype", tensor.dtype}, {"shape", tensor.shape}, {"data_offsets", {offset, offset + tensor.bytes.size()}}};
    offset += tensor.bytes.size();
  }
  std::string text = strict_json_text(header, path.string());
  text.resize((text.size() + 7) / 8 * 8, ' ');  // tensors start at a multiple of 8
  return text;
}

// `read`(begin, bytes): fills them from byte `begin` on; false where that cannot be done. `size`: bytes that there are.
Safetensors parse(const std::filesystem::path& path, std::uint64_t size, const auto& read) {
  std::uint64_t length = 0;
  if (size < 8 || !read(0, std::as_writable_bytes(std::span(&length, 1)))) {
    refuse(path, "shorter than a header", looks_like(path));
  }
  if (length > std::min(kLargestHeader, size - 8)) {
    refuse(path, "its header claims ", length, " of ", size, " bytes", looks_like(path));
  }
  std::string text(length, '\0');
  if (!read(8, std::as_writable_bytes(std::span(text)))) refuse(path, "the header cannot be read");
  const Json header = parse_strict_json(text, path.string());
  if (!header.is_object()) refuse(path, "the header is not a JSON object");

  Safetensors file;
  const std::uint64_t data_begin = 8 + length, data_size = size - data_begin;
  std::vector<Range> ranges;
  for (const auto& [name, entry] : header.items()) {
    if (!entry.is_object()) refuse(path, "entry '", name, "' is not an object");
    if (name == "__metadata__") {
      file.metadata = parse_metadata(path, entry);
    } else {
      ranges.push_back(parse_tensor(path, name, entry, data_size, file.tensors[name]));
    }
  }
  check_order(path, ranges, data_size);
  for (const Range& range : ranges) {
    Tensor& tensor = file.tensors[range.name];
    tensor.bytes.resize(range.end - range.begin);
    if (!read(data_begin + range.begin, tensor.bytes)) refuse(path, "tensor '", range.name, "' cannot be read");
  }
  const auto checksum = file.metadata.find(kChecksum);
  if (checksum != file.metadata.end() && checksum->second != content_checksum(file)) {
    refuse(path, "its checksum is ", content_checksum(file), ", expected ", checksum->second);
  }
  return file;
}

}  // namespace

std::size_t dtype_size(const std::string& dtype) {
  if (dtype == "U16") return 2;
  if (dtype == "F32" || dtype == "U32") return 4;
  return dtype == "F64" ? 8 : 0;
}

std::string content_checksum(const Safetensors& file) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  const auto update = [&](const std::string& text) { XXH3_64bits_update(state, text.c_str(), text.size() + 1); };
  for (const auto& [key, value] : file.metadata) {
    if (key == kChecksum) continue;
    update(key);
    update(value);
  }
  for (const auto& [name, tensor] : file.tensors) {
    std::string label = name + ' ' + tensor.dtype;
    for (const std::uint64_t n : tensor.shape) label += ' ' + std::to_string(n);
    update(label);
    XXH3_64bits_update(state, tensor.bytes.data(), tensor.bytes.size());
  }
  const std::uint64_t digest = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return hexadecimal(digest);
}

void write_safetensors(const Safetensors& file, const std::filesystem::path& path) {
  std::vector<std::string> order;
  for (const auto& [name, tensor] : file.tensors) order.push_back(name);
  // The widest types first, so that every tensor stands at a multiple of its type's size.
  std::ranges::stable_sort(order, [&](const std::string& a, const std::string& b) {
    return dtype_size(file.tensors.at(a).dtype) > dtype_size(file.tensors.at(b).dtype);
  });
  const std::string text = header_text(file, order, path);
  if (text.size() > kLargestHeader) {
    throw Error(ErrorKind::file, path, ": cannot be written: its names and other strings take ", text.size(),
                " bytes, expected ", kLargestHeader, " at most");
  }
  const auto schema = file.metadata.find("schema");
  refuse_other_kind(path, schema == file.metadata.end() ? "" : schema->second);
  const std::uint64_t length = text.size();
  AtomicFile out(path);
  out.write(std::as_bytes(std::span(&length, 1)));
  out.write(text);
  for (const std::string& name : order) out.write(file.tensors.at(name).bytes);
  out.commit();
}

Safetensors read_safetensors(const std::filesystem::path& path) {
  std::error_code ignored;
  std::ifstream stream;
  if (std::filesystem::is_regular_file(path, ignored)) stream.open(path, std::ios::binary | std::ios::ate);
  if (!stream.is_open()) throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
  // The size is that of the open file: by the path another may have taken its place.
  const auto size = static_cast<std::uint64_t>(stream.tellg());
  return parse(path, size, [&](std::uint64_t begin, std::span<std::byte> to) {
    stream.seekg(static_cast<std::streamoff>(begin));
    stream.read(reinterpret_cast<char*>(to.data()), static_cast<std::streamsize>(to.size()));
    return stream.good();
  });
}

Safetensors read_safetensors(std::span<const std::byte> bytes, const std::string& origin) {
  return parse(origin, bytes.size(), [&](std::uint64_t begin, std::span<std::byte> to) {
    std::ranges::copy(bytes.subspan(begin, to.size()), to.begin());
    return true;
  });
}

}  // namespace bodyopt
