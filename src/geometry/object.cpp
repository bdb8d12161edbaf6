#include "taxelsim/object.h"

#include "geometry/shape_kind.h"

namespace taxelsim {

Object::Object(Shape object_shape) : name(shapeKind(object_shape)), shape(std::move(object_shape)) {}

}  // namespace taxelsim
