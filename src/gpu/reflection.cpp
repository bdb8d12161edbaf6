#include "gpu/reflection.h"

#include <spirv_cross/spirv_cross_c.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

namespace taxelsim::gpu {
namespace {

void expect(spvc_result result, spvc_context context) {
  if (result != SPVC_SUCCESS) throw std::logic_error(std::string("shader reflection: ") + spvc_context_get_last_error_string(context));
}

bool isTexelBuffer(spvc_compiler compiler, const spvc_reflected_resource& resource) {
  const spvc_type type = spvc_compiler_get_type_handle(compiler, resource.base_type_id);
  const spvc_basetype base = spvc_type_get_basetype(type);
  const bool is_image = base == SPVC_BASETYPE_IMAGE || base == SPVC_BASETYPE_SAMPLED_IMAGE;
  return is_image && spvc_type_get_image_dimension(type) == SpvDimBuffer;
}

}  // namespace

Reflection reflect(std::span<const std::uint32_t> spirv) {
  spvc_context raw = nullptr;
  if (spvc_context_create(&raw) != SPVC_SUCCESS) throw std::logic_error("shader reflection: no context");
  const std::unique_ptr<spvc_context_s, decltype(&spvc_context_destroy)> context(raw, spvc_context_destroy);
  spvc_parsed_ir ir = nullptr;
  expect(spvc_context_parse_spirv(raw, spirv.data(), spirv.size(), &ir), raw);
  spvc_compiler compiler = nullptr;
  expect(spvc_context_create_compiler(raw, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler), raw);
  spvc_resources resources = nullptr;
  expect(spvc_compiler_create_shader_resources(compiler, &resources), raw);

  Reflection reflection;
  for (int type = SPVC_RESOURCE_TYPE_UNIFORM_BUFFER; type <= SPVC_RESOURCE_TYPE_SEPARATE_SAMPLERS; ++type) {
    const spvc_reflected_resource* list = nullptr;
    std::size_t count = 0;
    expect(spvc_resources_get_resource_list_for_type(resources, static_cast<spvc_resource_type>(type), &list, &count), raw);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t set = spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationDescriptorSet);
      const std::uint32_t binding = spvc_compiler_get_decoration(compiler, list[i].id, SpvDecorationBinding);
      const std::string name = spvc_compiler_get_name(compiler, list[i].base_type_id);
      if (type == SPVC_RESOURCE_TYPE_STORAGE_BUFFER && set == 0) {
        reflection.buffers[binding] = name;
      } else if (type == SPVC_RESOURCE_TYPE_UNIFORM_BUFFER && set == 0) {
        reflection.buffers[binding] = name;
        reflection.uniform_buffers.insert(binding);
      } else if (isTexelBuffer(compiler, list[i]) && set == 0) {
        reflection.buffers[binding] = list[i].name;
        (type == SPVC_RESOURCE_TYPE_STORAGE_IMAGE ? reflection.storage_texel_buffers : reflection.texel_buffers).insert(binding);
      } else {
        reflection.others.push_back(name);
      }
    }
  }
  const spvc_specialization_constant* constants = nullptr;
  std::size_t count = 0;
  expect(spvc_compiler_get_specialization_constants(compiler, &constants, &count), raw);
  for (std::size_t i = 0; i < count; ++i) reflection.constants.push_back(constants[i].constant_id);
  std::sort(reflection.constants.begin(), reflection.constants.end());
  // The size of the workgroup is listed again where the shader reads it.
  reflection.constants.erase(std::unique(reflection.constants.begin(), reflection.constants.end()), reflection.constants.end());
  return reflection;
}

}  // namespace taxelsim::gpu
