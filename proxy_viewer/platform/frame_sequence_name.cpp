#include "proxy_viewer/platform/frame_sequence_name.h"

#include <algorithm>
#include <iomanip>
#include <optional>
#include <sstream>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

struct Place {
  std::size_t begin, end;  // in the name
  std::size_t digits;
};

// %d, or %04d and the like with one or two digits of width.
std::optional<Place> percent_place(const std::string& name, std::size_t begin) {
  const std::size_t letter = std::min(name.find_first_not_of("0123456789", begin + 1), name.size());
  if (name[letter] != 'd') return {};
  const std::string width = name.substr(begin + 1, letter - begin - 1);
  if (width.empty()) return Place{begin, letter + 1, 1};
  if (width.front() != '0' || width.size() < 2 || width.size() > 3) return {};
  return Place{begin, letter + 1, std::stoul(width)};
}

// The first place for the frame.
std::optional<Place> find_place(const std::string& name) {
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    if (name[begin] == '#') {
      const std::size_t end = std::min(name.find_first_not_of('#', begin), name.size());
      return Place{begin, end, end - begin};
    }
    if (name[begin] != '%') continue;
    if (const auto place = percent_place(name, begin)) return place;
  }
  return {};
}

}  // namespace

FrameSequenceName::FrameSequenceName(const std::filesystem::path& pattern, std::size_t frame_count)
    : folder_(pattern.parent_path()), after_(pattern.filename().string()) {
  const auto refuse = [&](const std::string& problem) {
    throw Error(ErrorKind::usage, pattern.string() + ": " + problem +
                                      "; expected one place for the frame, for instance img.####.png or img.%04d.png");
  };
  const auto place = find_place(after_);
  if (!place && frame_count > 1) {
    refuse("is the name of one picture, and there are " + std::to_string(frame_count) + " frames");
  }
  if (!place) return;
  digits_ = std::max<std::size_t>(place->digits, 1);
  before_ = after_.substr(0, place->begin);
  after_.erase(0, place->end);
  if (find_place(after_)) refuse("has more than one place for the frame");
}

std::filesystem::path FrameSequenceName::operator()(int frame) const {
  if (digits_ == 0) return folder_ / after_;
  std::ostringstream name;
  name << before_ << std::setw(static_cast<int>(digits_)) << std::setfill('0') << std::internal << frame << after_;
  return folder_ / name.str();
}

}  // namespace bodyopt
