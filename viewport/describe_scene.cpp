#include "viewport/describe_scene.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/modifiers/skin_modifier_type.h"
#include "viewport/commands/commands.h"

namespace bodyopt::viewport {
namespace {

// The order is that of the enumeration.
constexpr const char* kMethodNames[] = {
    "linear blending", "Direct Delta Mush", "linear part of learned", "learned", "jiggle", "proxy", "truth"};

// A basis that learned nothing is what it would be without that.
const char* name_of(SkinMethod method, const Basis& basis) {
  const bool adds_learned = method == SkinMethod::full || method == SkinMethod::linear;
  const bool is_ddm = adds_learned && basis.residual.coefficient_count() == 0;
  return kMethodNames[static_cast<std::size_t>(is_ddm ? SkinMethod::ddm : method)];
}

CharacterRow describe(const Actor& character) {
  CharacterRow row;
  row.name = character.name();
  row.basis = character.files().basis;
  row.clip = character.clip().name;
  row.truth = character.files().truth;
  row.wears = character.wears();
  return row;
}

// Describes what is shown of it, at its level of detail.
void describe_shown(const Actor& character, const shots::ViewSettings& settings, CharacterRow& row) {
  const MeshTable& mesh = character.basis().mesh;
  row.vertices = mesh.vertex_count();
  row.level = character.level();
  row.level_count = character.level_count();
  row.triangles = static_cast<std::uint32_t>(mesh.triangles.size() / 3);
  row.tets = character.shown().tet_count();
  row.bytes = total_bytes(character.basis());
  row.method = name_of(shown_method(character, settings), character.basis());
}

std::vector<JointRow> describe_joints(const Actor& lead) {
  std::vector<JointRow> rows;
  for (const Joint& joint : lead.basis().skeleton.joints) {
    const int depth = joint.parent < 0 ? 0 : rows[static_cast<std::size_t>(joint.parent)].depth + 1;
    rows.push_back({joint.name, joint.parent, depth});
  }
  for (const std::string& name : lead.movable_joints()) {
    std::ranges::find(rows, name, &JointRow::name)->furthest = lead.size();
  }
  return rows;
}

// Controls are the last of the features.
std::vector<ControlRow> describe_controls(const ResidualTable& residual) {
  const std::size_t count = residual.controls.size();
  std::vector<ControlRow> rows;
  for (std::size_t k = 0; k < count; ++k) {
    const FeatureRange& range = residual.features[residual.features.size() - count + k];
    const bool varies = range.low < range.high;
    rows.push_back({residual.controls[k], varies ? static_cast<double>(range.low) : 0,
                    varies ? static_cast<double>(range.high) : 1});
  }
  return rows;
}

// Channels of the modifiers, after those that were trained.
void add_modifiers(const SkinModifiers& modifiers, Snapshot& snapshot) {
  snapshot.modifiers.clear();
  for (const SkinModifier& modifier : modifiers.stack) {
    snapshot.modifiers.push_back({modifier.name, modifier.type});
    const auto add = [&](const std::string& channel, const SkinModifierControl& control) {
      const auto usual = static_cast<double>(shots::set_or(modifier.constants, control.name, control.usual));
      snapshot.controls.push_back({channel, static_cast<double>(control.low), static_cast<double>(control.high), usual,
                                   modifier.name, control.what});
    };
    add(modifier.name, kModifierStrength);
    const SkinModifierType* type = find_skin_modifier_type(modifier.type);
    if (type == nullptr) continue;
    for (const SkinModifierControl& control : type->controls) add(modifier.name + "." + control.name, control);
  }
}

std::vector<AxisRow> describe_axes(const Actor& lead) {
  std::vector<AxisRow> rows;
  for (const trainer::DegreeOfFreedom& dof : lead.axes()) {
    if (dof.turns.empty()) continue;
    const std::string& joint = lead.basis().skeleton.joints[dof.turns.front().joint].name;
    rows.push_back({dof.name, joint});
  }
  return rows;
}

// Names comparisons as the command "compare" does.
std::vector<std::string> possible_comparisons(const Actor& lead, shots::ViewSettings settings) {
  std::vector<std::string> possible;
  settings.compare.activation = false;
  const std::vector<std::string> names = choices_of(*find_command("compare"));
  for (std::size_t k = 0; k < names.size(); ++k) {
    settings.compare.with = static_cast<shots::CompareWith>(k);
    if (settings.compare.with == shots::CompareWith::none || compared_method(lead, settings))
      possible.push_back(names[k]);
  }
  return possible;
}

// Names what the lead and the cast lack, and how to get it; see Controls::missing.
std::map<std::string, std::string> describe_missing(const Scene& scene) {
  const Actor& lead = scene.lead();
  std::map<std::string, std::string> missing;
  const auto lacks = [&](std::initializer_list<const char*> commands, const std::string& why) {
    for (const char* command : commands) missing[command] = why;
  };
  if (scene.cast().size() < 2) {
    lacks({"match colours", "match confidence"},
          "a match is of two bodies: open the one that is transferred to after the lead");
  }
  if (!lead.character()) {
    lacks({"anatomy on"},
          "what lies inside is found from the skin weights in the character's file: begin with --character hero.glb");
  }
  if (!lead.has_at_finest(SkinMethod::lbs)) {
    lacks({"compare lbs"},
          "the weights of linear blending are in the character's file: begin with --character hero.glb");
  }
  if (!lead.has_at_finest(SkinMethod::proxy)) {
    lacks({"compare proxy"},
          "there is no proxy: begin with --proxy hero_proxy.safetensors, which 'bodyopt proxy' makes");
  }
  if (!lead.has_at_finest(SkinMethod::truth)) {
    lacks({"compare truth"}, "there is no point cache: open one (.pc2, .mdd), or begin with --truth hero.pc2");
  }
  if (!lead.has_dynamics()) {
    lacks({"compare jiggle", "jiggle on", "tets on"},
          "there are no dynamics beside the basis: 'bodyopt dynamics' makes them");
  } else if (const std::string why = lead.why_still(); !why.empty()) {
    lacks({"compare jiggle", "jiggle on"}, why);
  }
  if (lead.basis().strain.names.empty()) {
    lacks({"fibres on"}, "the basis has no muscles: they are given to 'bodyopt train'");
  }
  return missing;
}

}  // namespace

void describe_cast(const Scene& scene, Snapshot& snapshot) {
  snapshot.cast.clear();
  for (const auto& character : scene.cast()) snapshot.cast.push_back(describe(*character));
  const Actor& lead = scene.lead();
  snapshot.joints = describe_joints(lead);
  snapshot.axes = describe_axes(lead);
  snapshot.controls = describe_controls(lead.basis().residual);
  add_modifiers(lead.basis().modifiers, snapshot);
  snapshot.fibres = lead.basis().strain.names;
  snapshot.clip_fps = lead.clip().fps;
  snapshot.first_frame = lead.clip().first_frame;
}

void name_for_commands(const Scene& scene, Controls& controls) {
  const Actor& lead = scene.lead();
  const Basis& basis = lead.basis();
  controls.output_counts =
      transformed(scene.cast(), [](const auto& one) { return one->finest_basis().mesh.output_count(); });
  controls.joint_names.clear();
  controls.joint_axes.clear();
  for (const Joint& joint : basis.skeleton.joints) {
    controls.joint_names.push_back(joint.name);
    controls.joint_axes.push_back(conjugate(decompose(joint.inverse_bind).rotation));
  }
  controls.control_names = basis.residual.controls;
  for (const std::string& name : modifier_channels(basis.modifiers)) controls.control_names.push_back(name);
  controls.movable_names = lead.movable_joints();
  controls.axis_names.clear();
  controls.axis_joints.clear();
  controls.axes_flip.clear();
  for (const trainer::DegreeOfFreedom& dof : lead.axes()) {
    controls.axis_names.push_back(dof.name);
    controls.axis_joints.push_back(dof.turns.empty() ? "" : basis.skeleton.joints[dof.turns.front().joint].name);
    controls.axes_flip.push_back(!dof.turns.empty() && std::abs(dof.turns.front().axis[0]) < std::sqrt(0.5));
  }
  controls.missing = describe_missing(scene);
  controls.file_cameras = lead.cameras();
}

void describe_turns(const Scene& scene, const Controls& controls, Snapshot& snapshot) {
  const int frame = controls.playback.frame();
  for (std::size_t j = 0; j < snapshot.joints.size(); ++j) {
    const std::optional<shots::JointRange> free = scene.lead().free_turns(j, frame);
    if (!free) continue;
    snapshot.joints[j].low = free->low;
    snapshot.joints[j].high = free->high;
  }
  const std::vector<trainer::DegreeOfFreedom>& axes = scene.lead().axes();
  for (AxisRow& row : snapshot.axes) {
    if (row.joint != controls.joint) continue;
    std::tie(row.low, row.high) =
        scene.lead().free_axis(*std::ranges::find(axes, row.name, &trainer::DegreeOfFreedom::name), frame);
  }
}

void describe_comparison(const Scene& scene, const Controls& controls, const ErrorCurve& curve, Snapshot& snapshot) {
  for (std::size_t c = 0; c < snapshot.cast.size(); ++c) {
    describe_shown(*scene.cast()[c], controls.settings, snapshot.cast[c]);
  }
  const Actor& lead = scene.lead();
  const std::optional<SkinMethod> compared = compared_method(lead, controls.settings);
  snapshot.compared = compared ? name_of(*compared, lead.basis()) : "";
  if (compared == SkinMethod::truth) {
    const std::optional<SampleTime> time = lead.truth_time(controls.playback.frame());
    snapshot.compared += !time ? ": none of this frame" : time->on_sample() ? "" : ", between two samples";
  }
  snapshot.comparisons = possible_comparisons(lead, controls.settings);
  snapshot.knows_coverage = lead.shown().knows_coverage();
  const ExpectedSkin* expected = scene.lead_expected();
  snapshot.expected_mm = expected ? std::optional(expected->rms_mm) : std::nullopt;
  snapshot.most_expected_mm = expected ? std::optional(expected->largest_mm) : std::nullopt;
  snapshot.errors.clear();
  for (std::size_t k = 0; k < curve.errors().size(); ++k) {
    snapshot.errors.push_back({curve.errors()[k].rms, curve.errors()[k].max, curve.is_measured(k)});
  }
  snapshot.measured = curve.measured_count();
  snapshot.worst = curve.worst();
}

void describe_picture(const Scene& scene, Snapshot& snapshot) {
  snapshot.stage_seconds = scene.stage_seconds();
  const Evaluation* evaluation = scene.lead_evaluation();
  if (!evaluation || evaluation->outside.empty()) return;
  snapshot.strains = evaluation->strains;
  const float outside = evaluation->outside[0];
  snapshot.outside = outside < kOutsideWorthTelling ? 0 : outside;
  snapshot.outside_feature = snapshot.outside_by = "";
  if (!(snapshot.outside > 0)) return;
  const Basis& basis = scene.lead().basis();
  const std::uint32_t feature = evaluation->outside_feature[0];
  snapshot.outside_feature = feature_name(basis, feature);
  snapshot.outside_by = outside_text(basis, feature, evaluation->outside_by[0]);
}

}  // namespace bodyopt::viewport
