#include "viewport/platform/gui.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <filesystem>
#include <ranges>
#include <utility>

#include "runtime/vulkan/commands.h"
#include "viewport/platform/window.h"

namespace bodyopt::viewport {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr float kSize = 15, kLargeSize = 30, kBuiltInSize = 13;  // points

// The first that is there, of Debian's packages, is the font; the others lend what it lacks.
constexpr const char* kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"};

// Returns the letters of a text that are drawn. What the atlas cannot hold (no UTF-8, beyond 16 bits) is replaced.
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

ImVec4 grey(float value, float alpha = 1) { return {value, value, value * 1.03f, alpha}; }

// Dark, quiet, without frames: the character is what is looked at.
void set_style() {
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = style.FrameRounding = style.GrabRounding = style.PopupRounding = 4;
  style.WindowBorderSize = style.FrameBorderSize = 0;
  style.WindowPadding = {10, 8};
  style.FramePadding = {7, 3};
  style.ItemSpacing = {7, 5};
  style.ScrollbarSize = 10;
  style.GrabMinSize = 9;
  ImVec4* const c = style.Colors;
  const ImVec4 accent{0.95f, 0.62f, 0.25f, 1};
  c[ImGuiCol_Text] = grey(0.86f);
  c[ImGuiCol_TextDisabled] = grey(0.48f);
  c[ImGuiCol_WindowBg] = grey(0.085f, 0.96f);
  c[ImGuiCol_PopupBg] = grey(0.10f, 0.98f);
  c[ImGuiCol_MenuBarBg] = grey(0.085f, 0.96f);
  c[ImGuiCol_FrameBg] = grey(0.17f);
  c[ImGuiCol_FrameBgHovered] = grey(0.22f);
  c[ImGuiCol_FrameBgActive] = grey(0.26f);
  c[ImGuiCol_Button] = grey(0.19f);
  c[ImGuiCol_ButtonHovered] = grey(0.27f);
  c[ImGuiCol_ButtonActive] = grey(0.33f);
  c[ImGuiCol_Header] = grey(0.16f);
  c[ImGuiCol_HeaderHovered] = grey(0.22f);
  c[ImGuiCol_HeaderActive] = grey(0.26f);
  c[ImGuiCol_Separator] = grey(0.2f);
  c[ImGuiCol_CheckMark] = accent;
  c[ImGuiCol_SliderGrab] = {accent.x, accent.y, accent.z, 0.45f};  // its number is read through it
  c[ImGuiCol_SliderGrabActive] = {1, 0.75f, 0.42f, 1};
  c[ImGuiCol_PlotLines] = c[ImGuiCol_PlotHistogram] = accent;
  c[ImGuiCol_ScrollbarBg] = grey(0.08f, 0.4f);
  c[ImGuiCol_ScrollbarGrab] = grey(0.25f);
}

// Returns the cursor over text fields and edges; others are arrows.
int standard_cursor(ImGuiMouseCursor cursor) {
  if (cursor == ImGuiMouseCursor_TextInput) return GLFW_IBEAM_CURSOR;
  if (cursor == ImGuiMouseCursor_ResizeEW) return GLFW_HRESIZE_CURSOR;
  if (cursor == ImGuiMouseCursor_ResizeNS) return GLFW_VRESIZE_CURSOR;
  return cursor == ImGuiMouseCursor_Hand ? GLFW_HAND_CURSOR : GLFW_ARROW_CURSOR;
}

}  // namespace

Gui::Gui() : before_(ImGui::GetCurrentContext()), context_(ImGui::CreateContext()) {
  IMGUI_CHECKVERSION();
  ImGui::SetCurrentContext(context_);
  std::ranges::copy(std::views::iota(0, int{ImGuiKey_COUNT}), ImGui::GetIO().KeyMap);
  ImGui::GetIO().IniFilename = nullptr;  // settings are kept in the state file
  ImGui::GetIO().LogFilename = nullptr;
  // The Vulkan backend can, and long lists have more corners than 16 bits count.
  ImGui::GetIO().BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  ImGui::GetIO().ConfigInputTextCursorBlink = false;  // nothing is drawn while nothing happens
  set_style();
  fonts_.emplace();
}

