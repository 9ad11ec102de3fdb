// XML read as hostile bytes: bounded in size and depth, every number checked.
#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt::trainer::muscle_models {

struct XmlFile {
  // Throws Error(file) when the file cannot be read, is no XML, or nests too deeply.
  explicit XmlFile(const std::filesystem::path& path);
  std::filesystem::path path;
  pugi::xml_document document;
  int elements = 0;
};

// Throws Error(file): "FILE: <body name="x"> WHAT".
[[noreturn]] void refuse(const std::filesystem::path& path, pugi::xml_node element, const auto&... what) {
  const std::string name = element.attribute("name").value();
  throw Error(ErrorKind::file, path, ": <", element.name(), name.empty() ? "" : " name=\"" + name + "\"", "> ",
              what...);
}

constexpr int kMostElements = 200000;  // of a model, all of its files together

// Refuses trees deeper than what walking them by recursion can bear, or larger than any model. Returns how many
// elements there are.
int require_shallow(const std::filesystem::path& path, pugi::xml_node tree);

// Numbers separated by blanks, `least` to `most` of them, each finite and below 1e6 in size. `what`: for messages.
std::vector<double> parse_numbers(const std::filesystem::path& path, pugi::xml_node element, const std::string& what,
                                  const std::string& text, std::size_t least, std::size_t most);

}  // namespace bodyopt::trainer::muscle_models
