#include "gpu/buffer.h"

#include <cstring>
#include <optional>

#include "gpu/commands.h"
#include "gpu/vulkan_buffer.h"
#include "taxelsim/error.h"

namespace taxelsim::gpu {
namespace {

using Property = vk::MemoryPropertyFlagBits;

constexpr std::size_t kTexelBytes = 16;
constexpr auto kMemoryHandle = vk::ExternalMemoryHandleTypeFlagBits::eOpaqueFd;

// The memory of a buffer consists of whole texels: viewAsTexels() would leave out a part of one.
std::size_t wholeTexels(std::size_t bytes) {
  return (bytes + kTexelBytes - 1) / kTexelBytes * kTexelBytes;
}

// First memory type that has all of the flags of the earliest entry of `wishes` that any type satisfies.
std::optional<std::uint32_t> findMemoryType(const vk::PhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                            std::initializer_list<vk::MemoryPropertyFlags> wishes) {
  for (const vk::MemoryPropertyFlags wish : wishes) {
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
      if ((allowed & (1u << i)) && (memory.memoryTypes[i].propertyFlags & wish) == wish) return i;
    }
  }
  return std::nullopt;
}

std::optional<std::uint32_t> chooseMemory(const vk::PhysicalDeviceMemoryProperties& memory, std::uint32_t allowed, Domain domain) {
  const vk::MemoryPropertyFlags host = Property::eHostVisible | Property::eHostCoherent;
  switch (domain) {
    case Domain::kDevice:
      return findMemoryType(memory, allowed, {Property::eDeviceLocal | host | Property::eHostCached, Property::eDeviceLocal, {}});
    case Domain::kUpload:
      return findMemoryType(memory, allowed, {Property::eDeviceLocal | host, host});
    case Domain::kReadback:
      return findMemoryType(memory, allowed, {host | Property::eHostCached, host});
  }
  return std::nullopt;
}

std::string sizeText(std::size_t bytes) {
  const double mebibytes = static_cast<double>(bytes) / (1024.0 * 1024.0);
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f MiB", mebibytes);
  return text;
}

}  // namespace

Buffer::Buffer(Context& context, std::string name, std::size_t bytes, Domain domain, Sharing sharing)
    : vulkan_(std::make_unique<Vulkan>()), name_(std::move(name)), bytes_(std::max(bytes, kTexelBytes)) {
  Context::Vulkan& vk_context = context.vulkan();
  const bool is_exported = sharing == Sharing::kExported;
  const vk::ExternalMemoryBufferCreateInfo external(kMemoryHandle);
  checked("buffer \"" + name_ + "\" of " + sizeText(bytes_), "use a smaller batch size or another device", [&] {
    vulkan_->buffer = vk_context.device.createBuffer(
        {{}, wholeTexels(bytes_), kBufferUsage, vk::SharingMode::eExclusive, {}, is_exported ? &external : nullptr});
    const vk::MemoryRequirements needs = vulkan_->buffer.getMemoryRequirements();
    const vk::PhysicalDeviceMemoryProperties memory = vk_context.physical.getMemoryProperties();
    const std::optional<std::uint32_t> type = chooseMemory(memory, needs.memoryTypeBits, domain);
    if (!type) throw Error(ErrorKind::kDevice, "the device has no memory for buffer \"" + name_ + "\"");
    const vk::MemoryDedicatedAllocateInfo dedicated({}, *vulkan_->buffer);
    const vk::ExportMemoryAllocateInfo exported(kMemoryHandle, &dedicated);
    vulkan_->memory = vk_context.device.allocateMemory({needs.size, *type, is_exported ? &exported : nullptr});
    vulkan_->memory_bytes = needs.size;
    vulkan_->buffer.bindMemory(*vulkan_->memory, 0);
    vk_context.name(vulkan_->buffer, name_);
    if (memory.memoryTypes[*type].propertyFlags & Property::eHostCoherent) {
      mapped_ = {static_cast<std::byte*>(vulkan_->memory.mapMemory(0, VK_WHOLE_SIZE)), bytes_};
    }
  });
  if (!mapped_.empty()) {
    std::memset(mapped_.data(), 0, wholeTexels(bytes_));
  } else {
    Commands clear(context, "clear " + name_);
    clear.fillZero(*this);
    clear.end();
    clear.submit();
    clear.wait();
  }
}

ExportedMemory Buffer::exportMemory(Context& context) const {
  return checked("exporting buffer \"" + name_ + "\"", "", [&] {
    return ExportedMemory{context.vulkan().device.getMemoryFdKHR({*vulkan_->memory, kMemoryHandle}), vulkan_->memory_bytes};
  });
}

void Buffer::viewAsTexels(Context& context) const {
  std::call_once(vulkan_->viewed, [&] {
    Context::Vulkan& vk_context = context.vulkan();
    const std::size_t most = vk_context.physical.getProperties().limits.maxTexelBufferElements;
    if (bytes_ / kTexelBytes > most) {
      throw Error(ErrorKind::kDevice, "buffer \"" + name_ + "\" of " + sizeText(bytes_) + ": the device reads at most " +
                                          sizeText(most * kTexelBytes) + " as texels");
    }
    checked("texels of buffer \"" + name_ + "\"", "", [&] {
      vulkan_->texels = vk_context.device.createBufferView({{}, *vulkan_->buffer, vk::Format::eR32G32B32A32Uint, 0, VK_WHOLE_SIZE});
    });
  });
}

Buffer::Buffer() = default;
Buffer::~Buffer() = default;
Buffer::Buffer(Buffer&&) noexcept = default;
Buffer& Buffer::operator=(Buffer&&) noexcept = default;

void upload(Context& context, std::span<const std::byte> bytes, const Buffer& buffer) {
  if (bytes.empty()) return;
  if (!buffer.mapped().empty()) {
    std::memcpy(buffer.mapped().data(), bytes.data(), bytes.size());
    return;
  }
  const Buffer staging(context, buffer.name() + " staging", bytes.size(), Domain::kUpload);
  std::memcpy(staging.mapped().data(), bytes.data(), bytes.size());
  Commands commands(context, "upload " + buffer.name());
  commands.copy(staging, buffer, bytes.size());
  commands.barrier(Access::kCopy, Access::kKernel);
  commands.end();
  commands.submit();
  commands.wait();
}

Buffer makeStaticBuffer(Context& context, std::string name, std::span<const std::byte> bytes) {
  Buffer buffer(context, std::move(name), bytes.size(), Domain::kDevice);
  upload(context, bytes, buffer);
  return buffer;
}

}  // namespace taxelsim::gpu
