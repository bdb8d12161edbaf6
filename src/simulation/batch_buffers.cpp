#include "simulation/batch_buffers.h"

#include <string>

namespace taxelsim {

BatchBuffers::BatchBuffers(const BatchShape& shape) {
  for (const BatchArray& array : batchArrays()) {
    arrays_[array.block_index] = makeArray(shape, array);
    if (array.is_double && shape.options.export_memory) second_[array.block_index] = makeArray(shape, array);
    for (std::size_t half = 0; half < 2; ++half) {
      const Array& made = at(array.block_index, half);
      outputs_[half].set(array.block_index, made.isCopied() ? made.readback.mapped() : made.device.mapped());
    }
  }
}

BatchBuffers::Array BatchBuffers::makeArray(const BatchShape& shape, const BatchArray& array) const {
  gpu::Context& context = shape.model.context();
  const std::uint64_t rows = array.per_instance ? static_cast<std::uint64_t>(shape.options.num_instances) : 1;
  const std::uint64_t bytes = rows * array.bytes(shape);
  const gpu::Sharing sharing = array.isExported(shape.options) ? gpu::Sharing::kExported : gpu::Sharing::kPrivate;
  Array made{gpu::Buffer(context, array.name, bytes, array.domain, sharing), {}};
  if (array.isForHost(shape.options) && made.device.mapped().empty()) {
    made.readback = gpu::Buffer(context, std::string(array.name) + " readback", bytes, gpu::Domain::kReadback);
  }
  return made;
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

void BatchBuffers::bindTo(gpu::Bindings& bindings, std::size_t half) const {
  for (const BatchArray& array : batchArrays()) bindings.bind(array.block_index, at(array.block_index, half).device);
}

std::uint64_t BatchBuffers::bytesRead(const BatchOptions& options, ReadAfter after) const {
  std::uint64_t bytes = 0;
  for (const BatchArray& array : batchArrays()) {
    if (array.isRead(options, after)) bytes += arrays_[array.block_index].device.size();
  }
  return bytes;
}

void BatchBuffers::recordReadback(gpu::Commands& commands, const BatchOptions& options, ReadAfter after, std::size_t half) const {
  commands.barrier(gpu::Access::kKernel, gpu::Access::kCopy);
  for (const BatchArray& array : batchArrays()) {
    const Array& found = at(array.block_index, half);
    if (found.isCopied() && array.isRead(options, after)) commands.copy(found.device, found.readback, found.device.size());
  }
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kHostRead);
}

}  // namespace taxelsim
