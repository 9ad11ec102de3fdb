#include "proxy_viewer/platform/fonts.h"

#include <imgui_internal.h>

#include <algorithm>
#include <filesystem>

namespace bodyopt {
namespace {

constexpr float kSize = 15, kLargeSize = 30, kBuiltInSize = 13;  // points

// Of Debian's packages, the first that is there; the others lend what it lacks.
constexpr const char* kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"};

// Those of a text, without what is not drawn. What the atlas cannot hold (no UTF-8, beyond 16 bits) is the letter that
// stands for it.
std::vector<ImWchar> letters_of(const std::string& text) {
  std::vector<ImWchar> letters;
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at < end;) {
    unsigned letter = 0;
    at += std::max(1, ImTextCharFromUtf8(&letter, at, end));
    if (letter > IM_UNICODE_CODEPOINT_MAX) letter = IM_UNICODE_CODEPOINT_INVALID;
    if (letter >= ' ') letters.push_back(static_cast<ImWchar>(letter));
  }
  return letters;
}

}  // namespace

Fonts::Fonts() {
  letters_.AddRanges(ImGui::GetIO().Fonts->GetGlyphRangesDefault());
  for (const ImWchar symbol : {0x2013, 0x2026, 0x25b6, 0x25c0, 0x23f8, 0x00b0, 0x00b5}) letters_.AddChar(symbol);
}

void Fonts::set_scale(float scale) {
  if (std::exchange(scale_, scale) != scale) is_loaded_ = false;
}

void Fonts::show(const std::string& text) {
  bool is_new = false;
  for (const ImWchar letter : letters_of(text)) {
    is_new = is_new || !letters_.GetBit(letter);
    letters_.AddChar(letter);
  }
  if (is_new) new_texts_.push_back(text);
}

bool Fonts::load_new() {
  if (is_loaded_ && new_texts_.empty()) return false;
  const bool any = open_fonts();
  const std::vector<std::string> texts = std::exchange(new_texts_, {});
  const auto lacking = std::ranges::find_if(texts, [this](const auto& text) { return !has_letters_of(text); });
  if (!any && !is_loaded_) {
    problem_ = "no font was found: only Latin letters can be shown (Debian package: fonts-dejavu-core)";
  } else if (any && lacking != texts.end()) {
    problem_ = "no font here has all letters of '" + *lacking +
               "' (Debian's packages fonts-dejavu-core, fonts-noto-core, fonts-liberation and fonts-droid-fallback are "
               "looked at)";
  }
  return is_loaded_ = true;
}

// False where there are none but the one that is built in.
bool Fonts::open_fonts() {
  static constexpr ImWchar kDigits[] = {' ', '9', 0};
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  ranges_.clear();
  letters_.BuildRanges(&ranges_);
  ImFontConfig config;
  const char* first = nullptr;
  for (const char* font : kFonts) {
    if (!std::filesystem::exists(font)) continue;
    config.MergeMode = first != nullptr;
    if (atlas.AddFontFromFileTTF(font, scale_ * kSize, &config, ranges_.Data) && !first) first = font;
  }
  if (first) {
    atlas.AddFontFromFileTTF(first, scale_ * kLargeSize, nullptr, kDigits);
  } else {
    config.SizePixels = scale_ * kBuiltInSize;
    atlas.AddFontDefault(&config);
  }
  atlas.Build();
  return first != nullptr;
}

bool Fonts::has_letters_of(const std::string& text) const {
  const ImFont& font = *ImGui::GetIO().Fonts->Fonts.front();
  return std::ranges::all_of(letters_of(text), [&](ImWchar letter) {
    return letter != IM_UNICODE_CODEPOINT_INVALID && font.FindGlyphNoFallback(letter);
  });
}

ImFont* large_font() { return ImGui::GetIO().Fonts->Fonts.back(); }

}  // namespace bodyopt
