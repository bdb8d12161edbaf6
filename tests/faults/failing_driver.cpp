// A Vulkan layer that makes the driver fail at a call of one kind, for tests: TAXELSIM_FAIL_SUBMIT=n loses the device at the nth submit and
// from then on, as a driver does that was reset; TAXELSIM_HANG_SUBMIT=n never ends that submit; TAXELSIM_FAIL_PIPELINE=n refuses the nth
// compute pipeline. For programs that open one device at a time.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string_view>

namespace {

PFN_vkGetInstanceProcAddr next_instance_function;
PFN_vkGetDeviceProcAddr next_device_function;
VkInstance the_instance;
VkDevice the_device;
std::atomic<long> num_submits, num_pipelines;
std::atomic<bool> lost, hung;

// Whether this call is the one that the variable names.
bool isChosen(const char* variable, long number) {
  const char* value = std::getenv(variable);
  return number == (value == nullptr ? 0 : std::strtol(value, nullptr, 10));
}

template <typename Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(next_device_function(the_device, name));
}

// The entry of the layer's own link in the list that the loader passes along.
template <typename Info>
Info* linkOf(const void* chain, VkStructureType type) {
  auto* info = static_cast<Info*>(const_cast<void*>(chain));
  while (info != nullptr && (info->sType != type || info->function != VK_LAYER_LINK_INFO))
    info = static_cast<Info*>(const_cast<void*>(info->pNext));
  return info;
}

VKAPI_ATTR VkResult VKAPI_CALL queueSubmit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
  const long number = ++num_submits;
  if (isChosen("TAXELSIM_FAIL_SUBMIT", number)) lost = true;
  if (isChosen("TAXELSIM_HANG_SUBMIT", number)) hung = true;
  return lost ? VK_ERROR_DEVICE_LOST : next<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, count, submits, fence);
}

// Waits for what was submitted before the loss, so that nothing is freed that the real driver still uses.
VKAPI_ATTR VkResult VKAPI_CALL waitForFences(VkDevice device, std::uint32_t count, const VkFence* fences, VkBool32 all,
                                             std::uint64_t time) {
  while (hung) pause();
  const VkResult result = next<PFN_vkWaitForFences>("vkWaitForFences")(device, count, fences, all, time);
  return lost ? VK_ERROR_DEVICE_LOST : result;
}

VKAPI_ATTR VkResult VKAPI_CALL createComputePipelines(VkDevice device, VkPipelineCache cache, std::uint32_t count,
                                                      const VkComputePipelineCreateInfo* infos, const VkAllocationCallbacks* allocator,
                                                      VkPipeline* pipelines) {
  if (!isChosen("TAXELSIM_FAIL_PIPELINE", ++num_pipelines))
    return next<PFN_vkCreateComputePipelines>("vkCreateComputePipelines")(device, cache, count, infos, allocator, pipelines);
  for (std::uint32_t i = 0; i < count; ++i) pipelines[i] = VK_NULL_HANDLE;
  return VK_ERROR_INITIALIZATION_FAILED;
}

VKAPI_ATTR VkResult VKAPI_CALL createInstance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                              VkInstance* instance) {
  auto* link = linkOf<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  next_instance_function = link->u.pLayerInfo->pfnNextGetInstanceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_instance_function(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  the_instance = *instance;
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL createDevice(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                            const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto* link = linkOf<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO);
  if (link == nullptr) return VK_ERROR_INITIALIZATION_FAILED;
  next_device_function = link->u.pLayerInfo->pfnNextGetDeviceProcAddr;
  link->u.pLayerInfo = link->u.pLayerInfo->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_instance_function(the_instance, "vkCreateDevice"));
  const VkResult result = create(physical, info, allocator, device);
  the_device = *device;
  return result;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL deviceFunction(VkDevice device, const char* name);
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instanceFunction(VkInstance instance, const char* name);

// The layer's function of this name, or null.
PFN_vkVoidFunction ownFunction(std::string_view name) {
  if (name == "vkQueueSubmit") return reinterpret_cast<PFN_vkVoidFunction>(queueSubmit);
  if (name == "vkWaitForFences") return reinterpret_cast<PFN_vkVoidFunction>(waitForFences);
  if (name == "vkCreateComputePipelines") return reinterpret_cast<PFN_vkVoidFunction>(createComputePipelines);
  if (name == "vkCreateInstance") return reinterpret_cast<PFN_vkVoidFunction>(createInstance);
  if (name == "vkCreateDevice") return reinterpret_cast<PFN_vkVoidFunction>(createDevice);
  if (name == "vkGetDeviceProcAddr") return reinterpret_cast<PFN_vkVoidFunction>(deviceFunction);
  if (name == "vkGetInstanceProcAddr") return reinterpret_cast<PFN_vkVoidFunction>(instanceFunction);
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL deviceFunction(VkDevice device, const char* name) {
  const PFN_vkVoidFunction own = ownFunction(name);
  return own != nullptr ? own : next_device_function(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instanceFunction(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction own = ownFunction(name);
  return own != nullptr ? own : next_instance_function(instance, name);
}

}  // namespace

extern "C" VK_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  if (version->loaderLayerInterfaceVersion < 2) return VK_ERROR_INITIALIZATION_FAILED;
  version->loaderLayerInterfaceVersion = 2;
  version->pfnGetInstanceProcAddr = instanceFunction;
  version->pfnGetDeviceProcAddr = deviceFunction;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
