#include "gpu/kernel.h"

#include <algorithm>
#include <functional>
#include <future>
#include <stdexcept>

#include "gpu/reflection.h"
#include "gpu/vulkan_buffer.h"

namespace taxelsim::gpu {
namespace {

void checkInterface(const KernelOptions& options, const Reflection& reflection) {
  const std::string where = "kernel \"" + options.name + "\": ";
  if (!reflection.others.empty())
    throw std::logic_error(where + "resource \"" + reflection.others.front() + "\" is no storage, uniform or texel buffer of set 0");
  for (std::size_t i = 0; i < options.buffers.size(); ++i) {
    const auto found = reflection.buffers.find(static_cast<std::uint32_t>(i));
    const std::string shader_name = found == reflection.buffers.end() ? "nothing" : "\"" + found->second + "\"";
    if (found == reflection.buffers.end() || found->second != options.buffers[i]) {
      throw std::logic_error(where + "binding " + std::to_string(i) + " is declared as \"" + options.buffers[i] + "\", the shader has " +
                             shader_name);
    }
  }
  if (reflection.buffers.size() != options.buffers.size()) {
    throw std::logic_error(where + "the shader has " + std::to_string(reflection.buffers.size()) + " buffers, " +
                           std::to_string(options.buffers.size()) + " are declared");
  }
  std::vector<std::uint32_t> ids;
  for (const Constant& constant : options.constants) ids.push_back(constant.id);
  std::sort(ids.begin(), ids.end());
  if (ids != reflection.constants) throw std::logic_error(where + "specialization constants differ from the shader's");
}

vk::raii::Pipeline compiled(Context::Vulkan& context, const KernelOptions& options, vk::PipelineLayout layout) {
  return checked("building kernel " + options.name, "", [&] {
    const std::vector<std::uint32_t> words = specialize(options.spirv, options.constants);
    const vk::raii::ShaderModule module = context.device.createShaderModule({{}, words.size() * sizeof(words[0]), words.data()});
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
    vk::raii::Pipeline pipeline = context.device.createComputePipeline(context.pipeline_cache, {{}, stage, layout});
    context.name(pipeline, options.name);
    context.pipelines_changed = true;
    return pipeline;
  });
}

}  // namespace

Kernel::Kernel(Context& context, const KernelOptions& options)
    : vulkan_(std::make_unique<Vulkan>()), name_(options.name), num_buffers_(options.buffers.size()) {
  const Reflection reflection = reflect(options.spirv);
  checkInterface(options, reflection);
  Context::Vulkan& vk_context = context.vulkan();
  checked("building kernel " + name_, "", [&] {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < num_buffers_; ++i) {
      vulkan_->types.push_back(reflection.uniform_buffers.contains(i)         ? vk::DescriptorType::eUniformBuffer
                               : reflection.texel_buffers.contains(i)         ? vk::DescriptorType::eUniformTexelBuffer
                               : reflection.storage_texel_buffers.contains(i) ? vk::DescriptorType::eStorageTexelBuffer
                                                                              : vk::DescriptorType::eStorageBuffer);
      bindings.emplace_back(i, vulkan_->types.back(), 1, vk::ShaderStageFlagBits::eCompute);
    }
    vulkan_->set_layout = vk_context.device.createDescriptorSetLayout({{}, bindings});
    vulkan_->layout = vk_context.device.createPipelineLayout({{}, *vulkan_->set_layout});
  });
  vulkan_->pipeline = std::async(std::launch::async, compiled, std::ref(vk_context), options, *vulkan_->layout).share();
}

void Kernel::wait() const {
  vulkan_->pipeline.get();
}

Kernel::Kernel() = default;
Kernel::~Kernel() = default;
Kernel::Kernel(Kernel&&) noexcept = default;
Kernel& Kernel::operator=(Kernel&&) noexcept = default;

}  // namespace taxelsim::gpu
