#include "viewport/platform/window.h"

#include <GLFW/glfw3.h>
#include <X11/Xlib.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <iostream>
#include <iterator>
#include <string_view>
#include <utility>

#include "draw/graphics_pipeline.h"
#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"
#include "runtime/vulkan/make.h"

namespace bodyopt::viewport {

using vulkan::check;
using vulkan::structure;

namespace {

struct Named {
  int key;
  const char* name;
  ImGuiKey imgui;
};
constexpr Named kNamed[] = {{GLFW_KEY_SPACE, "Space", ImGuiKey_Space},
                            {GLFW_KEY_LEFT, "Left", ImGuiKey_LeftArrow},
                            {GLFW_KEY_RIGHT, "Right", ImGuiKey_RightArrow},
                            {GLFW_KEY_UP, "Up", ImGuiKey_UpArrow},
                            {GLFW_KEY_DOWN, "Down", ImGuiKey_DownArrow},
                            {GLFW_KEY_HOME, "Home", ImGuiKey_Home},
                            {GLFW_KEY_END, "End", ImGuiKey_End},
                            {GLFW_KEY_TAB, "Tab", ImGuiKey_Tab},
                            {GLFW_KEY_ESCAPE, "Escape", ImGuiKey_Escape},
                            {GLFW_KEY_ENTER, "Enter", ImGuiKey_Enter},
                            {GLFW_KEY_DELETE, "Delete", ImGuiKey_Delete},
                            {GLFW_KEY_PAGE_UP, "PageUp", ImGuiKey_PageUp},
                            {GLFW_KEY_PAGE_DOWN, "PageDown", ImGuiKey_PageDown},
                            {GLFW_KEY_BACKSPACE, "Backspace", ImGuiKey_Backspace},
                            {GLFW_KEY_INSERT, "Insert", ImGuiKey_Insert},
                            {GLFW_KEY_KP_ENTER, "Enter", ImGuiKey_Enter}};
constexpr std::string_view kOfTextFields = "ACVXYZ";  // copy, paste and the like, as ImGuiKey has them

bool is_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 128; });
}

std::string name_of_key(int key, const std::string& printed) {
  const auto* const named = std::ranges::find(kNamed, key, &Named::key);
  if (named != std::end(kNamed)) return named->name;
  if (GLFW_KEY_F1 <= key && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
  if (GLFW_KEY_KP_0 <= key && key <= GLFW_KEY_KP_9) return std::to_string(key - GLFW_KEY_KP_0);
  const bool is_digit = GLFW_KEY_0 <= key && key <= GLFW_KEY_9, is_letter = GLFW_KEY_A <= key && key <= GLFW_KEY_Z;
  if (is_digit || (is_letter && !is_ascii(printed))) return std::string(1, static_cast<char>(key));  // is ASCII
  std::string name = printed;
  if (name.size() == 1) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

// Warns on standard error where an X display refuses a request; must not ask the display for anything.
int say(Display* display, XErrorEvent* error) {
  std::array<char, 256> text{};
  XGetErrorText(display, error->error_code, text.data(), static_cast<int>(text.size()));
  std::cerr << "warning: the display refused request " << static_cast<int>(error->request_code) << ": " << text.data()
            << "\n";
  return 0;  // ignored
}

std::string glfw_problem() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

KeyAction key_action(int action) {
  if (action == GLFW_RELEASE) return KeyAction::released;
  return action == GLFW_REPEAT ? KeyAction::repeated : KeyAction::pressed;
}

// One that takes the picture's bytes as they are.
VkSurfaceFormatKHR choose_format(VkPhysicalDevice physical, VkSurfaceKHR surface) {
  const auto formats = vulkan::enumerate<VkSurfaceFormatKHR>(
      "vkGetPhysicalDeviceSurfaceFormatsKHR",
      [&](auto* count, auto* items) { return vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, count, items); });
  for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM}) {
    const auto found = std::ranges::find(formats, wanted, &VkSurfaceFormatKHR::format);
    if (found != formats.end()) return *found;
  }
  throw Error(ErrorKind::device, "the window's surface offers no 8-bit colours");
}

