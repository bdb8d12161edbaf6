// Settings structs of the library as immutable Python classes.
//
// Constructors have the defaults of C++, or defaults that follow from other fields, and take keywords; one or two fields also by position.
// Fields are read-only; replace() makes a changed copy. The classes compare by value, pickle, and print as the call that makes them.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "argument.h"
#include "base/field.h"
#include "bind.h"

namespace taxelsim::python {

template <typename Struct, typename Member>
struct Field {
  using Parameter = ArgumentFor<Member>;  // taken by the constructor

  const char* name;
  Member Struct::*member;
  const char* doc;

  Member defaultOf(const Struct& defaults) const { return defaults.*member; }
  void assign(Struct& self, const Parameter& value) const { self.*member = valueOf(value); }
  void derive(Struct&, const Parameter&) const {}
};

template <typename Struct, typename Member>
Field<Struct, Member> field(const char* name, Member Struct::*member, const char* doc) {
  return {name, member, doc};
}

// Gives "(3), " for a member that is an array.
template <typename Struct, typename Member>
std::string shapeOf(Member Struct::*) {
  return "";
}
template <typename Struct, typename Element, std::size_t kSize>
std::string shapeOf(std::array<Element, kSize> Struct::*) {
  return "(" + std::to_string(kSize) + "), ";
}

// A field of a table of the library, with its meaning and what is allowed.
template <const auto& kTable, std::size_t kIndex>
auto tableField() {
  constexpr auto kMember = std::get<kTable[kIndex].member.index()>(kTable[kIndex].member);
  constexpr bool kIsWhole = kTable[kIndex].member.index() == 1;  // int
  static const std::string name(kTable[kIndex].name());
  static const std::string doc = std::string(kTable[kIndex].text) + ": " + shapeOf(kMember) +
                                 (kIsWhole ? describeWhole(kTable[kIndex].allowed) : describe(kTable[kIndex].allowed)) + ".";
  return field(name.c_str(), kMember, doc.c_str());
}

// All fields of a table.
template <const auto& kTable>
auto fieldsOf() {
  return []<std::size_t... kIndices>(std::index_sequence<kIndices...>) {
    return std::tuple(tableField<kTable, kIndices>()...);
  }
  (std::make_index_sequence<kTable.size()>());
}

// A field whose default follows from the others.
template <typename Struct, typename Member>
struct DerivedField {
  using Parameter = std::optional<Member>;

  const char* name;
  Member Struct::*member;
  const char* doc;
  Member (*otherwise)(const Struct&);

  Parameter defaultOf(const Struct&) const { return {}; }
  void assign(Struct& self, const Parameter& value) const { self.*member = value.value_or(Member{}); }
  void derive(Struct& self, const Parameter& value) const {
    if (!value) self.*member = otherwise(self);
  }
};

template <typename Struct, typename Member>
DerivedField<Struct, Member> derivedField(const char* name, Member Struct::*member, Member (*otherwise)(const Struct&), const char* doc) {
  return {name, member, doc, otherwise};
}

// Adds `_fields`, replace(), __eq__, __repr__ and __reduce__ to a class whose constructor, bound before, takes the fields as keywords.
void addValueSemantics(nb::handle type, const nb::tuple& names);

// Adds constructor and fields. The casters of all members must be included, and classes among them bound before. made(struct) is called
// with every struct that the constructor makes.
template <typename Struct, typename Made, typename... Fields>
void addCheckedFields(nb::class_<Struct>& type, Made made, Fields... fields) {
  if constexpr (sizeof...(Fields) == 0) {
    type.def(nb::init<>());
  } else {
    const Struct defaults{};
    const auto make = [made, fields...](Struct* self, const typename Fields::Parameter&... values) {
      new (self) Struct{};
      (fields.assign(*self, values), ...);
      (fields.derive(*self, values), ...);
      made(*self);
    };
    if constexpr (sizeof...(Fields) <= 2) {
      type.def("__init__", make, (nb::arg(fields.name) = fields.defaultOf(defaults))...);
    } else {
      type.def("__init__", make, nb::kw_only(), (nb::arg(fields.name) = fields.defaultOf(defaults))...);
    }
  }
  (type.def_ro(fields.name, fields.member, fields.doc), ...);
  addValueSemantics(type, nb::make_tuple(fields.name...));
}
template <typename Struct, typename... Fields>
void addFields(nb::class_<Struct>& type, Fields... fields) {
  addCheckedFields(
      type, [](const Struct&) {}, fields...);
}

// The same from tuples of fields.
template <typename Struct, typename Made, typename... Tuples>
void addCheckedTables(nb::class_<Struct>& type, Made made, Tuples... tuples) {
  std::apply([&](auto... fields) { addCheckedFields(type, made, fields...); }, std::tuple_cat(tuples...));
}
template <typename Struct, typename... Tuples>
void addTables(nb::class_<Struct>& type, Tuples... tuples) {
  addCheckedTables(
      type, [](const Struct&) {}, tuples...);
}

}  // namespace taxelsim::python
