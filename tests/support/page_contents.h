// What a page that bodyopt wrote holds.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "runtime/core/json.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::testing {

// The text between the tags of its JSON.
inline std::string page_json(const std::string& page) {
  const std::string begin = "id=\"contents\">";
  const std::size_t from = page.find(begin) + begin.size();
  return page.substr(from, page.find("</script>", from) - from);
}

// Kind, figures, pictures, colours. Throws where it is no JSON.
inline Json page_contents(const std::filesystem::path& page) { return Json::parse(page_json(read_bytes(page))); }

}  // namespace bodyopt::testing
