#include "gpu/commands.h"

#include <array>
#include <chrono>
#include <functional>
#include <limits>
#include <stdexcept>
#include <thread>

#include "gpu/vulkan_buffer.h"
#include "gpu/vulkan_timeline.h"

namespace taxelsim::gpu {
namespace {

// Vulkan's guaranteed limit per dimension, and that of nearly every device.
constexpr std::uint32_t kMaxGroupsPerDimension = 65535;
constexpr std::uint32_t kMaxSets = 256;

vk::PipelineStageFlags stageOf(Access access) {
  switch (access) {
    case Access::kKernel:
      return vk::PipelineStageFlagBits::eComputeShader;
    case Access::kCopy:
      return vk::PipelineStageFlagBits::eTransfer;
    case Access::kIndirect:
      return vk::PipelineStageFlagBits::eDrawIndirect;
    default:
      return vk::PipelineStageFlagBits::eHost;
  }
}

vk::AccessFlags written(Access access) {
  switch (access) {
    case Access::kKernel:
      return vk::AccessFlagBits::eShaderWrite;
    case Access::kCopy:
      return vk::AccessFlagBits::eTransferWrite;
    case Access::kHostWrite:
      return vk::AccessFlagBits::eHostWrite;
    default:
      return {};
  }
}

vk::AccessFlags used(Access access) {
  switch (access) {
    case Access::kKernel:
      return vk::AccessFlagBits::eShaderRead | vk::AccessFlagBits::eShaderWrite | vk::AccessFlagBits::eUniformRead;
    case Access::kCopy:
      return vk::AccessFlagBits::eTransferRead | vk::AccessFlagBits::eTransferWrite;
    case Access::kHostRead:
      return vk::AccessFlagBits::eHostRead;
    case Access::kIndirect:
      return vk::AccessFlagBits::eIndirectCommandRead;
    default:
      return {};
  }
}

// How long a thread asks a GPU whether it has ended before it sleeps: waking it can take longer than the frame.
constexpr std::chrono::microseconds kPolling(500);

void pollFor(std::chrono::microseconds time, const vk::raii::Fence& fence) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (fence.getStatus() == vk::Result::eNotReady && std::chrono::steady_clock::now() < end) std::this_thread::yield();
}

}  // namespace

struct Commands::Vulkan {
  Vulkan(Context& device_context, std::string list_name)
      : context(device_context), name(std::move(list_name)), submitting("submitting " + name) {}

  Context& context;
  std::string name;
  std::string submitting;  // for errors; made in advance, since submit() does not allocate
  vk::raii::DescriptorPool descriptors = nullptr;
  std::vector<vk::raii::DescriptorSet> sets;
  std::vector<std::function<void(const vk::raii::CommandBuffer&)>> recorded;  // what finish() records
  std::vector<const Kernel*> kernels;                                         // that these use
  vk::raii::CommandPool pool = nullptr;
  vk::raii::CommandBuffer commands = nullptr;
  vk::raii::Fence fence = nullptr;
  vk::raii::QueryPool queries = nullptr;
  std::uint32_t num_timestamps = 0;
  Buffer ticks;  // (num_timestamps) std::uint64_t, filled by the commands themselves
  bool finished = false;
  bool ran = false;
  bool submitted = false;
};

Commands::Commands(Context& context, std::string name, std::uint32_t num_timestamps)
    : vulkan_(std::make_unique<Vulkan>(context, std::move(name))) {
  Context::Vulkan& vk_context = context.vulkan();
  checked("recording " + vulkan_->name, "", [&] {
    const std::array<vk::DescriptorPoolSize, 4> sizes{{{vk::DescriptorType::eStorageBuffer, kMaxSets * 16},
                                                       {vk::DescriptorType::eUniformBuffer, kMaxSets * 2},
                                                       {vk::DescriptorType::eUniformTexelBuffer, kMaxSets * 4},
                                                       {vk::DescriptorType::eStorageTexelBuffer, kMaxSets}}};
    vulkan_->descriptors = vk_context.device.createDescriptorPool({vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, kMaxSets, sizes});
    vulkan_->pool = vk_context.device.createCommandPool({{}, vk_context.queue_family});
    vulkan_->commands =
        std::move(vk::raii::CommandBuffers(vk_context.device, {*vulkan_->pool, vk::CommandBufferLevel::ePrimary, 1}).front());
    vulkan_->fence = vk_context.device.createFence({});
    vk_context.name(vulkan_->commands, vulkan_->name);
    if (num_timestamps > 0 && vk_context.timestamp_bits > 0) {
      vulkan_->num_timestamps = num_timestamps;
      vulkan_->queries = vk_context.device.createQueryPool({{}, vk::QueryType::eTimestamp, num_timestamps});
      vulkan_->ticks = Buffer(context, vulkan_->name + " timestamps", num_timestamps * sizeof(std::uint64_t), Domain::kReadback);
      vulkan_->recorded.emplace_back([queries = *vulkan_->queries, num_timestamps](const vk::raii::CommandBuffer& commands) {
        commands.resetQueryPool(queries, 0, num_timestamps);
      });
    }
  });
}

