// The poses of a folder, with what they look like: a click takes one, a drag to the right a share of it.
#include <algorithm>
#include <utility>

#include "runtime/core/text.h"
#include "viewport/commands/flipped_pose.h"
#include "viewport/panels/panels.h"
#include "viewport/platform/gui.h"

namespace bodyopt::viewport {
namespace {

constexpr int kPosesInALine = 3;
constexpr float kWholePose = 160;  // points that the mouse goes for all of a pose

// Live while the mouse is down; that is one step of undo.
void take_pose(const PoseFile& file, Controls& controls) {
  PanelState& typed = controls.typed;
  if (ImGui::IsItemActivated()) typed.pose_before = controls.settings.pose;
  if (!typed.pose_before || !(ImGui::IsItemActive() || ImGui::IsItemDeactivated())) return;
  const bool drags = ImGui::IsMouseDragging(0, 3) && ImGui::IsItemActive();
  if (drags)
    typed.pose_share = std::clamp(static_cast<double>(ImGui::GetMouseDragDelta(0, 3).x / kWholePose), 0.0, 1.0);
  if (ImGui::IsItemDeactivated() && !typed.pose_share && ImGui::IsItemHovered()) typed.pose_share = 1;
  if (typed.pose_share) {
    controls.attempt([&] {
      require_own_pose(controls, file.pose, file.path.string());
      blend_in(controls, file.pose, *typed.pose_share, *typed.pose_before);
    });
  }
  if (drags) ImGui::SetTooltip("%.0f %%", 100 * *typed.pose_share);
  if (!ImGui::IsItemDeactivated()) return;
  typed.pose_before.reset();
  typed.pose_share.reset();
}

// `picture`: of those that the letters' image has; -1: none.
void draw_pose_file(const PoseFile& file, int picture, float width, Controls& controls) {
  const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + width, at.y + width};
  ImGui::InvisibleButton("pose", {width, width + ImGui::GetTextLineHeight()});
  const bool is_hovered = ImGui::IsItemHovered();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, end, ImGui::GetColorU32(is_hovered ? ImGuiCol_FrameBgHovered : ImGuiCol_FrameBg), 4);
  if (picture >= 0) add_picture(list, picture, at, end);
  ImGui::PushClipRect(at, {end.x, end.y + ImGui::GetTextLineHeight()}, true);
  const std::string name = file.path.stem().string();
  if (!file.problem.empty()) list.AddText({at.x + 6, at.y + 6}, kErrorColour, "damaged");
  list.AddText({at.x + 2, end.y}, ImGui::GetColorU32(ImGuiCol_Text), name.c_str());
  ImGui::PopClipRect();
  if (is_hovered && !ImGui::IsItemActive()) {
    const std::string what =
        file.problem.empty() ? name + ": click to take it, drag to the right for a share" : file.problem;
    explain_text(what);
  }
  if (file.problem.empty()) take_pose(file, controls);
}

}  // namespace

void draw_poses(const Snapshot&, Controls& controls) {
  const std::vector<PoseFile>& poses = controls.pose_library.poses();
  if (poses.empty()) ImGui::TextDisabled("no poses in this folder");
  const float width = share_of_line(kPosesInALine);
  int shown = 0, pictures = 0;
  for (const PoseFile& file : poses) {
    if (shown++ % kPosesInALine > 0) ImGui::SameLine();
    ImGui::PushID(file.path.c_str());
    const bool is_pictured = file.picture.width > 0 && pictures < static_cast<int>(PoseLibrary::kMostPictures);
    draw_pose_file(file, is_pictured ? pictures++ : -1, width, controls);
    ImGui::PopID();
  }
  const float half = share_of_line(2);
  for (const auto& [command, text] :
       {std::pair("save-pose", "Save pose\xe2\x80\xa6"), {"load-pose", "Folder\xe2\x80\xa6"}}) {
    if (ImGui::Button(text, {half, 0})) {
      controls.folder = controls.shown_pose_folder();
      attempt(controls, std::string("browse ") + command);
    }
    explain(command);
    ImGui::SameLine();
  }
  ImGui::NewLine();
}

}  // namespace bodyopt::viewport
