#include "base/wording.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "runtime/core/text.h"

namespace bodyopt {
namespace {

// Levenshtein's distance.
std::size_t edits_between(const std::string& a, const std::string& b) {
  const auto same = [](char x, char y) {
    return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
  };
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (same(a[i], b[j]) ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string list_names(std::span<const std::string> names, std::size_t shown) {
  if (names.empty()) return "none";
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < shown; ++i) text += (i == 0 ? "'" : ", '") + names[i] + "'";
  if (names.size() > shown) text += " and " + std::to_string(names.size() - shown) + " more";
  return text;
}

void note_names(const std::string& what, std::span<const std::string> names, std::vector<std::string>& notes) {
  if (!names.empty()) notes.push_back(what + list_names(names) + ".");
}

std::string count_of(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string missing_ending(const std::string& name, const std::string& endings) {
  std::string all;
  for (std::size_t begin = 0; begin <= endings.size();) {
    const std::size_t end = std::min(endings.find('|', begin), endings.size());
    const std::string ending = endings.substr(begin, end - begin);
    if (name.ends_with(ending)) return "";
    all += (all.empty() ? "" : end == endings.size() ? " or " : ", ") + ending;
    begin = end + 1;
  }
  return all;
}

std::string rounded(double value) { return formatted("%.4g", value); }

std::vector<std::string> nearest_names(std::span<const std::string> names, const std::string& wanted) {
  constexpr std::size_t kShown = 3;
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& name : names) ranked.emplace_back(edits_between(name, wanted), name);
  std::ranges::stable_sort(ranked, {}, &std::pair<std::size_t, std::string>::first);
  std::vector<std::string> nearest;
  for (std::size_t k = 0; k < ranked.size() && k < kShown; ++k) nearest.push_back(ranked[k].second);
  return nearest;
}

}  // namespace bodyopt
