#include "simulation/batch_buffers.h"

#include <string>

namespace taxelsim {

BatchBuffers::BatchBuffers(const BatchShape& shape) {
  gpu::Context& context = shape.model.context();
  for (const BatchArray& array : batchArrays()) {
    const std::uint64_t rows = array.per_instance ? static_cast<std::uint64_t>(shape.options.num_instances) : 1;
    const std::uint64_t bytes = rows * array.bytes(shape);
    Array& made = arrays_[array.block_index];
    const bool is_exported = array.isExported(shape.options);
    made.device = gpu::Buffer(context, array.name, bytes, array.domain, is_exported ? gpu::Sharing::kExported : gpu::Sharing::kPrivate);
    if (array.isForHost(shape.options) && made.device.mapped().empty()) {
      made.readback = gpu::Buffer(context, std::string(array.name) + " readback", bytes, gpu::Domain::kReadback);
    }
    outputs_.set(array.block_index, made.isCopied() ? made.readback.mapped() : made.device.mapped());
  }
}

OutputArrays BatchBuffers::exportArrays(const BatchShape& shape, bool inputs, const ImportMemory& import) const {
  OutputArrays imported;
  for (const BatchArray& array : batchArrays()) {
    if (!array.isExported(shape.options) || (array.exports == Export::kInput) != inputs) continue;
    const gpu::Buffer& buffer = arrays_[array.block_index].device;
    const gpu::ExportedMemory memory = buffer.exportMemory(shape.model.context());
    imported.set(array.block_index, {static_cast<const std::byte*>(import(memory.descriptor, memory.bytes)), buffer.size()});
  }
  return imported;
}

void BatchBuffers::bindTo(gpu::Bindings& bindings) const {
  for (const BatchArray& array : batchArrays()) bindings.bind(array.block_index, arrays_[array.block_index].device);
}

std::uint64_t BatchBuffers::bytesRead(const BatchOptions& options, ReadAfter after) const {
  std::uint64_t bytes = 0;
  for (const BatchArray& array : batchArrays()) {
    if (array.isRead(options, after)) bytes += arrays_[array.block_index].device.size();
  }
  return bytes;
}

void BatchBuffers::recordReadback(gpu::Commands& commands, const BatchOptions& options, ReadAfter after) const {
  commands.barrier(gpu::Access::kKernel, gpu::Access::kCopy);
  for (const BatchArray& array : batchArrays()) {
    const Array& found = arrays_[array.block_index];
    if (found.isCopied() && array.isRead(options, after)) commands.copy(found.device, found.readback, found.device.size());
  }
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kHostRead);
}

}  // namespace taxelsim
