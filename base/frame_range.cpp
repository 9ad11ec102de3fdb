#include "base/frame_range.h"

#include <charconv>
#include <set>
#include <string_view>
#include <unordered_set>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr std::int64_t kMaxFrames = 10'000'000;

[[noreturn]] void fail(const std::string& text, const auto&... problem) {
  throw Error(ErrorKind::usage, "frame range '", text, "': ", problem...,
              "; expected for instance 1001-1100, 1001-1100x2 or 1,5,10-20");
}

// Takes an integer off the front of `rest`.
int take_integer(std::string_view& rest, const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc()) fail(text, "expected a whole number at '", rest, "'");
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return value;
}

bool take(std::string_view& rest, char wanted) {
  if (rest.empty() || rest.front() != wanted) return false;
  rest.remove_prefix(1);
  return true;
}

struct Span {
  int first, last, step;
};

Span parse_span(std::string_view item, const std::string& text) {
  Span span{take_integer(item, text), 0, 1};
  span.last = span.first;
  if (take(item, '-')) {
    span.last = take_integer(item, text);
    if (take(item, 'x')) span.step = take_integer(item, text);
  }
  if (!item.empty()) fail(text, "cannot read '", item, "'");
  if (span.last < span.first) fail(text, "a range ends before it starts");
  if (span.step < 1) fail(text, "the step after 'x' must be 1 or more");
  return span;
}

std::string format_span(int first, int last, int step) {
  std::string text = std::to_string(first);
  if (last == first) return text;
  text += '-' + std::to_string(last);
  return step == 1 ? text : text + 'x' + std::to_string(step);
}

}  // namespace

std::vector<int> parse_frame_range(const std::string& text) {
  if (text.find(':') != std::string::npos) {
    fail(text, "':' is refused, because farm systems disagree on what it means (write a step as 1001-1100x2)");
  }
  std::vector<int> frames;
  std::unordered_set<int> seen;
  std::int64_t named = 0;  // duplicates count too: they take time
  std::string_view rest = text;
  for (;;) {
    const std::size_t comma = rest.find(',');
    const Span span = parse_span(rest.substr(0, comma), text);
    named += (std::int64_t{span.last} - span.first) / span.step + 1;
    if (named > kMaxFrames) fail(text, "more than 10,000,000 frames");
    for (std::int64_t frame = span.first; frame <= span.last; frame += span.step) {
      if (seen.insert(static_cast<int>(frame)).second) frames.push_back(static_cast<int>(frame));
    }
    if (comma == std::string_view::npos) return frames;
    rest.remove_prefix(comma + 1);
  }
}

std::string format_frame_range(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t end = i + 1;  // one past the run of equal steps that starts at i
    const std::int64_t step = end < frames.size() ? std::int64_t{frames[end]} - frames[i] : 1;
    while (end < frames.size() && std::int64_t{frames[end]} - frames[end - 1] == step) ++end;
    if (end - i < 3) end = i + 1;
    if (!text.empty()) text += ',';
    text += format_span(frames[i], frames[end - 1], static_cast<int>(step));
    i = end;
  }
  return text;
}

std::vector<int> unite_frames(const std::vector<int>& a, const std::vector<int>& b) {
  std::set<int> frames(a.begin(), a.end());
  frames.insert(b.begin(), b.end());
  return {frames.begin(), frames.end()};
}

}  // namespace bodyopt
