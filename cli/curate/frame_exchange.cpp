// A frame as a mesh to be sculpted elsewhere, and back as a sculpt.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "assets/clips/clip_source.h"
#include "base/wording.h"
#include "cli/curate/curate_arguments.h"
#include "cli/curate/stack_report.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/exported_frames.h"
#include "trainer/curate/frame_files.h"
#include "trainer/curate/frame_sculpting.h"
#include "trainer/curate/modifier_scope.h"

namespace bodyopt::cli {
namespace {

// V x 3, as a frame went to the artist's tool.
Positions exported_skin(const trainer::ShapeStack& stack, std::size_t frame, const trainer::ExportedFrame& exported,
                        bool unposed) {
  if (unposed) return exported.skin;
  const trainer::PoseDatabase& database = stack.database();
  return stack.space().frame(database.frames[frame].pose).shape(exported.skin - database.character.vertices);
}

// Returns the export's mark. The frame can be looked at and sculpted without, too: it comes back as a sculpt of what
// the frame is then.
std::string remember(const CurateArguments& arguments, const trainer::ShapeStack& stack, std::size_t frame,
                     const trainer::ExportedFrame& exported) {
  try {
    return trainer::keep_exported(path_of(arguments), stack, frame, exported);
  } catch (const Error& error) {
    say({std::string("import-frame will not know what was exported, should the stack change: ") + error.what()});
    return "";
  }
}

// Why two stacks make different shapes of a frame, but for what is sculpted in `name`.
std::string what_differs(std::vector<Modifier> before, std::vector<Modifier> now, const std::string& name) {
  const auto forget_sculpts = [&](std::vector<Modifier>& modifiers) {
    const auto own = std::ranges::find(modifiers, name, &Modifier::name);
    if (own != modifiers.end()) own->parameters = Json::object();
    return own != modifiers.end();
  };
  const bool was_there = forget_sculpts(before), is_there = forget_sculpts(now);
  if (was_there != is_there) std::erase(was_there ? before : now, Modifier{.name = name, .type = "sculpt"});
  const std::vector<std::string> names = trainer::names_that_differ(before, now);
  if (!names.empty()) return "modifiers " + list_names(names);
  return before == now ? "its raw shape" : "the order of the modifiers";
}

// Tells the artist how the frame has changed since, but for the modifier's own sculpt.
std::vector<std::string> changes_since(const trainer::ShapeStack& stack, std::size_t frame,
                                       const trainer::ExportedFrame& exported, const std::string& name) {
  constexpr double kChanged = 1e-5;  // metres
  const trainer::PoseDatabase& database = stack.database();
  const std::vector<Modifier>& modifiers = database.dataset.modifiers;
  const auto without = [&](const trainer::ExportedFrame& there) {
    return Positions(there.skin - trainer::sculpted_by(database, there.modifiers, name, frame));
  };
  const double most = (without(trainer::exported_now(stack, frame)) - without(exported)).rowwise().norm().maxCoeff();
  if (most < kChanged) return {};
  return {format(
      "{} has changed by {:.2f} mm since the mesh was exported ({}): what was sculpted is added to what it is now",
      database.name_of(frame), 1e3 * most, what_differs(exported.modifiers, modifiers, name))};
}

// How far the sculpt of a frame reaches, now that it is in the stack; none where the modifier has no sculpt of it.
struct SculptReach {
  double most_mm = 0;      // by the modifier's strength and mask
  double degrees = 0;      // of its spread
  std::size_t others = 0;  // frames that take of it
};

std::optional<SculptReach> reach_of(const trainer::PoseDatabase& database, const std::string& name, std::size_t frame) {
  const Modifier* modifier = find_modifier(database.dataset.modifiers, name);
  if (!modifier) return std::nullopt;
  const trainer::SculptedFrames sculpted(
      database, JsonObject(modifier->parameters, database.dataset.folder / "dataset.json", name), name);
  const auto own = std::ranges::find(sculpted.sculpts(), frame, &trainer::SculptedFrame::frame);
  if (own == sculpted.sculpts().end()) return std::nullopt;
  const Eigen::VectorXd mask = trainer::skin_mask(database, modifier->mask, name);
  SculptReach reach{1e3 * modifier->strength * own->delta.rowwise().norm().cwiseProduct(mask).maxCoeff(),
                    sculpted.spread()};
  const auto number = static_cast<std::size_t>(own - sculpted.sculpts().begin());
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (n != frame && sculpted.weights(n)[number] > 0) ++reach.others;
  }
  return reach;
}

// The stack with the sculpt in it, and what the sculpt moves.
void emit_sculpt(const CurateArguments& arguments) {
  std::optional<trainer::PoseDatabase> read = trainer::read_pose_database(read_dataset(path_of(arguments)));
  auto [list, text] = report_stack(read->dataset, read);
  const trainer::ShapeStack stack(std::move(*read));
  const trainer::PoseDatabase& database = stack.database();
  const std::size_t frame = database.find(arguments.take, arguments.frame, "import-frame");
  Json result = {{"dataset", path_of(arguments).string()}, {"modifiers", list}};
  const std::optional<SculptReach> reach = reach_of(database, arguments.name, frame);
  if (reach) {
    result["sculpt"] = {{"max_mm", reach->most_mm}, {"other_frames", reach->others}};
    text += format("the sculpt moves {} by {:.2f} mm at most, and {} within {:g} degrees by less\n",
                   database.name_of(frame), reach->most_mm, count_of(reach->others, "other frame", "other frames"),
                   reach->degrees);
  }
  const std::string hidden = trainer::why_not_shown(database, arguments.name, frame);
  if (!hidden.empty())
    say({"the modifier '" + arguments.name + "' " + hidden + ": the frame is not what was sculpted"});
  arguments.json.emit(result, text);
}

// The mesh alone does not tell which export it was made of.
std::string alike_note(const trainer::PoseDatabase& database, std::size_t frame, const trainer::ExportedFrame& taken,
                       std::size_t others) {
  const std::vector<std::string> names = transformed(taken.modifiers, &Modifier::name);
  return format(
      "the mesh does not say which export of {} it is of (its name is another), and lies on {} as well: taken is the "
      "latest, which was made {}",
      database.name_of(frame), count_of(others, "other", "others"),
      names.empty() ? "without modifiers" : "by the modifiers " + list_names(names));
}

}  // namespace

