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

std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected) {
  const std::size_t blank = text.find_last_of(kBlank);
  const std::size_t end = blank == std::string::npos ? blank : text.find_last_not_of(kBlank, blank);
  if (end == std::string::npos) refuse(text, expected);
  return {text.substr(0, end + 1), text.substr(blank + 1)};
}

}  // namespace bodyopt
