// JSON from outside: what the grammar leaves open is refused too, duplicate keys and deep nesting (later readers,
// destructors and printers recurse).
#pragma once

#include <string>
#include <string_view>

#include "runtime/core/json.h"

namespace bodyopt {

// Throws Error(file) whose text starts with `origin`.
Json parse_strict_json(std::string_view text, const std::string& origin);

}  // namespace bodyopt
