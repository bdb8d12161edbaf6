// Settings structs of the library as immutable Python classes.
//
// Constructors take keywords only, with the defaults of C++. Fields are read-only; replace() makes a changed copy. The classes compare by
// value, pickle, and print as the call that makes them.
#pragma once

#include <nanobind/nanobind.h>

#include <new>
#include <string_view>

#include "bind.h"

namespace taxelsim::python {

template <typename Struct, typename Member>
struct Field {
  const char* name;
  Member Struct::*member;
  const char* doc;
};

template <typename Struct, typename Member>
Field<Struct, Member> field(const char* name, Member Struct::*member, const char* doc) {
  return {name, member, doc};
}

// Adds `_fields`, replace(), __eq__, __repr__ and __reduce__ to a class whose constructor takes the fields as keywords.
void addValueSemantics(nb::handle type, const nb::tuple& names);

// Adds constructor and fields. The casters of all members must be included, and classes among them bound before.
template <typename Struct, typename... Members>
void addFields(nb::class_<Struct>& type, Field<Struct, Members>... fields) {
  if constexpr (sizeof...(Members) == 0) {
    type.def(nb::init<>());
  } else {
    const Struct defaults{};
    type.def(
        "__init__",
        [... members = fields.member](Struct* self, const Members&... values) {
          new (self) Struct{};
          ((self->*members = values), ...);
        },
        nb::kw_only(), (nb::arg(fields.name) = defaults.*fields.member)...);
  }
  (type.def_ro(fields.name, fields.member, fields.doc), ...);
  addValueSemantics(type, nb::make_tuple(fields.name...));
}

}  // namespace taxelsim::python
