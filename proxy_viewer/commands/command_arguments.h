// What commands are given, as text, and what is said of it. All throw Error(usage) that names what was expected.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proxy_viewer/commands/controls.h"

namespace bodyopt {

inline constexpr const char* kBlank = " \t\r";

[[noreturn]] void refuse(const std::string& argument, const std::string& expected);

// Throws Error(usage) for a name that is none of these.
const std::string& known(const std::string& name, const std::vector<std::string>& names, const char* what);

const std::string& selected(const Controls& controls);

double number(const std::string& text);

double number_within(const std::string& text, double low, double high);

int integer(const std::string& text);

// "12", or as the take of a dataset that is open numbers it: "rom 40".
int frame_of_clip(const Controls& controls, const std::string& text);

int integer_within(const std::string& text, int low, int high);

std::vector<std::string> words(const std::string& text);

std::vector<std::string> words(const std::string& text, std::size_t count, const std::string& expected);

// One of the names, in the order of the enumeration.
template <typename Choice, std::size_t N>
void choose(Choice& choice, const std::string& text, const std::array<const char*, N>& names) {
  std::string expected = "one of";
  for (std::size_t k = 0; k < N; ++k) {
    if (text == names[k]) {
      choice = static_cast<Choice>(k);
      return;
    }
    expected += std::string(" ") + names[k];
  }
  refuse(text, expected);
}

template <typename Choice, std::size_t N>
std::string name_of(Choice choice, const std::array<const char*, N>& names) {
  return names[static_cast<std::size_t>(choice)];
}

template <typename Choice, std::size_t N>
void choose_next(Choice& choice, const std::array<const char*, N>&) {
  choice = static_cast<Choice>((static_cast<std::size_t>(choice) + 1) % N);
}

inline constexpr std::array kSwitchNames{"off", "on"};

std::string name_of(bool on);

// Without an argument the other way round.
void toggle(bool& value, const std::string& argument);

void require_keys(const Playback& playback);

// What is before the last blank, and the word after it.
std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected);

// Of the bind pose, joint to world; `joint` is one of joint_names.
const Quat& axes_of(const Controls& controls, const std::string& joint);

// Of one of the cast, which are counted from 1, but the lead.
Standing& standing_of(Controls& controls, const std::string& number);

// Of a vertex of one of the cast.
std::uint32_t vertex_of(const Controls& controls, std::size_t character, const std::string& number);

// "auto", or a whole number within these.
std::optional<int> automatic_or(const std::string& text, int low, int high);

}  // namespace bodyopt
