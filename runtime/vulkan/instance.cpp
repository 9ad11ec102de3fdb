#include "runtime/vulkan/instance.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
// Returns what the user can do about a result, if anything.
const char* advice(VkResult result) {
  switch (result) {
    case VK_ERROR_DEVICE_LOST:
      return ": likely by work that took too long, by too little memory or a defect of its driver. Files that were "
             "written are whole; run it again, or with another --device";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return ": likely other programs use the device, too. Close them, take fewer frames at a time or a lighter level "
             "of the character, or the CPU (--device cpu)";
    case VK_TIMEOUT:
      return ": likely the device hangs, or other work keeps it busy. Take fewer frames at a time or a lighter level "
             "of the character, or another --device";
    default:
      return "";
  }
}

const char* result_name(VkResult result) {
  static constexpr std::pair<VkResult, const char*> kNames[] = {
      {VK_ERROR_OUT_OF_HOST_MEMORY, "out of host memory"},
      {VK_ERROR_OUT_OF_DEVICE_MEMORY, "out of device memory"},
      {VK_ERROR_INITIALIZATION_FAILED, "initialization failed"},
      {VK_ERROR_DEVICE_LOST, "the device was lost"},
      {VK_ERROR_LAYER_NOT_PRESENT, "layer not present"},
      {VK_ERROR_EXTENSION_NOT_PRESENT, "extension not present"},
      {VK_ERROR_FEATURE_NOT_PRESENT, "feature not present"},
      {VK_ERROR_INCOMPATIBLE_DRIVER, "incompatible driver"},
      {VK_ERROR_TOO_MANY_OBJECTS, "too many objects"},
      {VK_TIMEOUT, "timed out"},
  };
  const auto found = std::ranges::find(kNames, result, &std::pair<VkResult, const char*>::first);
  return found == std::end(kNames) ? "error" : found->second;
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  static_cast<ValidationLog*>(log)->add(data->pMessage ? data->pMessage : "(no text)");
  return VK_FALSE;
}

bool layer_installed() {
  const auto layers =
      enumerate<VkLayerProperties>("vkEnumerateInstanceLayerProperties", vkEnumerateInstanceLayerProperties);
  return std::ranges::any_of(
      layers, [](const VkLayerProperties& l) { return std::strcmp(l.layerName, kValidationLayer) == 0; });
}

bool extension_offered(const char* name) {
  return lists_extension(
      enumerate<VkExtensionProperties>(
          "vkEnumerateInstanceExtensionProperties",
          [](auto* count, auto* items) { return vkEnumerateInstanceExtensionProperties(nullptr, count, items); }),
      name);
}

// Devices of Vulkan on Metal are listed only on request. `extensions` are those of `info`.
void ask_for_portability(VkInstanceCreateInfo& info, std::vector<const char*>& extensions) {
  if (extension_offered(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
    extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
    info.flags |= VK_INSTANCE_CREATE_ENUMERATE_PORTABILITY_BIT_KHR;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
}

// Keeps an instance that is never destroyed. Else the loader closes the drivers with the last instance. NVIDIA's (580)
// cannot be opened more than some thirty times by one process, nor by several threads at once.
void keep_drivers_loaded() {
  [[maybe_unused]] static const VkInstance kept = [] {
    std::vector<const char*> extensions;
    auto info = structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    ask_for_portability(info, extensions);
    VkInstance instance = VK_NULL_HANDLE;
    vkCreateInstance(&info, nullptr, &instance);  // fails where there is no driver to keep
    return instance;
  }();
}

}  // namespace

bool lists_extension(const std::vector<VkExtensionProperties>& extensions, const char* name) {
  return std::ranges::any_of(extensions,
                             [&](const VkExtensionProperties& e) { return std::strcmp(e.extensionName, name) == 0; });
}

void check(VkResult result, const char* call) {
  if (result == VK_SUCCESS || result == VK_INCOMPLETE) return;
  throw Error(ErrorKind::device, "Vulkan: ", call, " failed: ", result_name(result), " (VkResult ",
              static_cast<int>(result), ")", advice(result));
}

void ValidationLog::add(std::string message) {
  const std::lock_guard lock(mutex_);
  messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::messages() const {
  const std::lock_guard lock(mutex_);
  return messages_;
}

Instance::Instance(bool validation, const std::vector<const char*>& wanted) : log_(std::make_shared<ValidationLog>()) {
  if (!missing_functions().empty()) return;
  if (validation && !layer_installed()) {
    throw Error(ErrorKind::device, "Vulkan validation was asked for, but the layer ", kValidationLayer,
                " is not installed (Debian package: vulkan-validationlayers)");
  }
  keep_drivers_loaded();
  auto application = structure<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "bodyopt";
  application.apiVersion = VK_API_VERSION_1_2;

  auto messenger =
      structure<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = collect;
  messenger.pUserData = log_.get();

  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  auto features = structure<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.pNext = &messenger;  // heard during vkCreateInstance and vkDestroyInstance
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronization;

  std::vector<const char*> extensions = wanted;
  auto info = structure<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  if (validation) {
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  ask_for_portability(info, extensions);
  const VkResult result = vkCreateInstance(&info, nullptr, &handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return;  // no driver on this machine
  check(result, "vkCreateInstance");
  if (!validation) return;
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(handle_, "vkCreateDebugUtilsMessengerEXT"));
  const VkResult created = create ? create(handle_, &messenger, nullptr, &messenger_) : VK_ERROR_EXTENSION_NOT_PRESENT;
  if (created != VK_SUCCESS) vkDestroyInstance(handle_, nullptr);
  check(created, "vkCreateDebugUtilsMessengerEXT");
}

Instance::Instance(VkInstance host, PFN_vkGetInstanceProcAddr find)
    : log_(std::make_shared<ValidationLog>()), handle_(host), is_ours_(false) {
  find_functions(host, find);
}

Instance::~Instance() {
  if (!is_ours_) return;
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(handle_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(handle_, messenger_, nullptr);
  }
  if (handle_ != VK_NULL_HANDLE) vkDestroyInstance(handle_, nullptr);
}

std::vector<VkPhysicalDevice> Instance::physical_devices() const {
  if (handle_ == VK_NULL_HANDLE) return {};
  return enumerate<VkPhysicalDevice>("vkEnumeratePhysicalDevices", [&](auto* count, auto* items) {
    return vkEnumeratePhysicalDevices(handle_, count, items);
  });
}

}  // namespace bodyopt::vulkan
