// Legends at the bottom of the picture, a line each: colours of a heat map, of muscle fibres, of cut tetrahedra, of a
// section and of a match. The tissue under the mouse is named, too.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "draw/colours.h"
#include "runtime/core/text.h"
#include "viewport/panels/panels.h"
#include "viewport/scene/cut_tets.h"
#include "viewport/state/strain_colour.h"

namespace bodyopt::viewport {
namespace {

constexpr float kKeyMargin = 14, kKeyPadding = 8, kKeyGap = 7, kKeyBarWidth = 120, kSquare = 11;
constexpr int kKeySteps = 40;

// Words and colours in a line, from the left; a line without room is left out.
class KeyLine {
 public:
  KeyLine& add_text(const std::string& text, ImU32 colour = IM_COL32(225, 225, 228, 255)) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    texts_.push_back({x_, text, colour});
    x_ += size.x + kKeyGap;
    return *this;
  }
  void add_square(ImU32 colour) {
    fields_.push_back({x_, kSquare, colour, colour});
    x_ += kSquare + kKeyGap;
  }
  // `colour_at`: of 0 to 1.
  template <typename ColourAt>
  KeyLine& add_bar(const ColourAt& colour_at) {
    constexpr float kStep = kKeyBarWidth / kKeySteps;
    const auto colour = [&](int k) { return colour_at(static_cast<float>(k) / kKeySteps); };
    for (int k = 0; k < kKeySteps; ++k) {
      fields_.push_back({x_ + static_cast<float>(k) * kStep, kStep, colour(k), colour(k + 1)});
    }
    x_ += kKeyBarWidth + kKeyGap;
    return *this;
  }
  float end() const { return x_ - kKeyGap + kKeyPadding; }

  // `middle`: height of its middle.
  void draw(float middle, float right) const {
    const float half = 0.5f * ImGui::GetTextLineHeight();
    if (end() > right) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled({kKeyMargin - kKeyPadding, middle - half - 3}, {end(), middle + half + 3},
                       IM_COL32(20, 20, 22, 170), 4);
    for (const Field& f : fields_) {
      list.AddRectFilledMultiColor({f.left, middle - 0.5f * kSquare}, {f.left + f.width, middle + 0.5f * kSquare},
                                   f.from, f.to, f.to, f.from);
    }
    for (const Text& text : texts_) list.AddText({text.left, middle - half}, text.colour, text.words.c_str());
  }

 private:
  struct Field {
    float left, width;
    ImU32 from, to;
  };

  struct Text {
    float left;
    std::string words;
    ImU32 colour;
  };

