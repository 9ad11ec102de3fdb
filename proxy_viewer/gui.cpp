#include "proxy_viewer/gui.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "runtime/vulkan/commands.h"

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr float kFontSize = 15, kLargeFontSize = 30;

// Fonts of Debian's packages, the first that is there; the others lend what it lacks.
constexpr const char* kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                  "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                                  "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf"};

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
  c[ImGuiCol_SliderGrab] = c[ImGuiCol_CheckMark] = accent;
  c[ImGuiCol_SliderGrabActive] = {1, 0.75f, 0.42f, 1};
  c[ImGuiCol_PlotLines] = c[ImGuiCol_PlotHistogram] = accent;
  c[ImGuiCol_ScrollbarBg] = grey(0.08f, 0.4f);
  c[ImGuiCol_ScrollbarGrab] = grey(0.25f);
}

}  // namespace

Gui::Gui(const std::vector<std::string>& texts) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // settings are kept in the state file
  ImGui::GetIO().LogFilename = nullptr;
  // As the Vulkan backend can: long lists have more corners than 16 bits count.
  ImGui::GetIO().BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  set_style();
  load_fonts(texts);
}

Gui::~Gui() {
  if (has_device_) ImGui_ImplVulkan_Shutdown();
  if (has_window_) ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

// Only the characters that are needed: the atlas stays small, and the start quick.
void Gui::load_fonts(const std::vector<std::string>& texts) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  ImFontGlyphRangesBuilder builder;
  builder.AddRanges(atlas.GetGlyphRangesDefault());
  for (const ImWchar symbol : {0x2013, 0x2026, 0x25b6, 0x25c0, 0x23f8, 0x00b0, 0x00b5}) builder.AddChar(symbol);
  for (const std::string& text : texts) builder.AddText(text.c_str());
  static ImVector<ImWchar> ranges;  // the atlas reads them when it is built
  ranges.clear();
  builder.BuildRanges(&ranges);
  static constexpr ImWchar kDigits[] = {' ', '9', 0};
  ImFontConfig config;
  const char* first = nullptr;
  for (const char* font : kFonts) {
    if (!std::filesystem::exists(font)) continue;
    config.MergeMode = first != nullptr;
    if (atlas.AddFontFromFileTTF(font, kFontSize, &config, ranges.Data) && !first) first = font;
  }
  if (first) {
    atlas.AddFontFromFileTTF(first, kLargeFontSize, nullptr, kDigits);
  } else {
    atlas.AddFontDefault();
    problem_ = "no font was found: only Latin letters can be shown (Debian package: fonts-dejavu-core)";
  }
  atlas.Build();
}

ImFont* large_font() { return ImGui::GetIO().Fonts->Fonts.back(); }

void Gui::attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 16};
  auto pool_info = structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  pool_info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  pool_info.maxSets = 16;
  pool_info.poolSizeCount = 1;
  pool_info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(device.handle(), &pool_info, nullptr, &pool), "vkCreateDescriptorPool");
  pool_ = {device.handle(), pool};
  if (window) has_window_ = ImGui_ImplGlfw_InitForVulkan(window, true);

  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device.instance();
  info.PhysicalDevice = device.physical();
  info.Device = device.handle();
  info.QueueFamily = device.queue_family();
  info.Queue = device.queue();
  info.DescriptorPool = pool;
  info.MinImageCount = info.ImageCount = 2;  // each picture is waited for
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { check(result, "a call of Dear ImGui"); };
  has_device_ = ImGui_ImplVulkan_Init(&info, pass);
  vulkan::Commands commands(device);
  commands.begin();
  ImGui_ImplVulkan_CreateFontsTexture(commands.handle());
  commands.end();
  commands.run();
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

void Gui::begin(std::uint32_t width, std::uint32_t height, double seconds) {
  if (has_device_) ImGui_ImplVulkan_NewFrame();
  if (has_window_) ImGui_ImplGlfw_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
  io.DisplayFramebufferScale = {1, 1};  // the picture's pixels
  io.DeltaTime = static_cast<float>(std::max(1e-4, seconds));
  ImGui::NewFrame();
}

void Gui::end() { ImGui::Render(); }

void Gui::record(VkCommandBuffer commands) const { ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands); }

}  // namespace bodyopt
