#include "runtime/basis/file_schema.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "runtime/basis/read_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/json.h"

namespace bodyopt {
namespace {

constexpr std::uint64_t kLargestJson = 64 << 20, kMostHeaderBytes = 16 << 20;  // bytes

// "bodyopt-basis" of "bodyopt-basis-3".
std::string_view without_version(std::string_view schema) { return schema.substr(0, schema.rfind('-')); }

// The header of a safetensors file; empty where there can be none.
std::string header_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t length = 0;
  file.read(reinterpret_cast<char*>(&length), sizeof(length));
  std::string header(file && length <= kMostHeaderBytes ? length : 0, '\0');
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  return file ? header : "";
}

std::string schema_in(const Json& object) {
  const bool has_one = object.is_object() && object.contains("schema") && object["schema"].is_string();
  return has_one ? object["schema"].get<std::string>() : "";
}

}  // namespace

std::string schema_of(const std::filesystem::path& path) {
  try {
    const std::string header = header_of(path);
    if (header.starts_with('{')) {
      const Json json = parse_strict_json(header, path.string());
      return json.contains("__metadata__") ? schema_in(json["__metadata__"]) : "";
    }
    return schema_in(parse_strict_json(read_file(path, kLargestJson, "a JSON file"), path.string()));
  } catch (const Error&) {
    return "";
  }
}

void refuse_other_kind(const std::filesystem::path& path, const std::string& schema) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return;
  const std::string kind = looks_like(path), own = schema_of(path);
  const bool is_ours = kind.empty() || kind.find("empty") != std::string::npos ||
                       kind.find("JSON") != std::string::npos || kind.find("safetensors") != std::string::npos;
  if (is_ours && (own.empty() || without_version(own) == without_version(schema))) return;
  throw Error(ErrorKind::usage, path, " is there already, and is of another kind",
              own.empty() ? kind : "; its schema is '" + own + "'", ": choose another name, or remove it");
}

}  // namespace bodyopt
