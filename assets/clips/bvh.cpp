#include "assets/clips/bvh.h"

#include <iconv.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v'; }

// Converts UTF-16, known by its byte order mark or by the zero beside the first letter, to UTF-8. Drops what editors
// and DOS put at either end: a byte order mark, ^Z, zeros.
std::string plain_text(std::string text, const std::filesystem::path& path) {
  const bool is_big = text.starts_with("\xfe\xff") || text.starts_with('\0');
  if (is_big || text.starts_with("\xff\xfe") || (text.size() > 1 && text[1] == '\0')) {
    const iconv_t converter = iconv_open("UTF-8", is_big ? "UTF-16BE" : "UTF-16LE");
    std::string converted(2 * text.size(), '\0');
    char *from = text.data(), *to = converted.data();
    std::size_t left = text.size(), room = converted.size();
    const bool failed = iconv(converter, &from, &left, &to, &room) == static_cast<std::size_t>(-1);
    iconv_close(converter);
    if (failed) throw Error(ErrorKind::file, path, ": expected text, found damaged UTF-16 or no text at all");
    text = converted.substr(0, converted.size() - room);
  }
  text.erase(0, text.size() - without_mark(text).size());
  const std::string_view fill("\0\x1a", 2), blank(" \t\r\n\0\x1a", 6);
  text.resize(std::min(text.find_first_of(fill, text.find_last_not_of(blank) + 1), text.size()));  // npos + 1 is 0
  return text;
}

class Parser {
 public:
  Parser(const std::filesystem::path& path, std::string_view text) : path_(path), rest_(text), text_(text) {}

  Bvh parse() {
    if (lower_case(peek()) != "hierarchy")
      fail("expected 'hierarchy', found '", peek().substr(0, 40), "'", looks_like(path_));
    next();
    while (lower_case(peek()) == "root") {
      next();
      parse_tree();
    }
    if (bvh_.joints.empty()) fail("expected ROOT, found '", peek(), "'");
    if (bvh_.channel_count == 0) fail("no joint has a channel; there is no motion to read");
    parse_motion();
    return std::move(bvh_);
  }

 private:
  [[noreturn]] void fail(const auto&... problem) const {
    const auto read = text_.substr(0, text_.size() - rest_.size());
    const auto line = 1 + std::ranges::count(read, '\n');
    throw Error(ErrorKind::file, path_, ", line ", line, ": ", problem...,
                rest_.empty() ? " (the file ends here; it is cut off)" : "");
  }

