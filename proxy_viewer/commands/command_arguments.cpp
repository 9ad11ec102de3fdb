#include "proxy_viewer/commands/command_arguments.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "assets/wording.h"
#include "runtime/core/error.h"

namespace bodyopt {

[[noreturn]] void refuse(const std::string& argument, const std::string& expected) {
  throw Error(ErrorKind::usage, "'" + argument + "' is not " + expected);
}

const std::string& known(const std::string& name, const std::vector<std::string>& names, const char* what) {
  if (names.empty()) refuse(name, std::string("a ") + what + ": there is none");
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  refuse(name, std::string("a ") + what + "; the nearest is '" + nearest_names(names, name).front() + "'");
}

const std::string& selected(const Controls& controls) {
  if (controls.joint.empty()) throw Error(ErrorKind::usage, "no joint is selected, nor was one named");
  return controls.joint;
}

double number(const std::string& text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) refuse(text, "a number");
  return value;
}

double number_within(const std::string& text, double low, double high) {
  const double value = number(text);
  if (value < low || value > high) {
    std::ostringstream expected;
    expected << "a number from " << low << " to " << high;
    refuse(text, expected.str());
  }
  return value;
}

int integer(const std::string& text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size()) refuse(text, "a whole number");
  return value;
}

int frame_of_clip(const Controls& controls, const std::string& text) {
  if (text.find(' ') != std::string::npos) {
    const std::vector<std::string>& frames = controls.curating.frames;
    const auto place = std::ranges::find(frames, known(text, frames, "frame of a dataset's take")) - frames.begin();
    return controls.playback.first() + static_cast<int>(place);
  }
  const int frame = integer(text);
  controls.playback.require_frame(frame);
  return frame;
}

int integer_within(const std::string& text, int low, int high) {
  const int value = integer(text);
  if (value < low || value > high) {
    refuse(text, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return value;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

std::vector<std::string> words(const std::string& text, std::size_t count, const std::string& expected) {
  const std::vector<std::string> all = words(text);
  if (all.size() != count) refuse(text, expected);
  return all;
}

std::string name_of(bool on) { return name_of(on, kSwitchNames); }

void toggle(bool& value, const std::string& argument) {
  if (argument.empty()) {
    value = !value;
  } else {
    choose(value, argument, kSwitchNames);
  }
}

void require_keys(const Playback& playback) {
  if (!playback.keys().empty()) return;
  throw Error(ErrorKind::usage,
              "the clip has no keys to go to: a BVH samples its motion, and so does a clip with a key at most frames");
}

std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected) {
  const std::size_t blank = text.find_last_of(kBlank);
  const std::size_t end = blank == std::string::npos ? blank : text.find_last_not_of(kBlank, blank);
  if (end == std::string::npos) refuse(text, expected);
  return {text.substr(0, end + 1), text.substr(blank + 1)};
}

const Quat& axes_of(const Controls& controls, const std::string& joint) {
  const auto at = std::find(controls.joint_names.begin(), controls.joint_names.end(), joint);
  return controls.joint_axes.at(static_cast<std::size_t>(at - controls.joint_names.begin()));
}

Standing& standing_of(Controls& controls, const std::string& number) {
  const int index = integer(number);
  if (index >= 2 && static_cast<std::size_t>(index) <= controls.standings.size()) {
    return controls.standings[static_cast<std::size_t>(index) - 1];
  }
  refuse(number, "one of the cast but the lead, expected a number from 2 to " +
                     std::to_string(controls.standings.size()) + ", as the cast panel counts them");
}

std::uint32_t vertex_of(const Controls& controls, std::size_t character, const std::string& number) {
  if (character >= controls.output_counts.size()) {
    throw Error(ErrorKind::usage, "markers are of two bodies: open the one that is transferred to after the lead");
  }
  const int last = static_cast<int>(controls.output_counts[character]) - 1;
  return static_cast<std::uint32_t>(integer_within(number, 0, last));
}

std::optional<int> automatic_or(const std::string& text, int low, int high) {
  return text == "auto" ? std::nullopt : std::optional(integer_within(text, low, high));
}

}  // namespace bodyopt
