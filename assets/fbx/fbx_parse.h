// The tree of nodes that an FBX file is, from binary or text, of bytes that nobody vouches for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {

// Raw data (pictures) are strings.
using FbxValue = std::variant<std::int64_t, double, std::string, std::vector<std::int64_t>, std::vector<double>>;

struct FbxNode {
  std::string name;
  std::vector<FbxValue> values;
  std::vector<FbxNode> children;

  // The first child of that name, or nullptr.
  const FbxNode* find(std::string_view child) const;
  // The same, but a node with nothing in it where there is none.
  const FbxNode& child(std::string_view wanted) const;
  // All numbers among the values, those of arrays one by one.
  std::vector<double> numbers() const;
  // All whole numbers among the values, those of arrays one by one.
  std::vector<std::int64_t> integers() const;
  // The value there as it is asked for, or `otherwise` where there is none of the kind.
  double number(std::size_t place, double otherwise) const;
  std::int64_t integer(std::size_t place, std::int64_t otherwise) const;
  std::string text(std::size_t place) const;
};

bool is_fbx(std::string_view bytes);

// The nodes at the top are the children of what is returned, whose values are the version (7400, say) and 1 for text
// or 0. Messages call the file `path`. Throws Error(file), also for versions below 7000.
FbxNode parse_fbx(const std::filesystem::path& path, std::string_view bytes);

}  // namespace bodyopt