  void skip_space() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
  }

  std::string_view peek() {
    skip_space();
    return rest_.substr(0, static_cast<std::size_t>(std::ranges::find_if(rest_, is_space) - rest_.begin()));
  }

  std::string_view next() {
    const std::string_view token = peek();
    if (token.empty()) fail("more was expected");
    rest_.remove_prefix(token.size());
    return token;
  }

  // A colon or a brace needs no space before the next word.
  void expect(const std::string& word) {
    const std::string_view token = peek();
    const bool is_word = std::isalpha(static_cast<unsigned char>(word.back())) != 0;
    if (lower_case(is_word ? token : token.substr(0, word.size())) != word) {
      fail("expected '", word, "', found '", token.substr(0, 40), "'");
    }
    rest_.remove_prefix(word.size());
  }

  double number() {
    std::string_view token = next();
    const std::string shown(token.substr(0, 40));
    if (token.front() == '+') token.remove_prefix(1);
    const std::optional<double> value = number_in<double>(token);
    if (!value || !std::isfinite(*value)) {
      const char* cause = shown.find(',') == std::string::npos ? "" : ": decimals take a point";
      fail("expected a finite number, found '", shown, "'", cause);
    }
    return *value;
  }

  std::size_t count(const std::string& what, std::size_t most) {
    const double value = number();
    if (!(value >= 0) || value != std::floor(value) || value > static_cast<double>(most)) {
      fail(what, " must be a whole number from 0 to ", most);
    }
    return static_cast<std::size_t>(value);
  }

  Vec3 offset() {
    expect("offset");
    const double x = number(), y = number(), z = number();
    return {x, y, z};
  }

  // Names may hold spaces: everything up to the line's end or the brace.
  std::string name() {
    while (!rest_.empty() && (rest_.front() == ' ' || rest_.front() == '\t')) rest_.remove_prefix(1);
    std::size_t length = std::min(rest_.find_first_of("\r\n{"), rest_.size());
    std::string_view text = rest_.substr(0, length);
    rest_.remove_prefix(length);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return std::string(text);
  }

  void open_joint(int parent) {
    BvhJoint joint;
    joint.name = name();
    joint.parent = parent;
    if (joint.name.empty()) fail("a joint has no name");
    expect("{");
    joint.offset = offset();
    expect("channels");
    joint.first_channel = bvh_.channel_count;
    const std::size_t channels = count("the number of channels", 6);
    for (std::size_t c = 0; c < channels; ++c) {
      static const std::string kNames[] = {"xposition", "yposition", "zposition",
                                           "xrotation", "yrotation", "zrotation"};
      const std::string_view token = next();
      const auto found = std::find(std::begin(kNames), std::end(kNames), lower_case(token));
      if (found == std::end(kNames)) fail("unknown channel '", token.substr(0, 40), "'");
      const auto channel = static_cast<BvhChannel>(found - std::begin(kNames));
      if (std::ranges::find(joint.channels, channel) != joint.channels.end()) {
        fail("joint '", joint.name, "' has a channel twice");
      }
      joint.channels.push_back(channel);
    }
    bvh_.channel_count += channels;
    bvh_.joints.push_back(std::move(joint));
  }

  // A root and all below it; not recursive, for files may nest without limit.
  void parse_tree() {
    std::vector<int> open;
    do {
      open_joint(open.empty() ? -1 : open.back());
      open.push_back(static_cast<int>(bvh_.joints.size()) - 1);
      while (!open.empty() && lower_case(peek()) != "joint") close_or_end_site(open);
      if (!open.empty()) next();  // "JOINT"
    } while (!open.empty());
  }

  void close_or_end_site(std::vector<int>& open) {
    const std::string word = lower_case(next());
    if (word == "}") {
      open.pop_back();
    } else if (word == "end") {
      name();
      expect("{");
      offset();
      expect("}");
    } else {
      fail("expected JOINT, End Site or '}', found '", word.substr(0, 40), "'");
    }
  }

  // Writers that are stopped, or write on, declare another number of frames than there are.
  void parse_motion() {
    constexpr std::size_t kMostFrames = 1000000000;
    expect("motion");
    expect("frames:");
    const std::size_t declared = count("the number of frames", kMostFrames);
    expect("frame");
    expect("time:");
    bvh_.frame_time = number();
    if (!(bvh_.frame_time > 0)) fail("the frame time must be above 0");
    while (!peek().empty()) bvh_.values.push_back(number());
    const std::size_t held = bvh_.values.size() / bvh_.channel_count, more = bvh_.values.size() % bvh_.channel_count;
    if (more > 0) {
      throw Error(ErrorKind::file, path_, ": the last of ", held + 1, " frames has ", more,
                  " values, and the joints have ", bvh_.channel_count,
                  " channels: the file is cut off, or its lines are of other joints");
    }
    if (held == 0) fail("there are no frames");
    bvh_.frame_count = declared == 0 ? held : std::min(declared, held);
    bvh_.values.resize(bvh_.frame_count * bvh_.channel_count);
    if (declared == held) return;
    bvh_.notes.push_back("The BVH declares " + std::to_string(declared) + " frames and holds " + std::to_string(held) +
                         "; " + std::to_string(bvh_.frame_count) + " are read.");
  }

  std::filesystem::path path_;
  std::string_view rest_, text_;
  Bvh bvh_;
};

}  // namespace

bool BvhJoint::has_position() const {
  return std::ranges::any_of(channels, [](BvhChannel c) { return c <= BvhChannel::z_position; });
}

JointTransform Bvh::local(std::size_t joint, std::size_t frame) const {
  const BvhJoint& source = joints[joint];
  const double* value = values.data() + frame * channel_count + source.first_channel;
  JointTransform t;
  t.translation = source.offset;
  for (const BvhChannel channel : source.channels) {
    const auto axis = static_cast<std::size_t>(channel) % 3;
    if (channel <= BvhChannel::z_position) {
      t.translation[axis] = *value++;
    } else {
      Vec3 direction{0, 0, 0};
      direction[axis] = 1;
      t.rotation = t.rotation * axis_angle(direction, *value++ * std::numbers::pi / 180);
    }
  }
  t.rotation = normalized(t.rotation);
  return t;
}

JointTransform Bvh::local_at(std::size_t joint, double seconds) const {
  const double position = std::clamp(seconds / frame_time, 0.0, static_cast<double>(frame_count - 1));
  const auto frame = static_cast<std::size_t>(position);
  const double t = position - static_cast<double>(frame);
  JointTransform a = local(joint, frame);
  if (t == 0 || frame + 1 >= frame_count) return a;
  const JointTransform b = local(joint, frame + 1);
  a.translation = (1 - t) * a.translation + t * b.translation;
  a.rotation = slerp(a.rotation, b.rotation, t);
  return a;
}

Bvh read_bvh(const std::filesystem::path& path) {
  constexpr std::uint64_t kLargestFile = std::uint64_t{4} << 30;  // bytes
  return parse_bvh(read_file(path, kLargestFile, "a BVH file"), path);
}

Bvh parse_bvh(std::string text, const std::filesystem::path& path) {
  text = plain_text(std::move(text), path);
  return Parser(path, text).parse();
}

}  // namespace bodyopt
