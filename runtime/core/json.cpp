#include "runtime/core/json.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Follows the parser through a document.
class StrictJsonGuard {
 public:
  explicit StrictJsonGuard(const std::string& origin) : origin_(origin) {}

  void watch(Json::parse_event_t event, const Json& value) {
    using Event = Json::parse_event_t;
    if (event == Event::object_start || event == Event::array_start) {
      if (open_.size() == kMaxDepth) {
        refuse("is nested deeper than ", kMaxDepth, " levels; it was not written by us or is damaged");
      }
      open_.emplace_back();
    } else if (event == Event::object_end || event == Event::array_end) {
      open_.pop_back();
    } else if (event == Event::key && !open_.back().insert(value.get<std::string>()).second) {
      refuse("has the key '", value.get<std::string>(),
             "' twice in one object; expected once (copied by hand, or damaged)");
    }
  }

 private:
  static constexpr std::size_t kMaxDepth = 32;

  [[noreturn]] void refuse(const auto&... what) const { throw Error(ErrorKind::file, origin_, ": its JSON ", what...); }

  const std::string& origin_;
  std::vector<std::set<std::string>> open_;  // keys so far of every object and list that is not closed yet
};

}  // namespace

Json parse_strict_json(std::string_view text, const std::string& origin) {
  constexpr std::size_t kMaxReason = 200;
  StrictJsonGuard guard(origin);
  try {
    return Json::parse(text, [&](int, Json::parse_event_t event, const Json& value) {
      guard.watch(event, value);
      return true;
    });
  } catch (const Json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const std::string_view line = before.substr(before.rfind('\n') + 1);
    throw Error(ErrorKind::file, origin, ": its JSON cannot be read from line ", 1 + std::ranges::count(before, '\n'),
                ", column ", 1 + line.size(), " on; damaged or cut off?");
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, origin, ": its JSON cannot be read (", std::string(error.what()).substr(0, kMaxReason),
                "); damaged or cut off?");
  }
}

std::string strict_json_text(const Json& json, const std::string& origin, int indent) {
  try {
    return json.dump(indent);
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, origin, ": cannot be written: a name is not UTF-8 text (", error.what(), ")");
  }
}

}  // namespace bodyopt