  float x_ = kKeyMargin;
  std::vector<Field> fields_;
  std::vector<Text> texts_;
};

KeyLine fibre_key() {
  const std::string percent = formatted("%.0f %%", 100 * static_cast<double>(kFullStrain));
  return KeyLine()
      .add_text("shortened " + percent)
      .add_bar([](float share) { return strain_colour(kFullStrain * (2 * share - 1)); })
      .add_text("stretched " + percent);
}

KeyLine tet_key() {
  KeyLine line;
  for (const auto& [kind, name] :
       {std::pair(TetKind::held, "held"), {TetKind::muscle, "muscle"}, {TetKind::fat, "all else"}}) {
    line.add_square(opaque(cut_colour(kind)));
    line.add_text(name);
  }
  return line;
}

KeyLine section_key(const SectionRow& section) {
  KeyLine line;
  if (!section.is_ready) line.add_text("finding what lies inside\xe2\x80\xa6");
  for (const TissueRow& tissue : section.tissues) {
    const auto [red, green, blue] = tissue.colour;
    line.add_square(IM_COL32(red, green, blue, 255));
    line.add_text(tissue.name);
  }
  if (section.is_ready) line.add_text("muscles in reds of their own");
  return line;
}

// The heat map's legend, and the largest distance of the frame.

constexpr float kBarWidth = 14, kBarHeight = 176, kBarMargin = 16, kBarPadding = 8;
constexpr ImU32 kBehind = IM_COL32(20, 20, 22, 150);  // text over a bright character
constexpr int kLabels = 5, kSteps = 44;

struct Heat {
  const char* title;
  double most;     // of the frame that is shown, mm; not a number where it was not measured
  double hottest;  // at the top of the bar
};

// Returns the heat that colours the lead: none, or the first of several.
std::optional<Heat> heat_of(const Snapshot& snapshot, const Controls& controls) {
  const shots::ViewSettings::Compare& compare = controls.settings.compare;
  if (snapshot.match) {
    if (compare.match == shots::MatchView::colours) return std::nullopt;  // which are no heat
    return Heat{"unsure (0: the same)", NAN, 1};
  }
  if (compare.coverage && snapshot.knows_coverage) {
    return Heat{"expected error, mm", snapshot.most_expected_mm.value_or(NAN), controls.heat_mm()};
  }
  if (snapshot.compared.empty() || !(compare.heat || compare.activation)) return std::nullopt;
  const auto index = static_cast<std::size_t>(controls.playback.frame() - snapshot.first_frame);
  const ErrorRow error = index < snapshot.errors.size() ? snapshot.errors[index] : ErrorRow{};
  return Heat{compare.activation ? "learned, mm" : "distance, mm", static_cast<double>(error.max), controls.heat_mm()};
}

// Explains why colours that are asked for are lacking; empty: they are there.
std::string why_no_heat(const Snapshot& snapshot, const Controls& controls) {
  const shots::ViewSettings::Compare& compare = controls.settings.compare;
  if (compare.coverage && !snapshot.knows_coverage) return "no expected error: the basis was trained without shapes";
  const bool lacks = compare.heat && snapshot.compared.empty() && !compare.coverage && !snapshot.match;
  return lacks ? "no heat: nothing is compared, as by 'compare ddm'" : "";
}

// Three digits, or as many as it has before the point.
std::string millimetres(double value) { return formatted(std::abs(value) < 100 ? "%.3g" : "%.0f", value); }

// Ends at `right`; its middle is at y.
void draw_text(ImDrawList& list, float right, float y, ImU32 colour, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list.AddText({right - size.x, y - 0.5f * size.y}, colour, text.c_str());
}

std::string describe_largest(const Heat& heat) {
  return std::isfinite(heat.most) ? "largest " + millimetres(heat.most) + " mm" : "";
}

float widest_text(const Heat& heat, const std::string& largest) {
  return std::max(ImGui::CalcTextSize(heat.title).x, ImGui::CalcTextSize(largest.c_str()).x);
}

// The bar, lying; what has no room is left out.
KeyLine heat_key(const Heat& heat, float right) {
  const std::string largest = describe_largest(heat);
  for (const bool is_whole : {true, false}) {
    KeyLine line;
    if (is_whole) line.add_text(heat.title);
    line.add_text("0").add_bar([](float share) { return opaque(draw::heat_colour(share)); });
    line.add_text(millimetres(heat.hottest));
    if (is_whole && !largest.empty()) line.add_text(largest, kAccent);
    if (!is_whole || line.end() <= right) return line;
  }
  return {};
}

constexpr float kKeyLine = 10;  // more than the height of the text

// The lines from the lowest upwards.
std::vector<KeyLine> key_lines(const Snapshot& snapshot, const Controls& controls, bool bar_lies, float right) {
  std::vector<KeyLine> lines;
  if (snapshot.cast.empty()) return lines;
  const shots::ViewSettings::Look& look = controls.settings.look;
  const std::optional<Heat> heat = heat_of(snapshot, controls);
  if (heat && bar_lies) lines.push_back(heat_key(*heat, right));
  if (const std::string why = why_no_heat(snapshot, controls); !why.empty()) {
    lines.push_back(KeyLine().add_text(why, kAccent));
  }
  if (look.fibres && !snapshot.fibres.empty()) lines.push_back(fibre_key());
  if (look.tets && snapshot.cast.front().tets > 0) lines.push_back(tet_key());
  if (snapshot.section) lines.push_back(section_key(*snapshot.section));
  const bool by_match = snapshot.match && controls.settings.compare.match == shots::MatchView::colours;
  if (by_match) lines.push_back(KeyLine().add_text("the same colour is the same point of both"));
  return lines;
}

}  // namespace

