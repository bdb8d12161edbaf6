#include "gpu/context.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/files.h"
#include "base/log.h"
#include "gpu/driver_profile.h"
#include "gpu/driver_threads.h"
#include "gpu/vulkan.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

bool environmentFlag(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' && std::string_view(value) != "0";
}

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto& vulkan = *static_cast<Context::Vulkan*>(user);
  const std::string message = data->pMessage;
  if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) {
    logError("validation: " + message);
    const std::lock_guard lock(vulkan.message_mutex);
    if (vulkan.first_message.empty()) vulkan.first_message = message;
  }
  return VK_FALSE;
}

std::filesystem::path cacheFile(const DeviceInfo& info) {
  const std::filesystem::path directory = userCacheDirectory();
  return directory.empty() ? directory : directory / ("pipelines-" + info.uuid + "-" + kVersion + ".bin");
}

// Empty if there is no such file, or none that can be a cache.
std::string readCache(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMaxCacheBytes = std::uintmax_t{256} << 20;
  return inputFileProblem(file, kMaxCacheBytes).empty() ? readTextFile(file, kMaxCacheBytes) : std::string();
}

constexpr const char* kNoDevice =
    "no Vulkan 1.2 device with a compute queue; install a driver (apt-get install mesa-vulkan-drivers has one for CPUs)";

// Throws Error(kDevice) if the Vulkan loader is not installed.
vk::raii::Context openLoader() {
  try {
    return vk::raii::Context();
  } catch (const std::exception&) {
    throw Error(ErrorKind::kDevice,
                "no Vulkan loader (libvulkan.so.1); install it with a driver (apt-get install libvulkan1 mesa-vulkan-drivers)");
  }
}