// Without vsync, takes the first mode that does not wait.
VkPresentModeKHR choose_mode(VkPhysicalDevice physical, VkSurfaceKHR surface, bool vsync) {
  if (vsync) return VK_PRESENT_MODE_FIFO_KHR;  // always there
  const auto modes =
      vulkan::enumerate<VkPresentModeKHR>("vkGetPhysicalDeviceSurfacePresentModesKHR", [&](auto* count, auto* items) {
        return vkGetPhysicalDeviceSurfacePresentModesKHR(physical, surface, count, items);
      });
  for (const VkPresentModeKHR wanted : {VK_PRESENT_MODE_IMMEDIATE_KHR, VK_PRESENT_MODE_MAILBOX_KHR}) {
    if (std::ranges::find(modes, wanted) != modes.end()) return wanted;
  }
  return VK_PRESENT_MODE_FIFO_KHR;
}

}  // namespace

// The images of the screen, and what copies the picture into them.
struct Window::Swapchain {
  Swapchain(std::shared_ptr<const vulkan::Device> d, GLFWwindow* window, bool vsync_)
      : owned_device(std::move(d)), device(*owned_device), vsync(vsync_) {
    check(glfwCreateWindowSurface(device.instance(), window, nullptr, &surface), "glfwCreateWindowSurface");
    VkBool32 shows = VK_FALSE;
    check(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queue_family(), surface, &shows),
          "vkGetPhysicalDeviceSurfaceSupportKHR");
    if (!shows) {
      vkDestroySurfaceKHR(device.instance(), surface, nullptr);
      throw Error(ErrorKind::device, "the Vulkan device '" + device.info().name +
                                         "' cannot show pictures in this window; try another with --device, or "
                                         "--headless");
    }
    acquired = vulkan::make_fence(device.handle());
  }

  ~Swapchain() {
    vkDeviceWaitIdle(device.handle());
    if (chain != VK_NULL_HANDLE) vkDestroySwapchainKHR(device.handle(), chain, nullptr);
    vkDestroySurfaceKHR(device.instance(), surface, nullptr);
  }

  // False while the window has no pixel.
  bool rebuild(VkExtent2D wanted) {
    vkDeviceWaitIdle(device.handle());
    VkSurfaceCapabilitiesKHR can{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical(), surface, &can),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    size = can.currentExtent.width != 0xffffffff ? can.currentExtent : wanted;
    if (size.width == 0 || size.height == 0) return false;
    const VkSurfaceFormatKHR format = choose_format(device.physical(), surface);
    auto info = structure<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
    info.surface = surface;
    info.minImageCount = std::max(2u, can.minImageCount);
    if (can.maxImageCount > 0) info.minImageCount = std::min(info.minImageCount, can.maxImageCount);
    info.imageFormat = format.format;
    info.imageColorSpace = format.colorSpace;
    info.imageExtent = size;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = can.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    info.presentMode = choose_mode(device.physical(), surface, vsync);
    info.clipped = VK_TRUE;
    info.oldSwapchain = chain;
    VkSwapchainKHR made = VK_NULL_HANDLE;
    check(vkCreateSwapchainKHR(device.handle(), &info, nullptr, &made), "vkCreateSwapchainKHR");
    if (chain != VK_NULL_HANDLE) vkDestroySwapchainKHR(device.handle(), chain, nullptr);
    chain = made;
    images = vulkan::enumerate<VkImage>("vkGetSwapchainImagesKHR", [&](auto* count, auto* items) {
      return vkGetSwapchainImagesKHR(device.handle(), chain, count, items);
    });
    return true;
  }

  // Waits for the image, and for the copy.
  void copy(const draw::Canvas& canvas, VkImage to) {
    const VkFence fence = acquired.get();
    check(vkWaitForFences(device.handle(), 1, &fence, VK_TRUE, ~std::uint64_t{0}), "vkWaitForFences");
    check(vkResetFences(device.handle(), 1, &fence), "vkResetFences");
    commands.begin();
    draw::pass_on(commands.handle(), to,
                  {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_PIPELINE_STAGE_TRANSFER_BIT, 0, VK_ACCESS_TRANSFER_WRITE_BIT});
    const auto corner = [](std::uint32_t width, std::uint32_t height) {
      return VkOffset3D{static_cast<std::int32_t>(width), static_cast<std::int32_t>(height), 1};
    };
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    blit.srcOffsets[1] = corner(canvas.size().width, canvas.size().height);
    blit.dstOffsets[1] = corner(size.width, size.height);
    const bool same = canvas.size().width == size.width && canvas.size().height == size.height;
    vkCmdBlitImage(commands.handle(), canvas.image(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, same ? VK_FILTER_NEAREST : VK_FILTER_LINEAR);
    draw::pass_on(
        commands.handle(), to,
        {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_TRANSFER_BIT,
         VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, 0});
    commands.end();
    commands.run();
  }

  std::shared_ptr<const vulkan::Device> owned_device;  // must outlive the surface
  const vulkan::Device& device;
  bool vsync;
  VkSurfaceKHR surface = VK_NULL_HANDLE;
  VkSwapchainKHR chain = VK_NULL_HANDLE;
  VkExtent2D size{};
  std::vector<VkImage> images;
  vulkan::Fence acquired;
  vulkan::Commands commands{device};
};

