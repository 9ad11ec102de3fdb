// The viewport in this process, on a screen that nobody sees, and hands that are played: events go into the loop that
// the program runs, one turn at a time.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/gpu_fixture.h"
#include "tests/support/png_file.h"
#include "tests/viewport/small_character.h"
#include "viewport/application.h"

namespace bodyopt::testing {

inline const std::string kBarePicture = "panels off; hud off";

class QuietScreen : public viewport::Screen {
 public:
  std::vector<viewport::WindowEvent> poll(double /*seconds*/) override { return {}; }
  void set_title(const std::string& text) override { title = text; }
  std::array<std::uint32_t, 2> size() const override { return pixels; }
  void show(const draw::Canvas& canvas) override { picture = canvas.picture(); }
  GLFWwindow* handle() const override { return nullptr; }
  float scale() const override { return density; }

  std::array<std::uint32_t, 2> pixels{320, 180};
  float density = 1;
  std::string title;
  draw::Image picture;
};

class PlayedViewport {
 public:
  static constexpr double kTurn = 1.0 / 64;  // seconds

  PlayedViewport(viewport::ViewerOptions options, std::shared_ptr<const vulkan::Device> device,
                 const std::string& script)
      : options_(std::move(options)) {
    options_.commands = script;
    application_ = std::make_unique<viewport::Application>(options_, std::move(device), &screen);
    rest();
    if (!is_done()) click_messages_away();
  }

  const viewport::Controls& controls() const { return application_->session().controls; }
  const viewport::Session& session() const { return application_->session(); }
  bool is_done() const { return application_->is_done(); }

  void play(const std::vector<viewport::WindowEvent>& events) {
    application_->turn(events, kTurn);
    rest();
  }
  // Until there is nothing to do but to wait.
  void rest() {
    for (int k = 0; k < 3000 && application_->patience() == 0 && !is_done(); ++k) application_->turn({}, kTurn);
  }
  void let_pass(double seconds) {
    for (double passed = 0; passed < seconds; passed += 0.125) application_->turn({}, 0.125);
    rest();
  }
  void turn(const std::vector<viewport::WindowEvent>& events, double seconds) { application_->turn(events, seconds); }

  // "Ctrl+Left": down and up again.
  void key(const std::string& name) { play(stroke(name)); }
  void keys(const std::vector<std::string>& names) {
    for (const std::string& name : names) key(name);
  }
  void type(const std::string& ascii) {
    for (const char letter : ascii)
      application_->turn(std::vector<viewport::WindowEvent>{viewport::LetterEvent{char32_t(letter)}}, kTurn);
    rest();
  }
  // Typed at once, in one turn: pictures of half a command show nothing new.
  void prompt(const std::string& command) {
    key("Enter");
    std::vector<viewport::WindowEvent> letters;
    for (const char letter : command) letters.emplace_back(viewport::LetterEvent{char32_t(letter)});
    play(letters);
    key("Enter");
  }
  // Pixels.
  viewport::WindowEvent at(double x, double y) const {
    return viewport::CursorEvent{x / screen.pixels[0], y / screen.pixels[1]};
  }
  void drag(int button, const std::array<double, 2>& from, const std::vector<std::array<double, 2>>& over) {
    play({at(from[0], from[1])});
    play({viewport::ButtonEvent{button, true}});
    for (const auto& [x, y] : over) play({at(x, y)});
    play({viewport::ButtonEvent{button, false}});
  }
  void click(double x, double y) { play({at(x, y), viewport::ButtonEvent{0, true}, viewport::ButtonEvent{0, false}}); }
  // The mouse shall not be over them.
  void click_messages_away() {
    if (controls().messages.empty()) return;
    click(0.125 * screen.pixels[0], screen.pixels[1] - 15.0);
    play({at(300, 100)});
  }
  void resize(std::uint32_t width, std::uint32_t height) {
    screen.pixels = {width, height};
    play({viewport::SurfaceEvent{}});
  }

  static std::vector<viewport::WindowEvent> stroke(const std::string& name) {
    const auto holds = [&](const char* modifier) { return name.find(modifier) != std::string::npos; };
    return {viewport::ModifierKeysEvent{holds("Ctrl+"), holds("Shift+"), holds("Alt+")},
            viewport::KeyEvent{name, viewport::KeyAction::pressed},
            viewport::KeyEvent{name, viewport::KeyAction::released}, viewport::ModifierKeysEvent{}};
  }

  QuietScreen screen;

 private:
  viewport::ViewerOptions options_;
  std::unique_ptr<viewport::Application> application_;
};

// In a folder of its own, where screenshots go, with a small character.
class PlayedTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    device_ = std::make_shared<const vulkan::Device>(test_device(), vulkan::DeviceUse{.draws = true});
  }
  static void TearDownTestSuite() { device_.reset(); }

  PlayedTest() { std::filesystem::current_path(folder_.path()); }
  ~PlayedTest() override { std::filesystem::current_path(before_); }
  void TearDown() override { EXPECT_EQ(device_->validation_messages(), std::vector<std::string>()); }

  viewport::ViewerOptions small(const std::vector<std::string>& more = {}) const {
    viewport::ViewerOptions options;
    options.files = {small_.basis, small_.clip};
    std::ranges::copy(more, std::back_inserter(options.files));
    options.width = 320;
    options.height = 180;
    return options;
  }
  static std::unique_ptr<PlayedViewport> open(const viewport::ViewerOptions& options,
                                              const std::string& script = kBarePicture) {
    return std::make_unique<PlayedViewport>(options, device_, script);
  }
  std::unique_ptr<PlayedViewport> open() const { return open(small()); }

  // By F12, which numbers its files: without messages.
  draw::Image screenshot(PlayedViewport& viewport) {
    char name[32];
    std::snprintf(name, sizeof(name), "bodyopt.%04d.png", ++screenshots_);
    viewport.key("F12");
    EXPECT_TRUE(std::filesystem::exists(name)) << name;
    viewport.click_messages_away();
    return read_png(name);
  }
  // What the screen shows, without messages.
  static draw::Image still(PlayedViewport& viewport) {
    viewport.click_messages_away();
    return viewport.screen.picture;
  }
  // What a program without a window makes.
  static draw::Image headless(const viewport::ViewerOptions& options, const std::string& script) {
    viewport::ViewerOptions own = options;
    own.headless = true;
    own.out = "headless.png";
    own.commands = kBarePicture + "; " + script;
    viewport::Application(own, device_, nullptr).make_pictures();
    return read_png(own.out);
  }
  draw::Image headless(const std::string& script) const { return headless(small(), script); }
  // Of one session, each after the scripts before it.
  std::vector<draw::Image> headless_after_each(const std::vector<std::string>& scripts) const {
    viewport::ViewerOptions options = small();
    options.headless = true;
    options.commands = kBarePicture;
    const auto name = [](std::size_t k) { return "each" + std::to_string(k) + ".png"; };
    for (std::size_t k = 0; k < scripts.size(); ++k) options.commands += "; " + scripts[k] + "; screenshot " + name(k);
    viewport::Application(options, device_, nullptr).make_pictures();
    std::vector<draw::Image> images;
    for (std::size_t k = 0; k < scripts.size(); ++k) images.push_back(read_png(name(k)));
    return images;
  }

  static inline std::shared_ptr<const vulkan::Device> device_;
  const std::filesystem::path before_ = std::filesystem::current_path();
  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  int screenshots_ = 0;
};

}  // namespace bodyopt::testing
