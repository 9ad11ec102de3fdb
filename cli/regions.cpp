// bodyopt regions: the regions in which training learns the skin, to look at and to edit.
#include "trainer/train/regions/regions.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "assets/clips/axis_turns.h"
#include "base/wording.h"
#include "cli/arguments/common.h"
#include "dataset/regions_file.h"
#include "report/pictures.h"
#include "report/region_picture.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::cli {
namespace {

struct RegionsArguments {
  std::string dataset, out, picture;
  JsonOption json;
};

// Returns the numbers of regions that the picture does not show.
std::vector<std::size_t> draw(const Character& character, const std::vector<RegionWeights>& regions,
                              const std::string& path) {
  const std::vector<float> skin = floats_of(upright_skin(character.skeleton, character.vertices));
  std::vector<report::DrawnRegion> drawn;
  for (const RegionWeights& region : regions) drawn.push_back({region.vertices, region.weights});
  draw::Renderer renderer;
  report::RegionPicture picture =
      report::region_picture(renderer, skin, report::flat(character.triangles), drawn,
                             report::region_colours(drawn, skin.size() / 3), 700, 1000, report::kAllAround);
  draw::write_png(picture.image, path);
  return std::move(picture.unnumbered);
}

std::string not_numbered(const std::vector<std::size_t>& numbers) {
  std::string text;
  for (const std::size_t number : numbers) text += (text.empty() ? "" : ", ") + std::to_string(number);
  return text.empty() ? ""
                      : " (too little is seen of " + text + " to number " + (numbers.size() == 1 ? "it)" : "them)");
}

void run(const RegionsArguments& arguments) {
  for (const std::string& path : {arguments.out, arguments.picture}) {
    if (!path.empty()) require_writable(path);
  }
  arguments.json.require_writable();
  const std::filesystem::path path = dataset_file(arguments.dataset);
  const Dataset dataset = read_dataset(path);
  if (!arguments.out.empty()) {
    refuse_overwriting(arguments.out, path);
    if (!dataset.regions.empty()) refuse_overwriting(arguments.out, dataset.folder / dataset.regions);
  }
  const trainer::SampleSet set = trainer::read_samples(dataset);
  say(set.notes);
  const std::vector<RegionWeights> regions = trainer::training_regions(set, {});

  Json list = Json::array();
  std::string text =
      format("{:>3}  {:28} {:9} {:>9}   {}\n", "", "region", "from", "vertices", "joints that move its skin");
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const RegionWeights& region = regions[r];
    const bool of_file =
        std::ranges::any_of(set.regions, [&](const RegionWeights& other) { return other.name == region.name; });
    const double size = std::accumulate(region.weights.begin(), region.weights.end(), 0.0);
    const std::vector<std::string> joints = trainer::joints_of(set.character, region);
    text += format("{:3}  {:28} {:9} {:9.0f}   {}\n", r + 1, region.name, of_file ? "file" : "training", size,
                   list_names(joints, 3));
    list.push_back({{"number", r + 1},
                    {"name", region.name},
                    {"from", of_file ? "file" : "training"},
                    {"vertices", size},
                    {"joints", joints}});
  }
  Json result = {{"regions", list}};
  if (!arguments.out.empty()) {
    write_regions(regions, set.character, arguments.out);
    result["out"] = arguments.out;
    text += "wrote " + arguments.out + "\n";
  }
  if (!arguments.picture.empty()) {
    const std::vector<std::size_t> unnumbered = draw(set.character, regions, arguments.picture);
    result["picture"] = arguments.picture;
    result["not_numbered"] = unnumbered;
    text += "wrote " + arguments.picture + not_numbered(unnumbered) + "\n";
  }
  arguments.json.emit(result, text);
}

}  // namespace

void add_regions(CLI::App& app) {
  const auto [verb, arguments] = add_verb<RegionsArguments>(
      app, "regions", "Show the regions in which `train` learns the skin, and write them to be edited", run);
  add_required(verb, "dataset", arguments.dataset, "DATASET", "dataset.json, or its folder");
  add_option(verb, "--out", arguments.out, "FILE.json", "Also write them, as a file that dataset.json can name");
  add_option(verb, "--picture", arguments.picture, "FILE.png",
             "Also draw them, numbered, from the front, from the left, from behind and from the right");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