Window::Window(const WindowOptions& options) : vsync_(options.vsync) {
  if (!glfwInit()) {
    throw Error(ErrorKind::device, "no window can be opened here (" + glfw_problem() +
                                       "): is there a display? --headless -o FILE.png draws without one");
  }
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  window_ = glfwCreateWindow(static_cast<int>(options.width), static_cast<int>(options.height), options.title.c_str(),
                             nullptr, nullptr);
  if (!window_) {
    const std::string problem = glfw_problem();
    glfwTerminate();
    throw Error(ErrorKind::device,
                "no window can be opened here (" + problem + "); --headless -o FILE.png draws without one");
  }
  // By itself Xlib would end the program, as when the window from which files are dragged goes away. GLFW takes the
  // handler away whenever it opens a window. Does nothing on other displays.
  XSetErrorHandler(say);
  glfwSetWindowUserPointer(window_, this);
  listen();
}

void Window::listen() {
  static constexpr auto self = [](GLFWwindow* window) -> Window& {
    return *static_cast<Window*>(glfwGetWindowUserPointer(window));
  };
  static constexpr auto hear = [](GLFWwindow* window, WindowEvent event) {
    self(window).events_.push_back(std::move(event));
  };
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** paths) {
    hear(window, DropEvent{{paths, paths + count}});
  });
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scancode, int action, int modifiers) {
    self(window).hear_key(key, scancode, action, modifiers);
  });
  glfwSetCharCallback(window_, [](GLFWwindow* window, unsigned letter) { hear(window, LetterEvent{letter}); });
  glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) { self(window).hear_cursor(x, y); });
  glfwSetCursorEnterCallback(window_, [](GLFWwindow* window, int) { hear(window, SurfaceEvent{}); });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
    hear(window, ButtonEvent{button, action == GLFW_PRESS});
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double x, double y) { hear(window, WheelEvent{x, y}); });
  glfwSetWindowCloseCallback(window_, [](GLFWwindow* window) {
    glfwSetWindowShouldClose(window, GLFW_FALSE);  // who hears of it says whether
    hear(window, CloseEvent{});
  });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int) { hear(window, SurfaceEvent{}); });
  glfwSetWindowRefreshCallback(window_, [](GLFWwindow* window) { hear(window, SurfaceEvent{}); });
  glfwSetWindowContentScaleCallback(window_, [](GLFWwindow* window, float, float) { hear(window, SurfaceEvent{}); });
  glfwSetFramebufferSizeCallback(window_, [](GLFWwindow* window, int, int) { hear(window, SurfaceEvent{}); });
}

void Window::hear_key(int key, int scancode, int action, int modifiers) {
  if (GLFW_KEY_LEFT_SHIFT <= key && key <= GLFW_KEY_RIGHT_SUPER) {
    const auto held = [&](int left, int right) {
      return glfwGetKey(window_, left) == GLFW_PRESS || glfwGetKey(window_, right) == GLFW_PRESS;
    };
    events_.push_back(ModifierKeysEvent{.control = held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
                                        .shift = held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT),
                                        .alt = held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT)});
  }
  const char* printed = glfwGetKeyName(key, scancode);
  events_.push_back(KeyEvent{key_name(key, printed ? printed : "", modifiers), key_action(action)});
}

