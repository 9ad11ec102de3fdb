// The letters of the panels, from the fonts that are installed here: those that were shown so far. The atlas stays
// small, and the start quick.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bodyopt {

class Fonts {
 public:
  Fonts();

  // Pixels a point: letters are made anew for another.
  void set_scale(float scale);
  // A text of any script that panels are going to show.
  void show(const std::string& text);
  // Loads the letters that are new, between two pictures; false: there are none, and the atlas is as it was.
  bool load_new();
  // What no font here has, once.
  std::optional<std::string> take_problem() { return std::exchange(problem_, std::nullopt); }

 private:
  bool open_fonts();
  bool has_letters_of(const std::string& text) const;

  ImFontGlyphRangesBuilder letters_;
  ImVector<ImWchar> ranges_;            // of the letters: the atlas keeps a pointer
  std::vector<std::string> new_texts_;  // those that have new letters
  bool is_loaded_ = false;
  float scale_ = 1;
  std::optional<std::string> problem_;
};

// Of digits alone.
ImFont* large_font();

}  // namespace bodyopt
