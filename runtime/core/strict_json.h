// JSON from outside: what the grammar leaves open is refused too, duplicate keys and deep nesting (later readers,
// destructors and printers recurse).
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {

// Throws Error(file) whose text starts with `origin`. `Json` is nlohmann::json or nlohmann::ordered_json.
template <typename Json>
Json parse_strict_json(std::string_view text, const std::string& origin) {
  constexpr std::size_t kMaxDepth = 32, kMaxReason = 200;
  std::vector<std::set<std::string>> open;  // keys so far of every object and list that is not closed yet
  const auto watch = [&](int, typename Json::parse_event_t event, const Json& value) {
    using Event = typename Json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) {
      if (open.size() == kMaxDepth) {
        throw Error(ErrorKind::file, origin + ": its JSON is nested deeper than " + std::to_string(kMaxDepth) +
                                         " levels; it was not written by us or is damaged");
      }
      open.emplace_back();
    } else if (event == Event::object_end || event == Event::array_end) {
      open.pop_back();
    } else if (event == Event::key && !open.back().insert(value.template get<std::string>()).second) {
      throw Error(ErrorKind::file, origin + ": its JSON has the key '" + value.template get<std::string>() +
                                       "' twice in one object; expected once (copied by hand, or damaged)");
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::file, origin + ": its JSON cannot be read (" +
                                     std::string(error.what()).substr(0, kMaxReason) + "); damaged or cut off?");
  }
}

}  // namespace bodyopt
