// The pose on top of the clip: a list of joints, three angles of the one that is selected, controls of the basis.
#include <algorithm>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

constexpr float kListHeight = 132, kIndent = 9;
constexpr int kDeepest = 8;  // of what is indented

void show_joint(Controls& controls, const std::string& joint) {
  if (ImGui::GetIO().KeyCtrl) {
    attempt(controls, "select-also " + joint);
  } else {
    controls.select(joint == controls.joint ? "" : joint);
  }
  if (!joint.empty()) controls.settings.look.skeleton = true;  // with its rings and arrows
}

void draw_row(const JointRow& row, bool indented, Controls& controls) {
  ImGui::PushID(&row);
  const bool selected = row.name == controls.joint || controls.also.contains(row.name);
  ImGui::PushStyleColor(ImGuiCol_Header, ImGui::GetColorU32(ImGuiCol_ButtonActive));
  const bool clicked = ImGui::Selectable("##row", selected);
  ImGui::PopStyleColor();
  if (clicked) show_joint(controls, row.name);
  ImGui::SameLine(6 + (indented ? kIndent * static_cast<float>(std::min(row.depth, kDeepest)) : 0));
  ImGui::PushStyleColor(ImGuiCol_Text, controls.is_posed(row.name) ? kAccent : ImGui::GetColorU32(ImGuiCol_Text));
  ImGui::TextUnformatted(row.name.c_str());
  ImGui::PopStyleColor();
  ImGui::PopID();
}

// Scrolls once, when another joint was selected: a click in the picture may have done so.
void scroll_to_selected(const std::vector<const JointRow*>& rows, Controls& controls) {
  if (controls.typed.listed_joint == controls.joint) return;
  controls.typed.listed_joint = controls.joint;
  const auto at = std::ranges::find(rows, controls.joint, &JointRow::name);
  if (at == rows.end()) return;
  const float middle = static_cast<float>(at - rows.begin()) * ImGui::GetTextLineHeightWithSpacing();
  ImGui::SetScrollY(middle - 0.45f * kListHeight);
}

void draw_list(const Snapshot& snapshot, Controls& controls) {
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##filter", "find a joint", &controls.typed.joint_filter);
  const std::string wanted = lower_case(controls.typed.joint_filter);
  std::vector<const JointRow*> rows;
  for (const JointRow& row : snapshot.joints) {
    if (lower_case(row.name).find(wanted) != std::string::npos) rows.push_back(&row);
  }
  ImGui::PushStyleColor(ImGuiCol_ChildBg, ImGui::GetColorU32(ImGuiCol_FrameBg, 0.5f));
  ImGui::BeginChild("joints", {0, kListHeight});
  scroll_to_selected(rows, controls);
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step()) {
    for (int k = clipper.DisplayStart; k < clipper.DisplayEnd; ++k) {
      draw_row(*rows[static_cast<std::size_t>(k)], wanted.empty(), controls);
    }
  }
  ImGui::EndChild();
  ImGui::PopStyleColor();
}

void draw_angles(const JointRow& row, Controls& controls) {
  std::map<std::string, Vec3>& turned = controls.settings.pose.joints;
  Vec3 angles = shots::set_or(turned, row.name, {});
  bool moved = false;
  const char* const names[] = {"Turn X", "Turn Y", "Turn Z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool free = row.low[axis] < row.high[axis];
    ImGui::BeginDisabled(!free);
    moved |= slide(names[axis], angles[axis], row.low[axis], row.high[axis], free ? "%.1f\xc2\xb0" : "held",
                   "on top of the clip, as far as the joint's limits let it");
    ImGui::EndDisabled();
  }
  if (!moved) return;
  const Vec3 by = angles - shots::set_or(turned, row.name, {});
  for (const std::string& joint : controls.also) turned[joint] = turned[joint] + by;
  turned[row.name] = angles;
}

