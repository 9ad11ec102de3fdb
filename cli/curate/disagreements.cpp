// Frames of like poses whose shapes disagree.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/wording.h"
#include "cli/curate/curate_arguments.h"
#include "cli/curate/shape_pictures.h"
#include "cli/curate/stack_report.h"
#include "trainer/curate/consistency_report.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::cli {
namespace {

// The worst pair in one pose, and in colour how far apart the shapes are in its region.
std::string draw_pair(const ShapeStack& stack, const DisagreeingPair& pair, const std::string& path) {
  const PairInOnePose shapes = in_one_pose(stack, pair);
  const double scale = std::max(kFinestScale, pair.most_mm);
  draw_apart(stack.database().character, shapes.first, shapes.second, scale, path);
  return format(
      "wrote {}: {}; the same with what {}, whose pose is {:.1f} degrees off, has in the region {} that poses do not "
      "explain; how far that is, darkest at {:.2f} mm\n",
      path, stack.database().name_of(pair.first), stack.database().name_of(pair.second), pair.pose_degrees, pair.region,
      scale);
}

}  // namespace

void report_disagreements(const CurateArguments& arguments) {
  const ShapeStack stack(read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  const PoseDatabase& database = stack.database();
  const ConsistencyReport found =
      report_consistency(stack, arguments.degrees, static_cast<std::size_t>(arguments.worst));
  std::string text;
  if (!found.pairs.empty()) {
    text = format("{:20} {:20} {:24} {:>9} {:>9} {:>9}\n", "frame", "and frame", "region", "apart mm", "most mm",
                  "degrees");
  }
  Json pairs = Json::array(), regions = Json::array();
  for (const DisagreeingPair& pair : found.pairs) {
    text += format("{:20} {:20} {:24} {:9.2f} {:9.2f} {:9.1f}\n", database.name_of(pair.first),
                   database.name_of(pair.second), pair.region, pair.apart_mm, pair.most_mm, pair.pose_degrees);
    pairs.push_back({{"first", frame_json(database, pair.first)},
                     {"second", frame_json(database, pair.second)},
                     {"region", pair.region},
                     {"apart_mm", pair.apart_mm},
                     {"most_mm", pair.most_mm},
                     {"pose_degrees", pair.pose_degrees}});
  }
  text += format("{}{:24} {:>11} {:>9} {:>10} {:>12}\n", text.empty() ? "" : "\n", "region", "neighbours", "alone",
                 "same pose", "deviation mm");
  for (const RegionAgreement& region : found.regions) {
    text += format("{:24} {:11.0f} {:8.0f}% {:9.0f}% {:12.3f}\n", region.region, region.neighbours, 100 * region.single,
                   100 * region.same_pose, region.deviation_mm);
    regions.push_back({{"region", region.region},
                       {"neighbours", region.neighbours},
                       {"alone", region.single},
                       {"same_pose", region.same_pose},
                       {"deviation_mm", region.deviation_mm}});
  }
  const auto untold = static_cast<std::size_t>(
      std::ranges::count_if(found.regions, [](const RegionAgreement& region) { return region.same_pose == 0; }));
  if (untold > 0) {
    text += format(
        "{} no frame in the same pose as one of another motion: too few neighbours to tell whether shapes disagree "
        "there\n",
        count_of(untold, "region has", "regions have"));
  }
  if (found.pairs.empty()) {
    text += arguments.picture.empty()
                ? "no like poses have shapes that differ by more than their poses do\n"
                : "no like poses have shapes that differ by more than their poses do: there is no pair to draw\n";
  } else if (!arguments.picture.empty()) {
    text += draw_pair(stack, found.pairs.front(), arguments.picture);
  }
  Json frames = Json::array();
  for (std::size_t n = 0; n < found.frame_mm.size(); ++n) {
    frames.push_back(frame_json(database, n));
    frames.back()["deviation_mm"] = found.frame_mm[n];
  }
  arguments.json.emit({{"pairs", pairs}, {"regions", regions}, {"frames", frames}}, text);
}

}  // namespace bodyopt::cli
