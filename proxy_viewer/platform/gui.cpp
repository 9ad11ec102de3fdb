#include "proxy_viewer/platform/gui.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>

#include "runtime/vulkan/commands.h"

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

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

}  // namespace

Gui::Gui() {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // settings are kept in the state file
  ImGui::GetIO().LogFilename = nullptr;
  // As the Vulkan backend can: long lists have more corners than 16 bits count.
  ImGui::GetIO().BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  ImGui::GetIO().ConfigInputTextCursorBlink = false;  // nothing is drawn while nothing happens
  set_style();
  fonts_.emplace();
}

Gui::~Gui() {
  stop_backend();
  if (window_) ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

void Gui::attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window) {
  device_ = &device;
  pass_ = pass;
  if (!window || !ImGui_ImplGlfw_InitForVulkan(window, true)) return;
  window_ = window;
  glfwSetInputMode(window, GLFW_STICKY_KEYS, GLFW_TRUE);
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

void Gui::begin(std::uint32_t width, std::uint32_t height, double seconds) {
  const bool has_new_letters = fonts_->load_new();
  if (device_ && (has_new_letters || !has_backend_)) start_backend();
  if (has_backend_) ImGui_ImplVulkan_NewFrame();
  ImGuiIO& io = ImGui::GetIO();
  if (window_) {
    ImGui_ImplGlfw_NewFrame();
    // Also those that went up again since the last picture: keys are sticky.
    for (const int key : io.KeyMap) {
      if (key >= 0) io.KeysDown[key] = glfwGetKey(window_, key) == GLFW_PRESS;
    }
  }
  const ImVec2 size{static_cast<float>(width), static_cast<float>(height)};
  // The window's coordinates, which need not be the picture's pixels: on fine screens, and of very large windows.
  if (window_ && ImGui::IsMousePosValid()) {
    io.MousePos.x *= size.x / std::max(1.0f, io.DisplaySize.x);
    io.MousePos.y *= size.y / std::max(1.0f, io.DisplaySize.y);
  }
  io.DisplaySize = size;
  io.DisplayFramebufferScale = {1, 1};  // the picture's pixels
  io.DeltaTime = static_cast<float>(std::max(1e-4, seconds));
  ImGui::NewFrame();
}

void Gui::end() { ImGui::Render(); }

void Gui::record(VkCommandBuffer commands) const { ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands); }

}  // namespace bodyopt
