// Simulator::vjp(): hands the gradient of a loss by forces to the device, shaders/force_gradient.comp.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/length_check.h"
#include "base/text.h"
#include "simulation/simulator_impl.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// `value(i)`: of taxel i of (num_instances x num_taxels). Throws Error(kInput) for the first that is not finite.
template <typename Value>
void checkFinite(const char* name, std::size_t num_values, std::size_t num_taxels, Value value) {
  for (std::size_t i = 0; i < num_values; ++i) {
    if (std::isfinite(value(i))) continue;
    throw Error(ErrorKind::kInput, std::string(name) + " of instance " + std::to_string(i / num_taxels) + ", taxel " +
                                       std::to_string(i % num_taxels) + ": " + numberText(static_cast<double>(value(i))) +
                                       " is not allowed: finite numbers");
  }
}

}  // namespace

gpu::Commands& Simulator::Impl::gradientCommands(bool with_gains) {
  std::optional<gpu::Commands>& list = recorded_gradients[(with_gains ? 1u : 0u) + 2 * half];
  if (!list) list = recordGradient(implOf(model), {data(), options, keeps_candidates}, buffers, with_gains, half);
  return *list;
}

GradientView Simulator::vjp(std::span<const float> cotangent, std::span<const float> gain) {
  Impl& impl = *impl_;
  if (!impl.options.outputs.vjp) throw Error(ErrorKind::kInput, "vjp() needs a simulator with outputs.vjp: true");
  impl.ownInputs();
  if (impl.isRunning()) throw std::logic_error("vjp() was called before read() of the last step");
  if (!impl.has_frame) throw std::logic_error("vjp() was called before the first frame: call step() and read() first");
  const auto n = static_cast<std::size_t>(impl.options.num_instances);
  const std::size_t num_taxels = impl.data().num_taxels;
  const std::size_t num_values = n * num_taxels;
  checkLength("cotangent", cotangent.size(), num_values);
  if (!gain.empty()) checkLength("gain", gain.size(), num_values);
  checkFinite("cotangent", num_values, num_taxels, [&](std::size_t i) { return cotangent[i]; });
  checkFinite("gain", gain.size(), num_taxels, [&](std::size_t i) { return gain[i]; });
  const auto product = [&](std::size_t i) { return cotangent[i] * gain[i]; };
  checkFinite("cotangent x gain", gain.size(), num_taxels, product);
  std::copy(cotangent.begin(), cotangent.end(), impl.buffers.input<block::Cotangents>().begin());
  const std::span<float> products = impl.buffers.input<block::ForceCotangents>();
  for (std::size_t i = 0; i < gain.size(); ++i) products[i] = product(i);
  gpu::Commands& commands = impl.gradientCommands(!gain.empty());
  impl.traffic.bytes_to_device += (cotangent.size() + gain.size()) * sizeof(float);
  impl.submit(commands, kAfterGradient);
  commands.wait();
  impl.checkLoops();
  return {impl.buffers.output<block::TwistGradient>().first(6 * n), impl.buffers.output<block::GainGradient>().first(num_values)};
}

}  // namespace taxelsim
