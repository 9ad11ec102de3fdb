// The skins that a frame's views show, and what stands in for them.
#include <algorithm>
#include <cmath>

#include "draw/camera.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {
namespace {

constexpr std::array<float, 3> kBeforeColour = {0.12f, 0.30f, 0.75f}, kAfterColour = {0.80f, 0.33f, 0.10f};
constexpr std::array<float, 3> kWornColour = {0.16f, 0.19f, 0.23f};
constexpr std::array<float, 3> kOtherColour = {0.25f, 0.47f, 0.62f};  // of what is compared with
constexpr float kSkinOverTets = 0.12f;

// A round number of metres, about a tenth of the size.
float grid_spacing(double size) {
  const double power = std::pow(10, std::floor(std::log10(std::max(1e-3, size / 10))));
  const double share = size / 10 / power;
  return static_cast<float>(power * (share < 2 ? 1 : share < 5 ? 2 : 5));
}

draw::SkinDraw draw_of(const Actor& character, const DeviceSkin& shown, const Controls& controls) {
  const shots::ViewSettings::Look& look = controls.settings.look;
  draw::SkinDraw skin;
  skin.triangles = &character.shown().level().triangles;
  skin.triangle_count = static_cast<std::uint32_t>(character.basis().mesh.triangles.size() / 3);
  skin.positions = shown.positions;
  skin.normals = shown.normals;
  skin.style = static_cast<draw::SurfaceStyle>(look.style);  // of the same names
  skin.materials = character.materials();
  skin.wire = look.wire;
  skin.shadow = look.shadow;
  skin.heat_range = static_cast<float>(1e-3 * controls.heat_mm());
  return skin;
}

// Heat is of a character's skin alone: what else is drawn of it keeps its colour.
draw::SkinDraw without_heat(draw::SkinDraw draw) {
  draw.reference = draw.distances = draw.colours = nullptr;
  return draw;
}

// Draws the meshes attached to a skin, at that of its poses.
void dress(std::span<const WornMesh> meshes, std::size_t pose, const draw::SkinDraw& skin,
           const std::array<float, 3>& colour, draw::View& view) {
  for (const WornMesh& mesh : meshes) {
    draw::SkinDraw worn = without_heat(skin);
    worn.triangles = mesh.triangles;
    worn.triangle_count = mesh.triangle_count;
    worn.materials = mesh.materials;
    worn.positions = &mesh.positions;
    worn.normals = &mesh.normals;
    worn.first_vertex = static_cast<std::uint32_t>(pose) * mesh.vertex_count;
    worn.colour = colour;
    view.skins.push_back(worn);
  }
}

}  // namespace

std::vector<draw::View> Scene::look(const Controls& controls, const draw::Rectangle& area) {
  stage_seconds_ = {};
  lead_expected_ = nullptr;
  lines_.clear();
  colours_.clear();
  draw::View view;
  view.camera = controls.camera.camera();
  view.area = view.part = area;
  const shots::ViewSettings::Look& look = controls.settings.look;
  view.ground.grid = look.grid;
  view.ground.axes = look.axes;
  view.ground.light = look.style == shots::LookStyle::silhouette;
  view.ground.shadow = look.shadow ? 0.85f : 0.0f;
  const std::vector<std::vector<Pose>> poses = poses_of_cast(controls);
  if (!cast_.empty()) {
    view.ground.height = static_cast<float>(lead().ground());
    view.ground.spacing = grid_spacing(lead().size());
    surround(poses, controls, view);
  }

  std::vector<draw::View> views = {view};
  const shots::ViewSettings::Compare& compare = controls.settings.compare;
  const bool compares = !cast_.empty() && compared_method(lead(), controls.settings) && !compare.activation;
  if (compares &&
      (compare.layout == shots::CompareLayout::side_by_side || compare.layout == shots::CompareLayout::wipe)) {
    views.push_back(view);
    if (compare.layout == shots::CompareLayout::side_by_side) {
      const std::vector<draw::Rectangle> areas = view_areas(controls.settings, area);
      for (std::size_t k = 0; k < 2; ++k) views[k].area = views[k].part = areas[k];
    } else {
      const auto wipe = static_cast<std::uint32_t>(std::lround(compare.wipe * area.width));
      views[0].part.width = wipe;
      views[1].part.x += static_cast<std::int32_t>(wipe);
      views[1].part.width = area.width - wipe;
    }
  }
  evaluate_cast(poses, controls);
  for (std::size_t c = 0; c < cast_.size(); ++c) add_character(c, poses[c], controls, views);
  add_markings(controls, views);
  // Transparent skins are drawn over opaque ones.
  for (draw::View& v : views)
    std::ranges::stable_partition(v.skins, [](const draw::SkinDraw& draw) { return draw.alpha >= 1; });
  return views;
}

