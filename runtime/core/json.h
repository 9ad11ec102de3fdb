// The one type of JSON: keys keep their order. Here is its name alone, which takes no time to compile; who works with
// it includes <nlohmann/json.hpp>.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace bodyopt {

using Json = nlohmann::ordered_json;

// JSON from outside must not have duplicate keys or nest deeply, although the grammar allows both: later readers,
// destructors and printers recurse.

// Throws Error(file) whose text starts with `origin`.
Json parse_strict_json(std::string_view text, const std::string& origin);

// Writes JSON as a file has it, in one line, or indented by so much. Throws likewise where a name is not UTF-8 text.
std::string strict_json_text(const Json& json, const std::string& origin, int indent = -1);

}  // namespace bodyopt
