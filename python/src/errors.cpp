// taxelsim::Error as the exceptions of taxelsim.errors.
#include "bind.h"
#include "taxelsim/error.h"

namespace taxelsim::python {
namespace {

const char* classOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kInput:
      return "InputError";
    case ErrorKind::kDevice:
      return "DeviceError";
    case ErrorKind::kIo:
      return "IoError";
  }
  return "Error";
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const nb::object type = nb::module_::import_("taxelsim.errors").attr(classOf(error.kind()));
    PyErr_SetObject(type.ptr(), nb::str(error.what()).ptr());
  }
}

}  // namespace

void bindErrors(nb::module_&) {
  nb::register_exception_translator(translate);
}

}  // namespace taxelsim::python
