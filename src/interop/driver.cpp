#include "interop/driver.h"

#include <dlfcn.h>

#include <string>

#include "taxelsim/error.h"

namespace taxelsim::interop {
namespace {

Driver load(const char* file, bool is_cuda) {
  void* const library = ::dlopen(file, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    throw Error(ErrorKind::kDevice,
                std::string("memory of the device cannot be shared: ") + file + ", which the driver of the GPU installs, was not found");
  }
  Driver driver;
  const auto find = [&](auto& call, const char* name) {
    call = reinterpret_cast<std::remove_reference_t<decltype(call)>>(::dlsym(library, name));
    if (call == nullptr) throw Error(ErrorKind::kDevice, std::string(file) + " has no " + name + "; install a newer driver");
  };
// NOLINTNEXTLINE(bugprone-macro-parentheses): arguments are names
#define TAXELSIM_FIND(field, arguments, cuda, hip) find(driver.field, is_cuda ? cuda : hip);
  TAXELSIM_DRIVER_CALLS(TAXELSIM_FIND)
#undef TAXELSIM_FIND
  driver.check(driver.init(0), "init");
  return driver;
}

}  // namespace

void Driver::check(int result, const char* call) const {
  if (result == 0) return;
  const char* text = nullptr;
  const bool has_text = errorText(result, &text) == 0 && text != nullptr;
  throw Error(ErrorKind::kDevice, std::string("sharing memory with the GPU's driver: ") + call + " failed with " + std::to_string(result) +
                                      (has_text ? std::string(": ") + text : ""));
}

const Driver& driverOf(Platform platform) {
  if (platform == Platform::kHip) {
    static const Driver hip = load("libamdhip64.so", false);
    return hip;
  }
  static const Driver cuda = load("libcuda.so.1", true);
  return cuda;
}

}  // namespace taxelsim::interop
