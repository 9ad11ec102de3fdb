// What the colours of muscle fibres, of cut tetrahedra, of a section and of a match mean: a line each, at the bottom of
// the picture; and what of the section is under the mouse.
#include <utility>
#include <vector>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "proxy_viewer/scene/cut_tets.h"
#include "proxy_viewer/state/strain_colour.h"
#include "runtime/core/formatted.h"

namespace bodyopt {
namespace {

constexpr float kKeyMargin = 14, kKeyPadding = 8, kKeyGap = 7, kKeyBarWidth = 120, kSquare = 11;
constexpr int kKeySteps = 40;

// Words and colours in a line, from the left; a line without room is left out.
class KeyLine {
 public:
  // `middle`: height of its middle, pixels.
  KeyLine(float middle, float right) : middle_(middle), right_(right) {}

  void add_text(const std::string& text) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    texts_.push_back({x_, text});
    x_ += size.x + kKeyGap;
  }
  void add_square(ImU32 colour) {
    fields_.push_back({x_, kSquare, colour, colour});
    x_ += kSquare + kKeyGap;
  }
  void add_strains() {
    const auto colour_at = [](int k) {
      return strain_colour(kFullStrain * (2 * static_cast<float>(k) / kKeySteps - 1));
    };
    constexpr float kStep = kKeyBarWidth / kKeySteps;
    for (int k = 0; k < kKeySteps; ++k) {
      fields_.push_back({x_ + static_cast<float>(k) * kStep, kStep, colour_at(k), colour_at(k + 1)});
    }
    x_ += kKeyBarWidth + kKeyGap;
  }

  void draw() const {
    const float end = x_ - kKeyGap, half = 0.5f * ImGui::GetTextLineHeight();
    if (end + kKeyPadding > right_) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled({kKeyMargin - kKeyPadding, middle_ - half - 3}, {end + kKeyPadding, middle_ + half + 3},
                       IM_COL32(20, 20, 22, 170), 4);
    for (const Field& f : fields_) {
      list.AddRectFilledMultiColor({f.left, middle_ - 0.5f * kSquare}, {f.left + f.width, middle_ + 0.5f * kSquare},
                                   f.from, f.to, f.to, f.from);
    }
    for (const auto& [left, text] : texts_) {
      list.AddText({left, middle_ - half}, IM_COL32(225, 225, 228, 255), text.c_str());
    }
  }

 private:
  struct Field {
    float left, width;
    ImU32 from, to;
  };

  float middle_, right_, x_ = kKeyMargin;
  std::vector<Field> fields_;
  std::vector<std::pair<float, std::string>> texts_;
};

void draw_fibre_key(float middle, float right) {
  const std::string percent = formatted("%.0f %%", 100 * static_cast<double>(kFullStrain));
  KeyLine line(middle, right);
  line.add_text("shortened " + percent);
  line.add_strains();
  line.add_text("stretched " + percent);
  line.draw();
}

void draw_tet_key(float middle, float right) {
  KeyLine line(middle, right);
  for (const auto& [kind, name] :
       {std::pair(TetKind::held, "held"), {TetKind::muscle, "muscle"}, {TetKind::fat, "all else"}}) {
    line.add_square(opaque(cut_colour(kind)));
    line.add_text(name);
  }
  line.draw();
}

void draw_section_key(const SectionRow& section, float middle, float right) {
  KeyLine line(middle, right);
  if (!section.is_ready) line.add_text("finding what lies inside\xe2\x80\xa6");
  for (const TissueRow& tissue : section.tissues) {
    const auto [red, green, blue] = tissue.colour;
    line.add_square(IM_COL32(red, green, blue, 255));
    line.add_text(tissue.name);
  }
  if (section.is_ready) line.add_text("muscles in reds of their own");
  line.draw();
  if (!section.under_mouse.empty()) ImGui::SetTooltip("%s", section.under_mouse.c_str());
}

void draw_match_key(float middle, float right) {
  KeyLine line(middle, right);
  line.add_text("the same colour is the same point of both");
  line.draw();
}

}  // namespace

void draw_colour_keys(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  if (snapshot.cast.empty()) return;
  const ViewSettings::Look& look = controls.settings.look;
  const float line = ImGui::GetTextLineHeight() + 10;
  float middle = layout.bottom() - kKeyMargin - 0.5f * ImGui::GetTextLineHeight();
  if (look.fibres && !snapshot.fibres.empty()) {
    draw_fibre_key(middle, layout.right());
    middle -= line;
  }
  if (look.tets && snapshot.cast.front().tets > 0) {
    draw_tet_key(middle, layout.right());
    middle -= line;
  }
  if (snapshot.section) {
    draw_section_key(*snapshot.section, middle, layout.right());
    middle -= line;
  }
  const bool by_match = snapshot.match && controls.settings.compare.match == MatchView::colours;
  if (by_match) draw_match_key(middle, layout.right());
}

}  // namespace bodyopt
