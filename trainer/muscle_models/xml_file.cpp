#include "trainer/muscle_models/xml_file.h"

#include <charconv>
#include <cmath>

#include "runtime/basis/read_file.h"

namespace bodyopt::trainer::muscle_models {
namespace {

constexpr std::uint64_t kLargestFile = 64 << 20;  // bytes
constexpr int kDeepest = 256;                     // elements within elements

}  // namespace

XmlFile::XmlFile(const std::filesystem::path& file) : path(file) {
  const std::string text = read_file(path, kLargestFile, "a muscle model");
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) {
    throw Error(ErrorKind::file, path, ": is not whole XML: ", result.description(), " at byte ", result.offset,
                ": cut off, or another kind of file?");
  }
  elements = require_shallow(path, document);
}

int require_shallow(const std::filesystem::path& path, pugi::xml_node tree) {
  struct Walker : pugi::xml_tree_walker {
    int count = 0;
    bool for_each(pugi::xml_node&) override { return depth() < kDeepest && ++count <= kMostElements; }
  } walker;
  if (!tree.traverse(walker)) {
    throw Error(ErrorKind::file, path, ": nests elements more than ", kDeepest, " deep, or holds more than ",
                kMostElements, ": no muscle model does");
  }
  return walker.count;
}

std::vector<double> parse_numbers(const std::filesystem::path& path, pugi::xml_node element, const std::string& what,
                                  const std::string& text, std::size_t least, std::size_t most) {
  constexpr const char* kBlanks = " \t\r\n";
  std::vector<double> numbers;
  std::size_t begin = text.find_first_not_of(kBlanks);
  while (begin != std::string::npos) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const char* first = text.data() + begin + (text[begin] == '+' ? 1 : 0);
    double number = 0;
    const auto [stop, error] = std::from_chars(first, text.data() + end, number);
    if (error != std::errc() || stop != text.data() + end || !(std::abs(number) < 1e6)) {
      refuse(path, element, "has '", text.substr(begin, end - begin), "' in ", what, ", expected a number");
    }
    numbers.push_back(number);
    begin = text.find_first_not_of(kBlanks, end);
  }
  if (numbers.size() < least || numbers.size() > most) {
    refuse(path, element, "has ", numbers.size(), " numbers in ", what, ", expected ", least,
           (least == most ? "" : " or more"));
  }
  return numbers;
}

}  // namespace bodyopt::trainer::muscle_models
