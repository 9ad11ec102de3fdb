#include "trainer/train/skinning/provenance.h"

#include <nlohmann/json.hpp>

#include "base/json_file.h"

namespace bodyopt::trainer {
namespace {

Json parse(const Metadata& metadata) {
  const auto text = metadata.find("provenance");
  return text == metadata.end() ? Json() : Json::parse(text->second, nullptr, false);
}

}  // namespace

std::optional<Provenance> read_provenance(const Metadata& metadata, const std::filesystem::path& origin) {
  const Json json = parse(metadata);
  if (!json.is_object()) return std::nullopt;
  const JsonObject object(json, origin, "the metadata 'provenance'");
  Provenance provenance;
  TrainOptions& options = provenance.options;
  const auto read_count = [&](const char* key, int& value) {
    if (object.has(key)) value = object.integer(key, 0);
  };
  const auto read_size = [&](const char* key, double& value) {
    if (object.has(key)) value = object.number(key, 0, 1e9);
  };
  if (object.has("program")) provenance.program = object.text("program");
  if (object.has("updated")) provenance.updated = object.boolean("updated");
  if (json.contains("seed")) {
    if (!json.at("seed").is_number_unsigned()) object.refuse("has a 'seed' that is no whole number from 0 on");
    options.seed = json.at("seed");
  }
  read_size("smoothing_radius_m", options.smoothing_radius);
  read_count("smoothing_steps", options.smoothing_steps);
  read_count("components", options.components);
  read_count("centres", options.centres);
  read_count("surface_curves", options.surface_curves);
  read_size("budget", options.budget);
  read_size("tolerance_mm", options.tolerance_mm);
  return provenance;
}

void add_source(const Metadata& source, Metadata& metadata) {
  Json provenance = parse(metadata);
  if (const Json of_source = parse(source); !of_source.is_discarded()) provenance["transferred_from"] = of_source;
  metadata["provenance"] = provenance.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace bodyopt::trainer