std::vector<draw::Rectangle> Scene::view_areas(const shots::ViewSettings& settings, const draw::Rectangle& area) const {
  const shots::ViewSettings::Compare& compare = settings.compare;
  const bool two = !cast_.empty() && compare.layout == shots::CompareLayout::side_by_side && !compare.activation &&
                   compared_method(lead(), settings);
  if (!two) return {area};
  const std::uint32_t left = area.width / 2;
  return {{area.x, area.y, left, area.height},
          {area.x + static_cast<std::int32_t>(left), area.y, area.width - left, area.height}};
}

void Scene::add_character(std::size_t index, std::span<const Pose> poses, const Controls& controls,
                          std::vector<draw::View>& views) {
  Actor& character = *cast_[index];
  const shots::ViewSettings& s = controls.settings;
  const SkinMethod method = shown_method(character, s);
  const std::optional<SkinMethod> other = compared_method(character, s);
  const Shown shown = evaluate(character, method, poses, controls);
  if (index == 0) lead_evaluation_ = shown.evaluation;
  std::optional<Shown> compared;
  const int frame = played_frame(character, controls.playback.frame(), controls);
  const bool is_missing = other == SkinMethod::truth && !character.truth_time(frame);
  const bool is_measured = other != SkinMethod::truth || character.has_sample_at(frame);
  if (other && !is_missing) compared = evaluate(character, *other, poses, controls);

  draw::SkinDraw skin = draw_of(character, shown.skin, controls);
  skin.offset = place(index, controls);
  draw::SkinDraw second = skin;
  if (compared) {
    second.positions = compared->skin.positions;
    second.normals = compared->skin.normals;
    second.colour = kOtherColour;
    second.materials = nullptr;
    if ((s.compare.heat || s.compare.activation) && is_measured) skin.reference = second.positions;
  }
  if (s.compare.coverage && character.shown().knows_coverage()) {
    const ExpectedSkin& expected = character.shown().expected_skin(method);
    skin.distances = &expected.vertices;
    if (index == 0) lead_expected_ = &expected;
  }

  colour_by_match(index, s, skin);
  if (s.look.tets && character.shown().tet_count() > 0) {
    add_tets(character, poses[0], skin, controls, views);
    skin.alpha = kSkinOverTets;
    skin.shadow = skin.wire = false;
  }
  const bool flips = compared && s.compare.layout == shots::CompareLayout::hold && controls.shows_compared();
  const bool opened = index == 0 && cut_open_;
  if (opened) {
    add_cut_open(skin, views[0]);
  } else {
    views[0].skins.push_back(flips ? second : skin);
  }
  if (views.size() > 1) {
    if (!is_missing) views[1].skins.push_back(compared ? second : skin);
  } else if (compared && s.compare.layout == shots::CompareLayout::overlay && !s.compare.activation) {
    second.alpha = 0.6f;
    second.shadow = false;
    views[0].skins.push_back(second);
  }
  if (s.look.worn) {
    const SkinMethod first = flips ? compared->method : method;
    if (!opened) dress(character.worn(first), 0, skin, kWornColour, views[0]);
    if (views.size() > 1 && !is_missing) {
      dress(character.worn(compared ? compared->method : method), 0, skin, kWornColour, views[1]);
    }
  }
  for (draw::View& view : views) {
    if (s.look.skeleton) add_skeleton(character, poses[0], skin.offset, controls, view);
    if (s.look.skeleton && &character == &lead() && !controls.takes_series) add_rings(controls, skin.offset, view);
    if (s.ghosts.trail && &character == &lead()) add_trails(controls, skin.offset, view);
    if (s.look.fibres) add_fibres(character, shown, skin.offset, view);
  }
  if (poses.size() > 1) add_copies_and_ghosts(character, poses, shown, skin, controls, views);
}

