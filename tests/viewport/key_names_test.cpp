#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include "viewport/commands/commands.h"
#include "viewport/platform/window.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

TEST(KeyNames, OfLettersAreThoseOfTheUsersLayout) {
  EXPECT_EQ(key_name(GLFW_KEY_W, "w", 0), "W");
  EXPECT_EQ(key_name(GLFW_KEY_Q, "a", 0), "A");          // French
  EXPECT_EQ(key_name(GLFW_KEY_SEMICOLON, "m", 0), "M");  // French
}

TEST(KeyNames, OfOtherScriptsAndOfDigitsAreThoseOfAUsKeyboard) {
  EXPECT_EQ(key_name(GLFW_KEY_W, "\xd1\x86", 0), "W");  // Russian
  EXPECT_EQ(key_name(GLFW_KEY_W, "\xcf\x82", 0), "W");  // Greek
  EXPECT_EQ(key_name(GLFW_KEY_1, "&", 0), "1");         // French
  EXPECT_EQ(key_name(GLFW_KEY_2, "\xc3\xa9", 0), "2");  // French
  EXPECT_EQ(key_name(GLFW_KEY_KP_7, "7", 0), "7");
}

TEST(KeyNames, HaveWhatIsHeldWithThem) {
  EXPECT_EQ(key_name(GLFW_KEY_LEFT, "", GLFW_MOD_SHIFT), "Shift+Left");
  EXPECT_EQ(key_name(GLFW_KEY_Q, "q", GLFW_MOD_CONTROL), "Ctrl+Q");
  EXPECT_EQ(key_name(GLFW_KEY_F12, "", GLFW_MOD_CONTROL | GLFW_MOD_ALT | GLFW_MOD_SHIFT), "Ctrl+Alt+Shift+F12");
  EXPECT_EQ(key_name(GLFW_KEY_LEFT_SHIFT, "", GLFW_MOD_SHIFT), "");
}

// With a keyboard that prints no letter that the commands name.
TEST(KeyNames, ReachEveryCommandOnARussianKeyboard) {
  for (const Command& command : commands()) {
    const std::string key = command.key;
    const std::string bare = key.substr(key.rfind('+') + 1);
    if (bare.size() != 1) continue;
    const int shift = key.find("Shift+") != key.npos ? GLFW_MOD_SHIFT : 0;
    const int control = key.find("Ctrl+") != key.npos ? GLFW_MOD_CONTROL : 0,
              alt = key.find("Alt+") != key.npos ? GLFW_MOD_ALT : 0;
    EXPECT_EQ(key_name(bare[0], "\xd1\x8f", shift | control | alt), key);
  }
}

}  // namespace
}  // namespace bodyopt::testing