void draw_moves(const JointRow& row, Controls& controls) {
  if (row.furthest == 0) return;
  std::map<std::string, Vec3>& moves = controls.settings.pose.moves;
  Vec3 by = shots::set_or(moves, row.name, {});
  bool moved = false;
  const char* const names[] = {"Move X", "Move Y", "Move Z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    moved |= slide(names[axis], by[axis], -row.furthest, row.furthest, "%.3f m", find_command("move")->help);
  }
  if (moved) moves[row.name] = by;
}

// "left_elbow_flexion": "left elbow flexion".
std::string words_of(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

// Draws the axes of the selected joint, by the names of its limits.
void draw_axes(const Snapshot& snapshot, Controls& controls) {
  for (const AxisRow& row : snapshot.axes) {
    if (row.joint != controls.joint) continue;
    double angle = shots::set_or(controls.settings.pose.axes, row.name, 0);
    if (slide(words_of(row.name).c_str(), angle, row.low, row.high, "%.1f\xc2\xb0",
              "on top of the clip, as far as the limits let both")) {
      controls.settings.pose.axes[row.name] = angle;
    }
  }
}

// The buttons stay in place, whatever joint is selected.
void draw_joint_buttons(Controls& controls) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = share_of_line(3);
  // The longest label gets what it takes, from the other two.
  const float all = std::max(width, ImGui::CalcTextSize("Reset all").x + 2 * style.FramePadding.x);
  const float others = std::max(1.0f, width - (all - width) / 2);
  ImGui::BeginDisabled(controls.joint.empty());
  command_button(controls, "mirror", nullptr, others);
  ImGui::SameLine();
  command_button(controls, "reset-joint", "Reset", others);
  ImGui::EndDisabled();
  ImGui::SameLine();
  command_button(controls, "reset-pose", "Reset all", all);
  command_button(controls, "copy", nullptr, width);
  ImGui::SameLine();
  ImGui::BeginDisabled(!controls.copied);
  command_button(controls, "paste", nullptr, width);
  ImGui::SameLine();
  command_button(controls, "paste-flipped", "Flipped", width);
  ImGui::EndDisabled();
}

void draw_keying(Controls& controls) {
  command_tick(controls, "auto-key");
  if (controls.settings.pose.keys.size() < 2) return;
  if (slide("Tween", controls.typed.tween, 0, 1, "%.2f", find_command("tween")->help)) {
    attempt(controls, "tween " + std::to_string(controls.typed.tween));
  }
}

void draw_joint(const Snapshot& snapshot, Controls& controls) {
  const auto row = std::ranges::find(snapshot.joints, controls.joint, &JointRow::name);
  if (row == snapshot.joints.end()) {
    ImGui::TextDisabled("select a joint, here or in the picture");
    return;
  }
  ImGui::TextUnformatted(row->name.c_str());
  draw_axes(snapshot, controls);
  draw_angles(*row, controls);
  draw_moves(*row, controls);
}

void draw_controls(const Snapshot& snapshot, Controls& controls) {
  for (const ControlRow& row : snapshot.controls) {
    if (!row.modifier.empty()) continue;
    double value = shots::set_or(controls.settings.pose.controls, row.name, 0);
    if (slide(row.name.c_str(), value, row.low, row.high, "%.2f", find_command("control")->help)) {
      controls.settings.pose.controls[row.name] = value;
    }
  }
}

// Draws the pin of the selected joint.
void draw_pin(Controls& controls) {
  const bool is_pinned = controls.settings.pose.pins.contains(controls.joint);
  const float width = share_of_line(2);
  ImGui::BeginDisabled(controls.joint.empty());
  if (ImGui::Button("Pin here", {width, 0})) attempt(controls, "pin " + controls.joint);
  explain("pin");
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(!is_pinned);
  command_button(controls, "unpin", nullptr, width);
  ImGui::EndDisabled();
}

}  // namespace

void draw_pose(const Snapshot& snapshot, Controls& controls) {
  draw_list(snapshot, controls);
  draw_joint_buttons(controls);
  draw_pin(controls);
  draw_joint(snapshot, controls);
  draw_controls(snapshot, controls);
  draw_keying(controls);
  slide("Learned", controls.settings.pose.correction, 0, 1, "%.2f", find_command("correction")->help);
}

}  // namespace bodyopt::viewport
