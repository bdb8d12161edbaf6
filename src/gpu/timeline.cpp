#include "gpu/timeline.h"

#include "gpu/vulkan_timeline.h"

namespace taxelsim::gpu {
namespace {

constexpr auto kSemaphoreHandle = vk::ExternalSemaphoreHandleTypeFlagBits::eOpaqueFd;

}  // namespace

Timeline::Timeline(Context& context) : vulkan_(std::make_unique<Vulkan>()) {
  const vk::ExportSemaphoreCreateInfo exported(kSemaphoreHandle);
  const vk::SemaphoreTypeCreateInfo timeline(vk::SemaphoreType::eTimeline, 0, &exported);
  checked("making a timeline", "", [&] { vulkan_->semaphore = context.vulkan().device.createSemaphore({{}, &timeline}); });
}

Timeline::~Timeline() = default;
Timeline::Timeline(Timeline&&) noexcept = default;
Timeline& Timeline::operator=(Timeline&&) noexcept = default;

int Timeline::exportDescriptor(Context& context) const {
  return checked("exporting a timeline", "", [&] {
    return context.vulkan().device.getSemaphoreFdKHR({*vulkan_->semaphore, kSemaphoreHandle});
  });
}

}  // namespace taxelsim::gpu
