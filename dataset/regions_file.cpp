#include "dataset/regions_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "assets/gltf/gltf_skin.h"
#include "base/json_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-regions-1";
constexpr std::array<const char*, 3> kChannels = {"red", "green", "blue"};

// Reads the regions of one file, each as O output weights.
class RegionsReader {
 public:
  RegionsReader(const std::filesystem::path& path, const std::filesystem::path& character_path,
                const Character& character)
      : path_(path), character_path_(character_path), output_count_(character.output_count()) {}

  std::vector<double> read(const JsonObject& region, const JsonObject& top) {
    region.allow({"name", "vertices", "weights", "colour", "channel"});
    const bool listed = region.has("vertices") || region.has("weights"), painted = region.has("colour");
    if (listed == painted) region.refuse("has neither or both of 'vertices' with 'weights' and 'colour'");
    return listed ? listed_weights(region, top) : painted_weights(region);
  }

 private:
  std::vector<double> listed_weights(const JsonObject& region, const JsonObject& top) const {
    const int count = top.integer("vertex_count", 0);
    if (static_cast<std::uint32_t>(count) != output_count_) {
      throw Error(ErrorKind::mismatch, path_, ": its weights are for ", count, " vertices, the character has ",
                  output_count_, ": painted on another mesh?");
    }
    const Json &vertices = region.array("vertices"), &weights = region.array("weights");
    if (vertices.size() != weights.size()) {
      region.refuse("has ", vertices.size(), " 'vertices' and ", weights.size(), " 'weights', expected as many");
    }
    std::vector<double> result(output_count_, -1);  // not listed
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      const std::string place = "[" + std::to_string(k) + "] is ";
      if (!vertices[k].is_number_unsigned() || vertices[k].get<std::uint64_t>() >= output_count_) {
        region.refuse("'vertices'", place, vertices[k].dump(), ", expected 0 to ", output_count_ - 1);
      }
      const double weight = weights[k].is_number() ? weights[k].get<double>() : std::nan("");
      if (!(weight >= 0 && weight <= 1)) {
        region.refuse("'weights'", place, weights[k].dump(), ", expected a number from 0 to 1");
      }
      double& entry = result[vertices[k].get<std::uint64_t>()];
      if (entry >= 0) region.refuse("'vertices'", place, vertices[k].dump(), ", which is there already");
      entry = weight;
    }
    std::ranges::replace(result, -1.0, 0.0);
    return result;
  }

  std::vector<double> painted_weights(const JsonObject& region) {
    const std::string name = region.name("colour"), channel = region.name("channel");
    const auto found = std::ranges::find(kChannels, channel);
    if (found == kChannels.end()) region.refuse("'channel' is '", channel, "', expected red, green or blue");
    if (!colours_.contains(name)) colours_[name] = read_vertex_colours(character_path_, name);
    const std::vector<double>& colours = colours_[name];
    std::vector<double> result(output_count_);
    for (std::size_t o = 0; o < result.size(); ++o) {
      result[o] = colours[3 * o + static_cast<std::size_t>(found - kChannels.begin())];
    }
    return result;
  }

  const std::filesystem::path &path_, &character_path_;
  std::uint32_t output_count_;
  std::map<std::string, std::vector<double>> colours_;  // O x 3 by attribute
};

RegionWeights welded(const std::string& name, const std::vector<double>& output, const Character& character) {
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(character.vertices.rows());
  for (std::size_t o = 0; o < output.size(); ++o) {
    double& weight = largest[character.output_vertex[o]];
    weight = std::max(weight, output[o]);
  }
  return region_of(name, largest);
}

void check_covered(const std::vector<RegionWeights>& regions, const Character& character,
                   const std::filesystem::path& path) {
  const Eigen::VectorXd sums = sum_of_weights(regions, character.vertices.rows());
  std::size_t uncovered = 0, first = 0;
  for (std::size_t o = character.output_count(); o-- > 0;) {
    if (sums[character.output_vertex[o]] > 0) continue;
    ++uncovered;
    first = o;
  }
  if (uncovered == 0) return;
  const std::uint32_t vertex = character.output_vertex[first];
  const auto at = character.vertices.row(vertex);
  std::ostringstream message;
  message.precision(3);
  message << path.string() << ": says that it is complete, but leaves " << uncovered << " of "
          << character.output_count() << " vertices uncovered, vertex " << first << " first, at (" << at.x() << ", "
          << at.y() << ", " << at.z() << ") m near the joint '"
          << character.skeleton.joints[character.weights[vertex].front().joint].name
          << "': give them to a region, or take out 'complete' and training covers them itself";
  throw Error(ErrorKind::mismatch, message.str());
}

void write_list(std::string& text, const char* key, const Json& list) {
  text += ",\n     \"" + std::string(key) + "\": " + list.dump();
}

}  // namespace

std::vector<RegionWeights> read_regions(const Dataset& dataset, const Character& character) {
  if (dataset.regions.empty()) return {};
  const std::filesystem::path path = dataset.folder / dataset.regions,
                              character_path = dataset.folder / dataset.character;
  const JsonFile top(path, kSchema, "the file", {"schema", "source", "vertex_count", "complete", "regions"});
  if (top.has("source")) top.text("source");
  const bool complete = top.has("complete") && top.boolean("complete");
  RegionsReader reader(path, character_path, character);
  std::vector<RegionWeights> regions;
  std::set<std::string> names;
  for (const JsonObject& entry : top.objects("regions")) {
    regions.push_back(welded(entry.name("name"), reader.read(entry, top), character));
    if (!names.insert(regions.back().name).second) entry.refuse("has the name of an earlier region");
  }
  const Eigen::Index vertices = character.vertices.rows();
  complete ? scale_to_one(regions, vertices) : scale_down(regions, vertices);
  drop_negligible(regions);
  for (const RegionWeights& region : regions) {
    if (!region.vertices.empty()) continue;
    throw Error(ErrorKind::mismatch, path, ": the region '", region.name,
                "' has a share of 3 % or more of no vertex: was nothing painted?");
  }
  if (complete) {
    scale_to_one(regions, vertices);
    check_covered(regions, character, path);
  }
  return regions;
}

// A list of numbers is one line, so that the file can be read.
std::string regions_text(const std::vector<RegionWeights>& regions, const Character& character,
                         const std::string& source) {
  const std::string from = source.empty() ? "" : ",\n  \"source\": " + Json(source).dump();
  std::string text = "{\n  \"schema\": \"" + std::string(kSchema) + "\"" + from +
                     ",\n  \"vertex_count\": " + std::to_string(character.output_count()) +
                     ",\n  \"complete\": true,\n  \"regions\": [";
  for (const RegionWeights& region : regions) {
    const Eigen::VectorXd weight = sum_of_weights({region}, character.vertices.rows());
    Json vertices = Json::array(), weights = Json::array();
    for (std::uint32_t o = 0; o < character.output_count(); ++o) {
      if (!(weight[character.output_vertex[o]] > 0)) continue;
      vertices.push_back(o);
      weights.push_back(weight[character.output_vertex[o]]);
    }
    text += &region == &regions.front() ? "\n" : ",\n";
    text += "    {\"name\": " + Json(region.name).dump();
    write_list(text, "vertices", vertices);
    write_list(text, "weights", weights);
    text += "}";
  }
  return text + "\n  ]\n}\n";
}

void write_regions(const std::vector<RegionWeights>& regions, const Character& character,
                   const std::filesystem::path& path, const std::string& source) {
  write_file_atomically(path, regions_text(regions, character, source));
}

}  // namespace bodyopt
