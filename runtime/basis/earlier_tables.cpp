#include "runtime/basis/earlier_tables.h"

#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "runtime/core/json.h"

namespace bodyopt {
namespace {

constexpr std::uint32_t kHalfOne = 0x3c00;

// Rows of an identity matrix of halves, two a word.
void append_identity(std::uint32_t size, std::vector<std::uint32_t>& words) {
  const std::uint32_t row_words = (size + 1) / 2;
  for (std::uint32_t k = 0; k < size; ++k) {
    words.resize(words.size() + row_words);
    words[words.size() - row_words + k / 2] = kHalfOne << 16 * (k % 2);
  }
}

using Names = std::vector<std::string>;
using Numbers = std::vector<double>;

void append_scaled(const Numbers& values, double scale, std::vector<float>& to) {
  for (const double value : values) to.push_back(static_cast<float>(scale * value));
}

std::uint32_t joint_of(const std::string& name, const Skeleton& skeleton, const std::string& origin) {
  const int joint = skeleton.find(name);
  if (joint >= 0) return static_cast<std::uint32_t>(joint);
  throw Error(ErrorKind::file, origin, ": '", name, "' is no joint of the skeleton");
}

void append_region(const Json& entry, const Skeleton& skeleton, const std::string& origin, CoverageTable& table) {
  constexpr double kMetres = 1e-3;
  const Names joints = entry.at("joints").get<Names>();
  for (const std::string& name : joints) table.joints.push_back(joint_of(name, skeleton, origin));
  table.joint_begin.push_back(static_cast<std::uint32_t>(table.joints.size()));
  table.names.push_back(entry.value("name", joints.empty() ? "" : joints.front()));
  table.sizes.push_back(entry.at("size").get<float>());
  table.growth.push_back(entry.at("distance_m2").get<float>());
  table.usual.push_back(entry.at("usual").get<float>());
  append_scaled(entry.at("local_mm").get<Numbers>(), kMetres, table.local);
  append_scaled(entry.value("motion_mm", Numbers()), kMetres, table.motion);
  append_scaled(entry.value("metric", Numbers()), 1, table.metric);
}

}  // namespace

void take_earlier_regions(const std::vector<EarlierRegion>& earlier, ResidualTable& residual) {
  for (const EarlierRegion& e : earlier) {
    residual.regions.push_back({.feature_begin = e.feature_begin,
                                .feature_count = e.feature_count,
                                .coordinate_begin = residual.coordinate_count(),
                                .coordinate_count = e.feature_count,
                                .projection_values = static_cast<std::uint32_t>(residual.projections.size()),
                                .centre_begin = e.centre_begin,
                                .centre_count = e.centre_count,
                                .centre_values = e.centre_values,
                                .coefficient_begin = e.coefficient_begin,
                                .coefficient_count = e.coefficient_count,
                                .weight_values = e.weight_values,
                                .inverse_width2 = e.inverse_width2});
    const auto number = static_cast<std::uint32_t>(residual.regions.size() - 1);
    residual.coordinate_region.insert(residual.coordinate_region.end(), e.feature_count, number);
    append_identity(e.feature_count, residual.projections);
  }
}

CoverageTable earlier_coverage(const std::string& text, const Basis& basis, const std::string& origin) {
  CoverageTable table;
  table.joint_begin = {0};
  const auto list = parse_strict_json(text, origin);
  try {
    for (const Json& entry : list) append_region(entry, basis.skeleton, origin, table);
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, origin, " is damaged: ", error.what());
  }
  return table;
}

}  // namespace bodyopt