// Neither heat nor wires are of it.
void Scene::add_cut_open(const draw::SkinDraw& skin, draw::View& view) const {
  for (const CutOpenSkin::Part* part : {&cut_open_->skin, &cut_open_->face}) {
    if (part->triangle_count == 0) continue;
    draw::SkinDraw draw = without_heat(skin);
    draw.triangles = &part->triangles;
    draw.triangle_count = part->triangle_count;
    draw.positions = &part->positions;
    draw.normals = &part->normals;
    draw.colours = &part->colours;
    draw.first_vertex = 0;
    draw.wire = false;
    view.skins.push_back(draw);
  }
}

// They are quasi-static: they have no past.
void Scene::add_copies_and_ghosts(Actor& character, std::span<const Pose> poses, const Shown& shown,
                                  const draw::SkinDraw& skin, const Controls& controls,
                                  std::vector<draw::View>& views) {
  const shots::ViewSettings& s = controls.settings;
  const Shown others =
      shown.method == SkinMethod::full ? shown : evaluate(character, SkinMethod::full, poses, controls);
  const std::span<const WornMesh> worn = s.look.worn ? character.worn(SkinMethod::full) : std::span<const WornMesh>();
  draw::SkinDraw extra = without_heat(skin);
  extra.positions = others.skin.positions;
  extra.normals = others.skin.normals;
  const std::size_t ghosts = static_cast<std::size_t>(s.ghosts.before + s.ghosts.after);
  const auto add = [&](std::size_t pose, const std::array<float, 3>& worn_colour) {
    extra.first_vertex = static_cast<std::uint32_t>(pose) * character.basis().mesh.vertex_count();
    for (draw::View& view : views) {
      view.skins.push_back(extra);
      dress(worn, pose, extra, worn_colour, view);
    }
  };
  for (std::size_t k = ghosts + 1; k < poses.size(); ++k) {
    extra.offset = place_copy(k - ghosts, controls);
    add(k, kWornColour);
  }
  extra.offset = skin.offset;
  extra.wire = extra.shadow = false;
  for (std::size_t g = 1; g <= ghosts; ++g) {
    const bool before = g <= static_cast<std::size_t>(s.ghosts.before);
    const std::size_t away = before ? g : g - static_cast<std::size_t>(s.ghosts.before);
    const int count = before ? s.ghosts.before : s.ghosts.after;
    extra.colour = before ? kBeforeColour : kAfterColour;
    const double fades = 1 - 0.6 * static_cast<double>(away - 1) / std::max(1, count);
    extra.alpha = static_cast<float>(std::clamp(s.ghosts.opacity * fades, 0.0, 0.99));
    add(g, extra.colour);
  }
}

// The match replaces any heat.
void Scene::colour_by_match(std::size_t index, const shots::ViewSettings& settings, draw::SkinDraw& skin) const {
  const shots::MatchView view = settings.compare.match;
  if (view == shots::MatchView::none || !match_ || index >= 2 || cast_[index]->level() > 0) return;
  skin = without_heat(skin);
  skin.heat_range = 1;  // of what is not sure at all
  (view == shots::MatchView::colours ? skin.colours : skin.distances) =
      &(view == shots::MatchView::colours ? match_->colours : match_->unsure)[index];
}

void Scene::add_tets(Actor& character, const Pose& pose, const draw::SkinDraw& skin, const Controls& controls,
                     std::vector<draw::View>& views) {
  const shots::ViewSettings& s = controls.settings;
  const draw::Camera camera = controls.camera.camera();
  Vec3 towards = draw::to_double(camera.eye) - draw::to_double(camera.target);
  towards = 1 / length(towards) * towards;
  const bool jiggles = shown_method(character, s) == SkinMethod::jiggle;
  const auto amount = jiggles ? std::optional(static_cast<float>(s.jiggle.amount)) : std::nullopt;
  const CutTets& tets = character.shown().cut_tets(pose, amount, towards, s.look.tet_cut);
  draw::SkinDraw draw = without_heat(skin);
  draw.positions = draw.normals = &tets.positions();  // facets need no normals
  draw.style = draw::SurfaceStyle::flat;
  for (const CutTets::Part& part : tets.parts()) {
    draw.triangles = &part.triangles;
    draw.triangle_count = part.triangle_count;
    draw.colour = part.colour;
    for (draw::View& view : views) view.skins.push_back(draw);
  }
}

}  // namespace bodyopt::viewport