vk::raii::Instance makeInstance(const vk::raii::Context& loader, bool validation) {
  const vk::ApplicationInfo application("taxelsim", VK_MAKE_VERSION(TAXELSIM_VERSION_MAJOR, TAXELSIM_VERSION_MINOR, TAXELSIM_VERSION_PATCH),
                                        nullptr, 0, VK_API_VERSION_1_2);
  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  const std::array<vk::ValidationFeatureEnableEXT, 1> enables{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  const vk::ValidationFeaturesEXT features(enables, {});
  vk::InstanceCreateInfo create({}, &application);
  if (validation) {
    bool found = false;
    for (const vk::LayerProperties& layer : loader.enumerateInstanceLayerProperties()) {
      found = found || std::string_view(layer.layerName) == kValidationLayer;
    }
    if (!found) throw Error(ErrorKind::kDevice, "validation is on, but the Khronos validation layer is not installed");
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    create.pNext = &features;
  }
  create.setPEnabledLayerNames(layers);
  create.setPEnabledExtensionNames(extensions);
  try {
    return {loader, create};
  } catch (const vk::IncompatibleDriverError&) {  // the loader has found no driver
    throw Error(ErrorKind::kDevice, kNoDevice);
  }
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool matches(const DeviceInfo& info, const std::string& wanted) {
  if (wanted.empty()) return true;
  if (wanted == "discrete") return info.type == DeviceType::kDiscrete;
  if (wanted == "integrated") return info.type == DeviceType::kIntegrated;
  if (wanted == "gpu") return info.type != DeviceType::kCpu && info.type != DeviceType::kOther;
  if (wanted == "cpu") return info.type == DeviceType::kCpu;
  if (wanted.find_first_not_of("0123456789") == std::string::npos) return std::to_string(info.index) == wanted;
  return lower(info.name).find(lower(wanted)) != std::string::npos;
}

std::string listNames(const std::vector<DeviceInfo>& infos) {
  std::string names;
  for (const DeviceInfo& info : infos) names += (names.empty() ? "" : ", ") + std::to_string(info.index) + ": " + info.name;
  return names.empty() ? "none" : names;
}

// Index of the first device that matches `wanted`, or TAXELSIM_DEVICE if it is empty. Throws Error(kDevice) if there is none.
std::size_t chooseDevice(const std::vector<DeviceInfo>& infos, std::string wanted) {
  std::string source = "device";
  if (wanted.empty()) {
    if (const char* environment = std::getenv("TAXELSIM_DEVICE")) wanted = environment;
    source = "TAXELSIM_DEVICE";
  }
  const auto chosen = std::find_if(infos.begin(), infos.end(), [&](const DeviceInfo& info) { return matches(info, wanted); });
  if (chosen != infos.end()) return static_cast<std::size_t>(chosen - infos.begin());
  if (infos.empty()) throw Error(ErrorKind::kDevice, kNoDevice);
  throw Error(ErrorKind::kDevice,
              source + ": no device matches \"" + wanted +
                  "\"; allowed are gpu, discrete, integrated, cpu, an index, or part of a name of Vulkan's " +
                  "devices: " + listNames(infos) +
                  ". A GPU that is missing there needs its vendor's Vulkan driver (ICD), which VK_ICD_FILENAMES may hide");
}

// The first family of queues that compute. One without graphics is preferred: it does not wait for the desktop.
std::uint32_t chooseQueueFamily(const vk::raii::PhysicalDevice& device) {
  const std::vector<vk::QueueFamilyProperties> families = device.getQueueFamilyProperties();
  const auto find = [&](bool with_graphics) {
    return std::find_if(families.begin(), families.end(), [&](const vk::QueueFamilyProperties& family) {
      const bool has_graphics = static_cast<bool>(family.queueFlags & vk::QueueFlagBits::eGraphics);
      return (family.queueFlags & vk::QueueFlagBits::eCompute) && (with_graphics || !has_graphics);
    });
  };
  auto chosen = find(false);
  if (chosen == families.end()) chosen = find(true);
  return static_cast<std::uint32_t>(chosen - families.begin());
}

// Asks the driver about buffers with the usage that Buffer gives them, and about timeline semaphores.
Exports findExports(const vk::raii::PhysicalDevice& device) {
  const std::vector<vk::ExtensionProperties> found = device.enumerateDeviceExtensionProperties();
  const auto has = [&](std::string_view name) {
    return std::any_of(found.begin(), found.end(), [&](const vk::ExtensionProperties& e) { return e.extensionName.data() == name; });
  };
  Exports exports;
  if (has(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME)) {
    const auto memory = device.getExternalBufferProperties({{}, kBufferUsage, vk::ExternalMemoryHandleTypeFlagBits::eOpaqueFd});
    exports.memory =
        static_cast<bool>(memory.externalMemoryProperties.externalMemoryFeatures & vk::ExternalMemoryFeatureFlagBits::eExportable);
  }
  if (has(VK_KHR_EXTERNAL_SEMAPHORE_FD_EXTENSION_NAME)) {
    const vk::SemaphoreTypeCreateInfo timeline(vk::SemaphoreType::eTimeline);
    const auto semaphore = device.getExternalSemaphoreProperties({vk::ExternalSemaphoreHandleTypeFlagBits::eOpaqueFd, &timeline});
    exports.timelines = static_cast<bool>(semaphore.externalSemaphoreFeatures & vk::ExternalSemaphoreFeatureFlagBits::eExportable);
  }
  return exports;
}

}  // namespace

void throwDeviceError(const vk::SystemError& error, const std::string& what, const std::string& advice) {
  const auto result = static_cast<vk::Result>(error.code().value());
  if (result == vk::Result::eErrorOutOfDeviceMemory || result == vk::Result::eErrorOutOfHostMemory) {
    throw Error(ErrorKind::kDevice, "out of memory: " + what + (advice.empty() ? "" : "; " + advice));
  }
  if (result == vk::Result::eErrorDeviceLost) {
    throw Error(ErrorKind::kDevice, "the device was lost during " + what +
                                        "; its work is gone: open it again, and if it happens again use smaller batches or another device");
  }
  throw Error(ErrorKind::kDevice, what + " failed: " + vk::to_string(result));
}

Context::Context(const DeviceOptions& options) : vulkan_(std::make_unique<Vulkan>(openLoader())), keeps_kernels_(options.keep_kernels) {
  const bool validation = options.validation || environmentFlag("TAXELSIM_VALIDATION");
  Vulkan& vulkan = *vulkan_;
  const DriverThreads driver_threads;
  checked("opening Vulkan", "", [&] { vulkan.instance = makeInstance(vulkan.loader, validation); });
  if (validation) {
    using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
    using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
    vulkan.debug_names = true;
    vulkan.messenger = vulkan.instance.createDebugUtilsMessengerEXT(
        {{}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, onMessage, vulkan_.get()});
  }
  std::vector<vk::raii::PhysicalDevice> handles;
  const std::vector<DeviceInfo> infos = describeDevices(vulkan.instance, &handles);
  const std::size_t chosen = chooseDevice(infos, options.device);
  info_ = infos[chosen];
  vulkan.physical = handles[chosen];
  checked("opening device " + info_.name, "", [&] { openDevice(); });
  if (DriverProfile(info_, wide_numbers_, fastPaths()).bindsThreads()) driver_threads.bindToProcessors();
  logDebug("device " + std::to_string(info_.index) + ": " + info_.name + " (" + info_.driver + ")");
}

void Context::openDevice() {
  Vulkan& vulkan = *vulkan_;
  vulkan.queue_family = chooseQueueFamily(vulkan.physical);
  vulkan.timestamp_bits = vulkan.physical.getQueueFamilyProperties()[vulkan.queue_family].timestampValidBits;
  vulkan.timestamp_period = static_cast<double>(vulkan.physical.getProperties().limits.timestampPeriod) * 1e-9;
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue({}, vulkan.queue_family, 1, &priority);
  vk::PhysicalDeviceFeatures features;
  vk::PhysicalDeviceVulkan12Features features12;
  const auto available = vulkan.physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  features.shaderInt64 = available.get<vk::PhysicalDeviceFeatures2>().features.shaderInt64;
  features.shaderFloat64 = available.get<vk::PhysicalDeviceFeatures2>().features.shaderFloat64;
  features12.shaderSharedInt64Atomics = available.get<vk::PhysicalDeviceVulkan12Features>().shaderSharedInt64Atomics;
  wide_numbers_ = {.integers = features.shaderInt64 == VK_TRUE,
                   .floats = features.shaderFloat64 == VK_TRUE,
                   .shared_atomics = features12.shaderSharedInt64Atomics == VK_TRUE};
  exports_ = findExports(vulkan.physical);
  exports_.timelines = exports_.timelines && available.get<vk::PhysicalDeviceVulkan12Features>().timelineSemaphore == VK_TRUE;
  features12.timelineSemaphore = exports_.timelines;
  std::vector<const char*> extensions;
  if (exports_.memory) extensions.push_back(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
  if (exports_.timelines) extensions.push_back(VK_KHR_EXTERNAL_SEMAPHORE_FD_EXTENSION_NAME);
  vulkan.device = vk::raii::Device(vulkan.physical, vk::DeviceCreateInfo({}, queue, {}, extensions, &features, &features12));
  vulkan.queue = vulkan.device.getQueue(vulkan.queue_family, 0);
  const std::filesystem::path file = keeps_kernels_ ? cacheFile(info_) : std::filesystem::path();
  const std::string bytes = file.empty() ? std::string() : readCache(file);
  vulkan.pipeline_cache = vulkan.device.createPipelineCache({{}, bytes.size(), bytes.data()});
}

Context::~Context() {
  savePipelineCache();
}

void Context::savePipelineCache() {
  if (!vulkan_->pipelines_changed.exchange(false) || !keeps_kernels_) return;
  const std::filesystem::path file = cacheFile(info_);
  if (file.empty()) return;
  try {
    const std::vector<std::uint8_t> bytes = vulkan_->pipeline_cache.getData();
    createDirectories(file.parent_path());
    writeFileAtomically(file, std::as_bytes(std::span(bytes)));
  } catch (const std::exception& error) {
    logDebug(std::string("pipeline cache not saved: ") + error.what());
  }
}

void Context::throwOnValidationMessage() {
  const std::lock_guard lock(vulkan_->message_mutex);
  if (vulkan_->first_message.empty()) return;
  const std::string message = std::exchange(vulkan_->first_message, {});
  throw Error(ErrorKind::kDevice, "validation: " + message);
}

}  // namespace taxelsim::gpu

namespace taxelsim {

std::vector<DeviceInfo> listDevices() {
  return gpu::checked("opening Vulkan", "", [] {
    const vk::raii::Context loader = gpu::openLoader();
    const vk::raii::Instance instance = gpu::makeInstance(loader, false);
    return gpu::describeDevices(instance, nullptr);
  });
}

Device Device::open(const DeviceOptions& options) {
  return Device(std::make_shared<gpu::Context>(options));
}

const DeviceInfo& Device::info() const {
  return context_->info();
}

}  // namespace taxelsim