// Takes the window's own coordinates, which need not be pixels.
void Window::hear_cursor(double x, double y) {
  int width = 0, height = 0;
  glfwGetWindowSize(window_, &width, &height);
  events_.push_back(CursorEvent{x / std::max(1, width), y / std::max(1, height)});
}

Window::~Window() {
  swapchain_.reset();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

vulkan::DeviceUse Window::device_use() const {
  vulkan::DeviceUse use{.draws = true};
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names) {
    throw Error(ErrorKind::device,
                "no Vulkan device here can show pictures in a window (" + glfw_problem() +
                    "): is there a driver (Debian package with a software one: mesa-vulkan-drivers)?");
  }
  use.instance_extensions.assign(names, names + count);
  use.extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  return use;
}

void Window::attach(std::shared_ptr<const vulkan::Device> device) {
  swapchain_ = std::make_unique<Swapchain>(std::move(device), window_, vsync_);
}

void Window::show(const draw::Canvas& canvas) {
  if (!show_once(canvas)) show_once(canvas);
}

// False when the surface was out of date: it is no longer. One that changes again calls back.
bool Window::show_once(const draw::Canvas& canvas) {
  Swapchain& s = *swapchain_;
  const auto [width, height] = size();
  if (s.chain == VK_NULL_HANDLE || s.size.width != width || s.size.height != height) {
    if (!s.rebuild({width, height})) return true;  // minimised
  }
  std::uint32_t image = 0;
  VkResult result =
      vkAcquireNextImageKHR(s.device.handle(), s.chain, 1'000'000'000, VK_NULL_HANDLE, s.acquired.get(), &image);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) {
    s.rebuild({width, height});
    return false;
  }
  if (result == VK_TIMEOUT || result == VK_NOT_READY) return true;  // nobody looks
  if (result != VK_SUBOPTIMAL_KHR) check(result, "vkAcquireNextImageKHR");
  s.copy(canvas, s.images[image]);
  auto present = structure<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
  present.swapchainCount = 1;
  present.pSwapchains = &s.chain;
  present.pImageIndices = &image;
  result = vkQueuePresentKHR(s.device.queue(), &present);
  if (result == VK_ERROR_OUT_OF_DATE_KHR) {
    s.rebuild({width, height});
    return false;
  }
  if (result != VK_SUBOPTIMAL_KHR) check(result, "vkQueuePresentKHR");
  return true;
}

std::vector<WindowEvent> Window::poll(double seconds) {
  if (seconds > 0) {
    glfwWaitEventsTimeout(seconds);
  } else {
    glfwPollEvents();
  }
  return std::exchange(events_, {});
}

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

std::array<std::uint32_t, 2> Window::size() const {
  int width = 0, height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  return {static_cast<std::uint32_t>(std::max(0, width)), static_cast<std::uint32_t>(std::max(0, height))};
}

// The desktop sets the scale; on X11 by Xft.dpi.
float Window::scale() const {
  constexpr float kMost = 4;
  float across = 1, down = 1;
  glfwGetWindowContentScale(window_, &across, &down);
  return std::clamp(across, 1.0f, kMost);
}

std::string bare_key(const std::string& name) { return name.substr(name.rfind('+') + 1); }

std::string key_name(int key, const std::string& printed, int modifiers) {
  const std::string name = name_of_key(key, printed);
  if (name.empty()) return {};
  std::string prefix;
  if (modifiers & GLFW_MOD_CONTROL) prefix += "Ctrl+";
  if (modifiers & GLFW_MOD_ALT) prefix += "Alt+";
  if (modifiers & GLFW_MOD_SHIFT) prefix += "Shift+";
  return prefix + name;
}

std::optional<int> imgui_key(const std::string& name) {
  const auto* const named = std::ranges::find(kNamed, name, &Named::name);
  if (named != std::end(kNamed)) return named->imgui;
  const std::size_t letter = name.size() == 1 ? kOfTextFields.find(name) : std::string_view::npos;
  return letter < kOfTextFields.size() ? std::optional(ImGuiKey_A + static_cast<int>(letter)) : std::nullopt;
}

}  // namespace bodyopt::viewport