Commands::~Commands() {
  if (vulkan_ == nullptr || !vulkan_->submitted) return;
  try {
    wait();
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a destructor cannot report
  }
}

Commands::Commands(Commands&&) noexcept = default;
Commands& Commands::operator=(Commands&&) noexcept = default;

void Commands::bind(const Kernel& kernel, std::span<const Buffer* const> buffers) {
  if (buffers.size() != kernel.numBuffers()) throw std::logic_error("kernel \"" + kernel.name() + "\": wrong number of buffers bound");
  Context::Vulkan& vk_context = vulkan_->context.vulkan();
  const Kernel::Vulkan& vk_kernel = kernel.vulkan();
  vk::raii::DescriptorSet set =
      std::move(vk::raii::DescriptorSets(vk_context.device, {*vulkan_->descriptors, *vk_kernel.set_layout}).front());
  std::vector<vk::DescriptorBufferInfo> infos;
  infos.reserve(buffers.size());
  std::vector<vk::WriteDescriptorSet> writes;
  for (const Buffer* buffer : buffers) {
    const vk::DescriptorType type = vk_kernel.types[writes.size()];
    const bool as_texels = type == vk::DescriptorType::eUniformTexelBuffer || type == vk::DescriptorType::eStorageTexelBuffer;
    if (as_texels) buffer->viewAsTexels(vulkan_->context);
    infos.emplace_back(*buffer->vulkan().buffer, 0, VK_WHOLE_SIZE);
    writes.emplace_back(*set, static_cast<std::uint32_t>(writes.size()), 0, 1, type, nullptr, &infos.back(),
                        as_texels ? &*buffer->vulkan().texels : nullptr);
  }
  vk_context.device.updateDescriptorSets(writes, {});
  vulkan_->kernels.push_back(&kernel);
  vulkan_->recorded.emplace_back([&vk_kernel, set = *set](const vk::raii::CommandBuffer& commands) {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *vk_kernel.pipeline.get());
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *vk_kernel.layout, 0, set, {});
  });
  vulkan_->sets.push_back(std::move(set));
}

void Commands::dispatch(const Kernel& kernel, std::uint32_t num_groups, std::span<const Buffer* const> buffers) {
  if (num_groups == 0) return;
  checked("recording " + kernel.name(), "", [&] {
    bind(kernel, buffers);
    const std::uint32_t columns = std::min(num_groups, kMaxGroupsPerDimension);
    const std::uint32_t rows = (num_groups + columns - 1) / columns;
    vulkan_->recorded.emplace_back([columns, rows](const vk::raii::CommandBuffer& commands) { commands.dispatch(columns, rows, 1); });
  });
}

void Commands::dispatchIndirect(const Kernel& kernel, const Buffer& counts, std::size_t offset, std::span<const Buffer* const> buffers) {
  checked("recording " + kernel.name(), "", [&] {
    bind(kernel, buffers);
    vulkan_->recorded.emplace_back(
        [from = *counts.vulkan().buffer, offset](const vk::raii::CommandBuffer& commands) { commands.dispatchIndirect(from, offset); });
  });
}

void Commands::barrier(Access before, Access after) {
  const vk::MemoryBarrier memory(written(before), used(after));
  vulkan_->recorded.emplace_back([before, after, memory](const vk::raii::CommandBuffer& commands) {
    commands.pipelineBarrier(stageOf(before), stageOf(after), {}, memory, {}, {});
  });
}

