// The one type of JSON: keys keep their order. Here is its name alone, which takes no time to compile; who works with
// it includes <nlohmann/json.hpp>.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace bodyopt {

using Json = nlohmann::ordered_json;

}  // namespace bodyopt