Gui::~Gui() {
  stop_backend();
  ImGui::DestroyContext(context_);
  ImGui::SetCurrentContext(before_);
}

void Gui::attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window) {
  device_ = &device;
  pass_ = pass;
  window_ = window;
  if (!window) return;
  ImGuiIO& io = ImGui::GetIO();
  io.ClipboardUserData = window;
  io.SetClipboardTextFn = [](void* of, const char* text) {
    glfwSetClipboardString(static_cast<GLFWwindow*>(of), text);
  };
  io.GetClipboardTextFn = [](void* of) { return glfwGetClipboardString(static_cast<GLFWwindow*>(of)); };
}

void Gui::hear(const WindowEvent& event) {
  ImGuiIO& io = ImGui::GetIO();
  if (const auto* key = std::get_if<KeyEvent>(&event)) hear_key(*key);
  if (const auto* button = std::get_if<ButtonEvent>(&event)) hear_button(*button);
  if (const auto* letter = std::get_if<LetterEvent>(&event)) io.AddInputCharacter(letter->letter);
  if (const auto* cursor = std::get_if<CursorEvent>(&event)) cursor_ = *cursor;
  if (const auto* wheel = std::get_if<WheelEvent>(&event)) {
    io.MouseWheelH += static_cast<float>(wheel->right);
    io.MouseWheel += static_cast<float>(wheel->up);
  }
  if (const auto* held = std::get_if<ModifierKeysEvent>(&event)) {
    io.KeyCtrl = held->control;
    io.KeyShift = held->shift;
    io.KeyAlt = held->alt;
  }
}

void Gui::hear_key(const KeyEvent& event) {
  const std::optional<int> key = imgui_key(bare_key(event.name));
  if (!key || event.action == KeyAction::repeated) return;
  const bool down = event.action == KeyAction::pressed;
  if (down) ImGui::GetIO().KeysDownDuration[*key] = -1;  // also right after it was let go
  keys_.at(static_cast<std::size_t>(*key)).hear(down, ImGui::GetIO().KeysDown[*key]);
}

void Gui::hear_button(const ButtonEvent& event) {
  if (event.button < 0 || static_cast<std::size_t>(event.button) >= buttons_.size()) return;
  buttons_[static_cast<std::size_t>(event.button)].hear(event.down, ImGui::GetIO().MouseDown[event.button]);
}

// Releases what went up again since the last picture, now that a picture has it down.
void Gui::let_go() {
  const auto let_go_of = [](auto& presses, bool* is_down) {
    for (Press& press : presses) {
      if (std::exchange(press, {}).released) *is_down = false;
      ++is_down;
    }
  };
  let_go_of(keys_, ImGui::GetIO().KeysDown);
  let_go_of(buttons_, ImGui::GetIO().MouseDown);
}

void Gui::shape_cursor() {
  const int shape = standard_cursor(ImGui::GetMouseCursor());
  GLFWcursor*& cursor = cursors_.at(static_cast<std::size_t>(shape - GLFW_ARROW_CURSOR));
  if (!cursor) cursor = glfwCreateStandardCursor(shape);
  glfwSetCursor(window_, cursor);
}