void export_frame(const CurateArguments& arguments) {
  require_writable(arguments.out);
  const trainer::ShapeStack stack(trainer::read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  const Character& character = stack.database().character;
  const std::size_t frame = stack.database().find(arguments.take, arguments.frame, "export-frame");
  const trainer::ExportedFrame exported = trainer::exported_now(stack, frame);
  const Positions skin = arguments.unposed ? exported.skin : stack.shape(frame);
  const Pose& pose = stack.database().frames[frame].pose;
  const SkinSurface surface = trainer::frame_surface(stack.database());
  const std::string mark = remember(arguments, stack, frame, exported);
  if (lower_case_extension(arguments.out) == ".glb") {
    trainer::write_frame_gltf(character, surface, skin, arguments.unposed ? bind_pose(character.skeleton) : pose,
                              arguments.out, mark);
  } else {
    trainer::write_frame_obj(character, surface, output_from_welded(character, skin), arguments.out, mark);
  }
  arguments.json.emit({{"mesh", arguments.out}, {"vertices", character.output_count()}},
                      format("wrote {}: {} vertices\n", arguments.out, character.output_count()));
}

void import_frame(const CurateArguments& arguments) {
  const trainer::ShapeStack stack(trainer::read_pose_database(read_dataset(path_of(arguments))));
  const trainer::PoseDatabase& database = stack.database();
  const std::size_t frame = database.find(arguments.take, arguments.frame, "import-frame");
  trainer::require_sculpt(database.dataset.modifiers, arguments.name);
  trainer::KeptExports kept = trainer::kept_exports(stack, frame, arguments.name);
  say(kept.notes);
  std::vector<trainer::ExportedFrame>& exports = kept.frames;
  exports.push_back(trainer::exported_now(stack, frame));
  const std::vector<trainer::WrittenSkin> skins = transformed(exports, [&](const trainer::ExportedFrame& exported) {
    return trainer::WrittenSkin{exported_skin(stack, frame, exported, arguments.unposed), exported.mark};
  });
  const trainer::FrameMesh mesh =
      trainer::read_frame_mesh(database.character, trainer::frame_surface(database).texture, skins, arguments.mesh);
  const trainer::ExportedFrame& exported = exports[mesh.of];
  if (mesh.was_turned) {
    say(
        {"the mesh lies turned, as programs write it whose up is another axis (Z, in Blender): it was turned back to "
         "where it was exported"});
  }
  if (mesh.alike > 0) say({alike_note(database, frame, exported, mesh.alike)});
  say(changes_since(stack, frame, exported, arguments.name));
  say(trainer::add_sculpt(path_of(arguments), arguments.name, arguments.take, arguments.frame, exported, mesh.positions,
                          arguments.unposed, arguments.spread));
  emit_sculpt(arguments);
}

}  // namespace bodyopt::cli
