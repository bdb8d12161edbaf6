// Arguments that also take what is easier to write: the name of an enumerator for its value, one number for two equal ones.
#pragma once

#include <nanobind/stl/array.h>

#include <array>
#include <type_traits>

#include "bind.h"

namespace taxelsim::python {

template <typename Value>
struct Argument {
  Value value;
};

template <typename Value>
inline constexpr bool kHasShortForm = std::is_enum_v<Value> || std::is_same_v<Value, std::array<double, 2>>;

// Type of a parameter for a value of type `Value`.
template <typename Value>
using ArgumentFor = std::conditional_t<kHasShortForm<Value>, Argument<Value>, Value>;

template <typename Value>
const Value& valueOf(const Argument<Value>& argument) {
  return argument.value;
}
template <typename Value>
const Value& valueOf(const Value& value) {
  return value;
}

}  // namespace taxelsim::python

namespace nanobind::detail {

template <typename T>
struct type_caster<taxelsim::python::Argument<T>> {
  NB_TYPE_CASTER(taxelsim::python::Argument<T>, make_caster<T>::Name + const_name<std::is_enum_v<T>>(" | str", " | float"))

  bool from_python(handle source, uint32_t flags, cleanup_list* cleanup) noexcept {
    object named;
    if constexpr (std::is_enum_v<T>) {
      if (isinstance<str>(source)) {
        named = steal(PyObject_CallMethod(source.ptr(), "upper", nullptr));
        named = getattr(type<T>(), named, none());
        source = named;
      }
    } else if (make_caster<double> number; number.from_python(source, flags, cleanup)) {
      value.value.fill(number.value);
      return true;
    }
    make_caster<T> caster;
    if (!caster.from_python(source, flags, cleanup)) return false;
    value.value = caster.value;
    return true;
  }
};

}  // namespace nanobind::detail