float colour_keys_height(const Snapshot& snapshot, const Controls& controls, bool bar_lies, float most) {
  const float line = ImGui::GetTextLineHeight() + kKeyLine;
  const auto wanted = static_cast<float>(key_lines(snapshot, controls, bar_lies, 0).size());
  const float lines = std::min(wanted, std::floor((most - kKeyMargin) / line));
  return lines > 0 ? kKeyMargin + lines * line : 0;
}

void draw_colour_keys(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  const float line = ImGui::GetTextLineHeight() + kKeyLine;
  float middle = layout.bottom() - kKeyMargin - 0.5f * ImGui::GetTextLineHeight();
  const float highest = layout.bottom() - layout.overlaid.bottom;
  for (const KeyLine& key : key_lines(snapshot, controls, layout.overlaid.right == 0, layout.right())) {
    if (middle - 0.5f * line < highest - 1) break;
    key.draw(middle, layout.right());
    middle -= line;
  }
  if (snapshot.section && !snapshot.section->under_mouse.empty()) {
    ImGui::SetTooltip("%s", snapshot.section->under_mouse.c_str());
  }
}

float colour_bar_width(const Snapshot& snapshot, const Controls& controls) {
  // The width does not follow the frame's largest: the camera would be framed again from frame to frame.
  static const std::string kUsualLargest = "largest 88.8 mm";
  const std::optional<Heat> heat = heat_of(snapshot, controls);
  return heat ? kBarMargin + widest_text(*heat, kUsualLargest) + kBarPadding : 0;
}

void draw_colour_bar(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  const std::optional<Heat> heat = heat_of(snapshot, controls);
  if (!heat || layout.overlaid.right == 0) return;
  const float line = ImGui::GetTextLineHeight();
  const float height = std::min(kBarHeight, layout.bottom() - layout.menu - 4 * line - 2 * kBarMargin);
  const float right = layout.right() - kBarMargin, bottom = layout.bottom() - kBarMargin - 0.5f * line;
  const float left = right - kBarWidth, top = bottom - height;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const std::string largest = describe_largest(*heat);
  list.AddRectFilled({right - widest_text(*heat, largest) - kBarPadding, top - 3.1f * line},
                     {right + 12, bottom + line}, kBehind, 6);
  for (int k = 0; k < kSteps; ++k) {
    const float low = static_cast<float>(k) / kSteps, high = static_cast<float>(k + 1) / kSteps;
    const ImU32 a = opaque(draw::heat_colour(low)), b = opaque(draw::heat_colour(high));
    list.AddRectFilledMultiColor({left, bottom - high * height}, {right, bottom - low * height}, b, b, a, a);
  }
  for (int k = 0; k < kLabels; ++k) {
    const float share = static_cast<float>(k) / (kLabels - 1);
    draw_text(list, left - 7, bottom - share * height, ImGui::GetColorU32(ImGuiCol_Text),
              millimetres(static_cast<double>(share) * heat->hottest));
  }
  draw_text(list, right, top - 1.3f * line, ImGui::GetColorU32(ImGuiCol_Text), heat->title);
  if (largest.empty()) return;
  const float share = static_cast<float>(std::min(1.0, heat->most / heat->hottest));
  list.AddTriangleFilled({right + 8, bottom - share * height - 4}, {right + 8, bottom - share * height + 4},
                         {right + 1, bottom - share * height}, kAccent);
  draw_text(list, right, top - 2.4f * line, kAccent, largest);
}

}  // namespace bodyopt::viewport
