#include "assets/fbx/fbx_parse.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "runtime/core/text.h"

namespace bodyopt {
namespace {

constexpr std::string_view kFbxMagic("Kaydara FBX Binary  \0\x1a", 22);
constexpr std::size_t kFbxNesting = 64;
constexpr std::int64_t kOldestFbx = 7000;

// Reads from the front of the bytes that are left of a file.
class FbxBytes {
 public:
  FbxBytes(const std::filesystem::path& path, std::string_view bytes, std::size_t at)
      : path_(path), bytes_(bytes), at_(at), array_bytes_left_((std::size_t{256} << 20) + 64 * bytes.size()) {}

  std::size_t at() const { return at_; }
  bool is_at_end() const { return at_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - at_; }

  std::string_view take(std::size_t count) {
    if (count > left()) fail("it ends in the middle of a node");
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  template <class T>
  T take() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  // Limits arrays, against small files that ask for vast memory.
  void allow(std::size_t bytes) {
    if (bytes > array_bytes_left_) fail("its arrays hold far more than the file");
    array_bytes_left_ -= bytes;
  }
  [[noreturn]] void fail(const char* problem) const {
    throw Error(ErrorKind::file, path_, ": ", problem, " (byte ", at_, "); the FBX file is cut off or damaged");
  }

 private:
  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::size_t at_, array_bytes_left_;
};

template <class T>
FbxValue array_value(FbxBytes& bytes) {
  const std::size_t count = bytes.take<std::uint32_t>(), size = count * sizeof(T);
  const auto encoding = bytes.take<std::uint32_t>();
  const std::string_view packed = bytes.take(bytes.take<std::uint32_t>());
  std::vector<T> values;
  if (encoding > 1 || (encoding == 0 && packed.size() != size)) bytes.fail("an array has another length than it says");
  bytes.allow(count * sizeof(double));
  values.resize(count);
  uLongf unpacked = size;
  if (encoding == 0) {
    std::memcpy(values.data(), packed.data(), size);
  } else if (uncompress(reinterpret_cast<Bytef*>(values.data()), &unpacked,
                        reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
             unpacked != size) {
    bytes.fail("an array cannot be unpacked");
  }
  using Wide = std::conditional_t<std::is_floating_point_v<T>, double, std::int64_t>;
  return std::vector<Wide>(values.begin(), values.end());
}

FbxValue binary_value(FbxBytes& bytes) {
  switch (bytes.take<char>()) {
    case 'C':
    case 'B':
    case 'Z':
      return std::int64_t{bytes.take<std::int8_t>()};
    case 'Y':
      return std::int64_t{bytes.take<std::int16_t>()};
    case 'I':
      return std::int64_t{bytes.take<std::int32_t>()};
    case 'L':
      return bytes.take<std::int64_t>();
    case 'F':
      return double{bytes.take<float>()};
    case 'D':
      return bytes.take<double>();
    case 'S':
    case 'R':
      return std::string(bytes.take(bytes.take<std::uint32_t>()));
    case 'b':
    case 'c':
      return array_value<std::int8_t>(bytes);
    case 'i':
      return array_value<std::int32_t>(bytes);
    case 'l':
      return array_value<std::int64_t>(bytes);
    case 'f':
      return array_value<float>(bytes);
    case 'd':
      return array_value<double>(bytes);
    default:
      bytes.fail("a value is of an unknown type");
  }
}

// Appends nodes until one without an end, which closes a list. `wide`: offsets have 64 bits.
void append_binary_nodes(FbxBytes& bytes, bool wide, std::size_t depth, std::vector<FbxNode>& nodes) {
  if (depth > kFbxNesting) bytes.fail("its nodes are nested deeper than 64 levels");
  const auto offset = [&] { return wide ? bytes.take<std::uint64_t>() : bytes.take<std::uint32_t>(); };
  while (!bytes.is_at_end()) {
    const std::uint64_t end = offset(), count = offset();
    offset();  // bytes of the values, which tell their own lengths
    const std::string_view name = bytes.take(bytes.take<std::uint8_t>());
    if (end == 0 && name.empty()) return;
    FbxNode& node = nodes.emplace_back();
    node.name = name;
    for (std::uint64_t k = 0; k < count; ++k) node.values.push_back(binary_value(bytes));
    if (bytes.at() < end) append_binary_nodes(bytes, wide, depth + 1, node.children);
    if (bytes.at() != end && end != 0) bytes.fail("a node ends elsewhere than it says");
  }
  bytes.fail("a list of nodes has no end");
}

class FbxText {
 public:
  explicit FbxText(FbxBytes bytes, std::string_view text) : bytes_(bytes), text_(text) {}

  void append_nodes(std::size_t depth, std::vector<FbxNode>& nodes) {
    if (depth > kFbxNesting) bytes_.fail("its nodes are nested deeper than 64 levels");
    while (skip_space() && peek() != '}') {
      FbxNode& node = nodes.emplace_back();
      node.name = word();
      if (node.name.empty() || !take_if(':')) bytes_.fail("expected the name of a node and a colon");
      append_values(node);
      if (!take_if('{')) continue;
      append_nodes(depth + 1, node.children);
      if (!take_if('}')) bytes_.fail("a closing brace is missing");
      if (const FbxNode* array = node.find("a"); array != nullptr && node.values.empty()) take_array(node, *array);
    }
    if (depth == 0 && !bytes_.is_at_end()) bytes_.fail("a brace closes nothing");
  }

 private:
  char peek() const { return bytes_.is_at_end() ? '\0' : text_[bytes_.at()]; }

  // Comments, too. False at the end.
  bool skip_space() {
    while (!bytes_.is_at_end()) {
      if (peek() == ';') {
        while (!bytes_.is_at_end() && peek() != '\n') bytes_.take(1);
      } else if (std::string_view(" \t\r\n").find(peek()) != std::string_view::npos) {
        bytes_.take(1);
      } else {
        return true;
      }
    }
    return false;
  }

  bool take_if(char mark) {
    if (!skip_space() || peek() != mark) return false;
    bytes_.take(1);
    return true;
  }

  std::string_view word() {
    std::size_t end = bytes_.at();
    while (end < text_.size() && std::string_view(" \t\r\n,:;{}\"").find(text_[end]) == std::string_view::npos) ++end;
    return bytes_.take(end - bytes_.at());
  }

  // Is what comes next the name of the next node rather than a value?
  bool is_at_name() const {
    FbxText ahead = *this;
    return !ahead.word().empty() && ahead.take_if(':');
  }

  void append_values(FbxNode& node) {
    while (skip_space()) {
      if (take_if(',')) continue;
      if (peek() == '{' || peek() == '}') return;
      if (peek() == '"') {
        bytes_.take(1);
        const std::size_t end = text_.find('"', bytes_.at());
        if (end == std::string_view::npos) bytes_.fail("a closing quote is missing");
        node.values.emplace_back(std::string(bytes_.take(end - bytes_.at())));
        bytes_.take(1);
      } else if (peek() == '*') {  // the length of an array, which tells it itself
        word();
        return;
      } else if (is_at_name()) {
        return;
      } else {
        append_word(node);
      }
      if (!skip_space() || peek() != ',') return;
    }
  }

  void append_word(FbxNode& node) {
    const std::string_view text = word();
    if (text.empty()) bytes_.fail("a value is missing");
    if (const auto integer = number_in<std::int64_t>(text)) {
      node.values.emplace_back(*integer);
    } else if (const auto number = number_in<double>(text)) {
      node.values.emplace_back(*number);
    } else {
      node.values.emplace_back(std::string(text));
    }
  }

  static void take_array(FbxNode& node, const FbxNode& array) {
    bool whole = true;
    for (const FbxValue& value : array.values) whole = whole && std::holds_alternative<std::int64_t>(value);
    if (whole) {
      node.values.emplace_back(array.integers());
    } else {
      node.values.emplace_back(array.numbers());
    }
    node.children.clear();
  }

  FbxBytes bytes_;
  std::string_view text_;
};

template <class T>
std::vector<T> all_numbers(const std::vector<FbxValue>& values) {
  std::vector<T> numbers;
  const auto append = [&]<class Value>(const Value& value) {
    if constexpr (std::is_convertible_v<Value, T>) {
      if constexpr (std::is_integral_v<Value> || std::is_floating_point_v<T>) numbers.push_back(static_cast<T>(value));
    } else if constexpr (!std::is_same_v<Value, std::string>) {
      if constexpr (std::is_same_v<typename Value::value_type, std::int64_t> || std::is_floating_point_v<T>) {
        numbers.insert(numbers.end(), value.begin(), value.end());
      }
    }
  };
  for (const FbxValue& value : values) std::visit(append, value);
  return numbers;
}

}  // namespace

const FbxNode* FbxNode::find(std::string_view child) const {
  const auto found = std::ranges::find(children, child, &FbxNode::name);
  return found == children.end() ? nullptr : &*found;
}

const FbxNode& FbxNode::child(std::string_view wanted) const {
  static const FbxNode nothing{};
  const FbxNode* found = find(wanted);
  return found == nullptr ? nothing : *found;
}

std::vector<double> FbxNode::numbers() const { return all_numbers<double>(values); }

std::vector<std::int64_t> FbxNode::integers() const { return all_numbers<std::int64_t>(values); }

double FbxNode::number(std::size_t place, double otherwise) const {
  if (place >= values.size()) return otherwise;
  if (const auto* value = std::get_if<double>(&values[place])) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&values[place])) return static_cast<double>(*value);
  return otherwise;
}

std::int64_t FbxNode::integer(std::size_t place, std::int64_t otherwise) const {
  const auto* value = place < values.size() ? std::get_if<std::int64_t>(&values[place]) : nullptr;
  return value == nullptr ? otherwise : *value;
}

std::string FbxNode::text(std::size_t place) const {
  const auto* value = place < values.size() ? std::get_if<std::string>(&values[place]) : nullptr;
  return value == nullptr ? "" : *value;
}

bool is_fbx(std::string_view bytes) { return bytes.starts_with("Kaydara FBX") || bytes.starts_with("; FBX"); }

FbxNode parse_fbx(const std::filesystem::path& path, std::string_view bytes) {
  const bool is_text = !bytes.starts_with("Kaydara");
  FbxNode root;
  std::int64_t version = 0;
  if (is_text) {
    FbxText({path, bytes, 0}, bytes).append_nodes(0, root.children);
    version = root.child("FBXHeaderExtension").child("FBXVersion").integer(0, 0);
  } else {
    FbxBytes binary(path, bytes, 0);
    if (binary.take(kFbxMagic.size()) != kFbxMagic) binary.fail("its header is not that of an FBX file");
    if (binary.take<char>() != 0) throw Error(ErrorKind::file, path, ": is big-endian FBX, expected little-endian");
    version = binary.take<std::uint32_t>();
    if (version >= kOldestFbx) append_binary_nodes(binary, version >= 7500, 0, root.children);
  }
  if (version < kOldestFbx) {
    throw Error(ErrorKind::file, path, ": FBX version ", version, ", expected ", kOldestFbx,
                " or later; export it as FBX 2011 or later");
  }
  root.values = {version, std::int64_t{is_text}};
  return root;
}

}  // namespace bodyopt
