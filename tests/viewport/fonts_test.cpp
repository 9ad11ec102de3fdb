#include <gtest/gtest.h>

#include <filesystem>

#include "viewport/platform/gui.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

const std::string kRussian = "\xd1\x82\xd0\xb0\xd0\xbd\xd0\xb5\xd1\x86";  // U+0442 430 43d 435 446
const std::string kGreek = "\xcf\x87\xce\xbf\xcf\x81\xcf\x8c\xcf\x82";    // U+03c7 3bf 3c1 3cc 3c2
const std::string kJapanese = "\xe8\xb8\x8a\xe3\x82\x8a";                 // U+8e0a 308a
const std::string kDancer = "\xf0\x9f\x95\xba";                           // U+1f57a, beyond 16 bits
const std::string kPrivate = "\xee\x80\x81";                              // U+10000, U+e001
constexpr const char* kDejaVu = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr const char* kDroid = "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf";

class FontsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kDejaVu)) GTEST_SKIP() << kDejaVu << " is not installed";
    draw();
    EXPECT_EQ(gui_.fonts().take_problem(), std::nullopt);
  }
  void draw() {
    gui_.begin(200, 100, 0.01);
    gui_.end();
  }
  static bool has(ImWchar letter) { return ImGui::GetIO().Fonts->Fonts.front()->FindGlyphNoFallback(letter); }
  static bool has_latin() { return has('A') && has('z') && has(0xe9) && has(0x25b6); }

  Gui gui_;
};

TEST_F(FontsTest, LettersOfOtherScriptsAreLoadedWhenTheyAreShown) {
  EXPECT_TRUE(has_latin());
  EXPECT_FALSE(has(0x442));
  gui_.fonts().show(kRussian);
  EXPECT_FALSE(has(0x442)) << "between pictures";
  draw();
  for (const ImWchar letter : {0x442, 0x430, 0x43d, 0x435, 0x446}) EXPECT_TRUE(has(letter)) << letter;
  gui_.fonts().show(kGreek);
  draw();
  for (const ImWchar letter : {0x442, 0x3c7, 0x3bf, 0x3c1, 0x3cc, 0x3c2}) EXPECT_TRUE(has(letter)) << letter;
  EXPECT_TRUE(has_latin());
  EXPECT_GT(large_font()->FontSize, ImGui::GetIO().Fonts->Fonts.front()->FontSize);
  EXPECT_EQ(gui_.fonts().take_problem(), std::nullopt);
}

TEST_F(FontsTest, AnotherFontLendsWhatTheFirstLacks) {
  if (!std::filesystem::exists(kDroid)) GTEST_SKIP() << kDroid << " is not installed";
  gui_.fonts().show(kJapanese);
  draw();
  EXPECT_TRUE(has(0x8e0a) && has(0x308a) && has_latin());
  EXPECT_EQ(gui_.fonts().take_problem(), std::nullopt);
}

TEST_F(FontsTest, AreLeftAsTheyAreWhereNothingIsNew) {
  gui_.fonts().show(kRussian);
  EXPECT_TRUE(gui_.fonts().load_new());
  for (const std::string& text : {kRussian, std::string("a name\n\t\x01"), std::string()}) {
    gui_.fonts().show(text);
    EXPECT_FALSE(gui_.fonts().load_new()) << text;
  }
}

TEST_F(FontsTest, WhatNoFontHasIsSaidOnceWithItsText) {
  for (const std::string& letter : {kPrivate, kDancer}) {
    const std::string text = "clip " + letter;
    gui_.fonts().show(text);
    draw();
    const std::optional<std::string> problem = gui_.fonts().take_problem();
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->find("'" + text + "'"), std::string::npos) << *problem;
    gui_.fonts().show(*problem);
    EXPECT_FALSE(gui_.fonts().load_new());
    EXPECT_EQ(gui_.fonts().take_problem(), std::nullopt);
  }
}

}  // namespace
}  // namespace bodyopt::testing