// Anew for every atlas: a backend takes one in its life.
void Gui::start_backend() {
  stop_backend();
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 16};
  auto pool_info = structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool_info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool_info.maxSets = 16;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(device_->handle(), &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = {device_->handle(), pool};

  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device_->instance();
  info.PhysicalDevice = device_->physical();
  info.Device = device_->handle();
  info.QueueFamily = device_->queue_family();
  info.Queue = device_->queue();
  info.PipelineCache = device_->pipeline_cache();
  info.DescriptorPool = pool;
  info.MinImageCount = info.ImageCount = 2;  // each picture is waited for
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { check(result, "a call of Dear ImGui"); };
  has_backend_ = ImGui_ImplVulkan_Init(&info, pass_);
  vulkan::Commands commands(*device_);
  commands.begin();
  ImGui_ImplVulkan_CreateFontsTexture(commands.handle());
  commands.end();
  commands.run();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Gui::stop_backend() {
  if (has_backend_) ImGui_ImplVulkan_Shutdown();
  has_backend_ = false;
}

void Gui::begin(std::uint32_t width, std::uint32_t height, double seconds, float scale) {
  fonts_->set_scale(scale);
  const bool has_new_letters = fonts_->load_new();
  if (device_ && (has_new_letters || !has_backend_)) start_backend();
  if (has_backend_) ImGui_ImplVulkan_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  const ImVec2 size{static_cast<float>(width) / scale, static_cast<float>(height) / scale};
  if (cursor_) io.MousePos = {static_cast<float>(cursor_->x) * size.x, static_cast<float>(cursor_->y) * size.y};
  io.DisplaySize = size;
  io.DisplayFramebufferScale = {scale, scale};  // to the picture's pixels
  io.FontGlobalScale = 1 / scale;               // of letters that are made in pixels
  io.DeltaTime = static_cast<float>(std::max(1e-4, seconds));
  ImGui::NewFrame();
  let_go();
}

void Gui::end() {
  ImGui::Render();
  if (window_) shape_cursor();
}

bool Gui::hides_window() const {
  return std::ranges::any_of(context_->Windows, [](const ImGuiWindow* window) {
    const bool is_inside = (window->Flags & ImGuiWindowFlags_ChildWindow) && !(window->Flags & ImGuiWindowFlags_Popup);
    return window->Active && window->Hidden && !is_inside;
  });
}

void Gui::record(VkCommandBuffer commands) const { ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands); }

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

void Fonts::show_pictures(std::vector<draw::Image> pictures) {
  pictures_ = std::move(pictures);
  is_loaded_ = false;
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
  for (const draw::Image& picture : pictures_) {
    atlas.AddCustomRectRegular(static_cast<int>(picture.width), static_cast<int>(picture.height));
  }
  atlas.Build();
  copy_pictures(atlas);
  return first != nullptr;
}

void Fonts::copy_pictures(ImFontAtlas& atlas) const {
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;
  if (!pictures_.empty()) atlas.GetTexDataAsRGBA32(&pixels, &width, &height);
  for (std::size_t k = 0; k < pictures_.size(); ++k) {
    const ImFontAtlasCustomRect& at = *atlas.GetCustomRectByIndex(static_cast<int>(k));
    const std::size_t row = 4 * std::size_t{at.Width};
    for (std::size_t y = 0; y < at.Height; ++y) {
      const std::size_t to = 4 * ((at.Y + y) * static_cast<std::size_t>(width) + at.X);
      std::copy_n(pictures_[k].rgba.data() + y * row, row, pixels + to);
    }
  }
}

bool Fonts::has_letters_of(const std::string& text) const {
  const ImFont& font = *ImGui::GetIO().Fonts->Fonts.front();
  return std::ranges::all_of(letters_of(text), [&](ImWchar letter) {
    return letter != IM_UNICODE_CODEPOINT_INVALID && font.FindGlyphNoFallback(letter);
  });
}

void add_picture(ImDrawList& list, int number, const ImVec2& from, const ImVec2& to) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  ImVec2 low, high;
  atlas.CalcCustomRectUV(atlas.GetCustomRectByIndex(number), &low, &high);
  list.AddImageRounded(atlas.TexID, from, to, low, high, IM_COL32_WHITE, 4);
}

bool takes_text() { return ImGui::GetIO().WantTextInput || ImGui::GetCurrentContext()->WantTextInputNextFrame > 0; }

ImFont* large_font() { return ImGui::GetIO().Fonts->Fonts.back(); }

}  // namespace bodyopt::viewport
