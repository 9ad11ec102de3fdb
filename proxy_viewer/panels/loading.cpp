// Instead of all else, while there is nothing to show yet.
#include <imgui.h>

#include "proxy_viewer/panels/panels.h"

namespace bodyopt {

void draw_loading(const std::string& text) {
  const ImVec2 all = ImGui::GetIO().DisplaySize, size = ImGui::CalcTextSize(text.c_str());
  ImGui::GetBackgroundDrawList()->AddText({0.5f * (all.x - size.x), 0.5f * (all.y - size.y)},
                                          ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
}

}  // namespace bodyopt