void Commands::copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset, std::size_t to_offset) {
  vulkan_->recorded.emplace_back([from = *from.vulkan().buffer, to = *to.vulkan().buffer,
                                  region = vk::BufferCopy(from_offset, to_offset, bytes)](const vk::raii::CommandBuffer& commands) {
    commands.copyBuffer(from, to, region);
  });
}

void Commands::fillZero(const Buffer& buffer) {
  vulkan_->recorded.emplace_back(
      [to = *buffer.vulkan().buffer](const vk::raii::CommandBuffer& commands) { commands.fillBuffer(to, 0, VK_WHOLE_SIZE, 0); });
}

void Commands::timestamp(std::uint32_t mark) {
  if (vulkan_->num_timestamps == 0) return;
  vulkan_->recorded.emplace_back([queries = *vulkan_->queries, mark](const vk::raii::CommandBuffer& commands) {
    commands.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, queries, mark);
  });
}

void Commands::end() {
  if (const std::uint32_t count = vulkan_->num_timestamps; count > 0) {
    // Copied on the device: on software Vulkan vkGetQueryPoolResults() waits until the whole queue is empty.
    vulkan_->recorded.emplace_back(
        [queries = *vulkan_->queries, count, ticks = *vulkan_->ticks.vulkan().buffer](const vk::raii::CommandBuffer& commands) {
          constexpr auto kFlags = vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait;
          commands.copyQueryPoolResults(queries, 0, count, ticks, 0, sizeof(std::uint64_t), kFlags);
        });
    barrier(Access::kCopy, Access::kHostRead);
  }
}

void Commands::finish() {
  if (vulkan_->finished) return;
  for (const Kernel* kernel : vulkan_->kernels) kernel->wait();
  checked("recording " + vulkan_->name, "", [&] {
    vulkan_->commands.begin(vk::CommandBufferBeginInfo());
    for (const auto& command : vulkan_->recorded) command(vulkan_->commands);
    vulkan_->commands.end();
  });
  vulkan_->finished = true;
  vulkan_->recorded = {};
  vulkan_->kernels = {};
  vulkan_->context.savePipelineCache();
}

void Commands::submit(const Timeline* timeline, TimelinePoints points) {
  if (vulkan_->submitted) throw std::logic_error(vulkan_->name + ": submitted twice without wait()");
  finish();
  Context::Vulkan& vk_context = vulkan_->context.vulkan();
  vk::SubmitInfo info({}, {}, *vulkan_->commands);
  const vk::TimelineSemaphoreSubmitInfo values(points.after, points.end);
  constexpr vk::PipelineStageFlags kAllStages = vk::PipelineStageFlagBits::eAllCommands;
  if (timeline != nullptr) {
    const vk::Semaphore& semaphore = *timeline->vulkan().semaphore;
    info.setWaitSemaphores(semaphore).setWaitDstStageMask(kAllStages).setSignalSemaphores(semaphore).setPNext(&values);
  }
  checked(vulkan_->submitting, "", [&] {
    const std::lock_guard lock(vk_context.queue_mutex);
    vk_context.queue.submit(info, *vulkan_->fence);
  });
  vulkan_->submitted = true;
}

void Commands::wait() {
  if (!vulkan_->submitted) return;
  Context::Vulkan& vk_context = vulkan_->context.vulkan();
  vulkan_->submitted = false;
  checked(vulkan_->name, "", [&] {
    if (vulkan_->context.info().type != DeviceType::kCpu) pollFor(kPolling, vulkan_->fence);
    const vk::Result result = vk_context.device.waitForFences(*vulkan_->fence, true, std::numeric_limits<std::uint64_t>::max());
    if (result != vk::Result::eSuccess) vk::throwResultException(result, "waitForFences");
    vk_context.device.resetFences(*vulkan_->fence);
    vulkan_->ran = true;
  });
  vulkan_->context.throwOnValidationMessage();
}

double Commands::seconds(std::uint32_t from, std::uint32_t to) const {
  if (vulkan_->num_timestamps == 0 || !vulkan_->ran) return std::numeric_limits<double>::quiet_NaN();
  const std::span<const std::uint64_t> ticks = vulkan_->ticks.mappedAs<std::uint64_t>();
  return static_cast<double>(ticks[to] - ticks[from]) * vulkan_->context.vulkan().timestamp_period;
}

}  // namespace taxelsim::gpu
