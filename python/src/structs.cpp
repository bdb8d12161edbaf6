#include "structs.h"

#include <nanobind/stl/string.h>

#include <regex>
#include <string>

namespace taxelsim::python {
namespace {

nb::dict fieldsOf(nb::handle self) {
  nb::dict fields;
  for (nb::handle name : nb::tuple(self.type().attr("_fields"))) fields[name] = self.attr(name);
  return fields;
}

nb::object replaced(nb::handle self, const nb::kwargs& changes) {
  nb::dict fields = fieldsOf(self);
  fields.update(changes);
  return self.type()(**fields);
}

bool equal(nb::handle self, nb::handle other) {
  return self.type().is(other.type()) && fieldsOf(self).equal(fieldsOf(other));
}

std::string textOf(nb::handle self) {
  std::string text = nb::cast<std::string>(self.type().attr("__name__")) + "(";
  bool first = true;
  for (const auto& [name, value] : fieldsOf(self)) {
    text += (first ? "" : ", ") + nb::cast<std::string>(name) + "=" + nb::cast<std::string>(nb::repr(value));
    first = false;
  }
  return text + ")";
}

nb::tuple reduced(nb::handle self) {
  const nb::object make = nb::module_::import_("functools").attr("partial")(self.type(), **fieldsOf(self));
  return nb::make_tuple(make, nb::tuple());
}

// "def replace(self, *, radius: float = ...) -> typing_extensions.Self" from the signature of the constructor, whose defaults are numbered.
std::string signatureOfReplace(nb::handle type) {
  const auto constructor = nb::cast<std::string>(nb::tuple(nb::tuple(type.attr("__init__").attr("__nb_signature__"))[0])[0]);
  const std::string begin = "def __init__(self, ", keywords_only = "*, ";
  if (constructor.rfind(begin, 0) != 0) return "def replace(self) -> typing_extensions.Self";
  std::string fields = constructor.substr(begin.size(), constructor.rfind(')') - begin.size());
  if (fields.rfind(keywords_only, 0) != 0) fields.insert(0, keywords_only);
  return "def replace(self, " + std::regex_replace(fields, std::regex(R"(= \\=?\d+)"), "= ...") + ") -> typing_extensions.Self";
}

}  // namespace

void addValueSemantics(nb::handle type, const nb::tuple& names) {
  type.attr("_fields") = names;
  const auto method = [&](const char* name, auto function, const char* signature, auto... extra) {
    nb::setattr(type, name, nb::cpp_function(function, nb::name(name), nb::scope(type), nb::is_method(), nb::sig(signature), extra...));
  };
  method("replace", &replaced, signatureOfReplace(type).c_str(), "A copy with some fields changed, given as keywords.");
  method("__eq__", &equal, "def __eq__(self, other: object, /) -> bool", nb::is_operator());
  method("__repr__", &textOf, "def __repr__(self) -> str");
  method("__reduce__", &reduced, "def __reduce__(self) -> tuple[typing.Any, ...]");
  type.attr("__hash__") = nb::none();
}

}  // namespace taxelsim::python
