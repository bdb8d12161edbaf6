// Tables of fields (base/field.h) of shapes and of the options of mesh files. checkObject(), loadMesh() and the reader of scenes use them.
#pragma once

#include <array>

#include "base/field.h"
#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr Allowed kLength = Allowed::above(0, "m");

inline constexpr std::array kSphereFields{Field<Sphere>{"radius[_mm]", &Sphere::radius, kLength, kRequired}};
inline constexpr std::array kCylinderFields{
    Field<Cylinder>{"radius[_mm]", &Cylinder::radius, kLength, kRequired},
    Field<Cylinder>{"length[_mm]", &Cylinder::length, kLength, kRequired},
};
inline constexpr std::array kCapsuleFields{
    Field<Capsule>{"radius[_mm]", &Capsule::radius, kLength, kRequired},
    Field<Capsule>{"length[_mm]", &Capsule::length, Allowed::atLeast(0, "m"), kRequired},
};
inline constexpr std::array kBoxFields{Field<Box>{"size[_mm]", &Box::size, kLength, kRequired}};
inline constexpr std::array kConeFields{
    Field<Cone>{"radius[_mm]", &Cone::radius, kLength, kRequired},
    Field<Cone>{"height[_mm]", &Cone::height, kLength, kRequired},
};
inline constexpr std::array kTorusFields{
    Field<Torus>{"major_radius[_mm]", &Torus::major_radius, kLength, kRequired},
    Field<Torus>{"minor_radius[_mm]", &Torus::minor_radius, kLength, kRequired},
};

inline constexpr std::array kMeshScaleFields{
    Field<MeshOptions>{"scale", &MeshOptions::scale, Allowed::above(0, "m per unit of the file")},
};
inline constexpr std::array kMeshSizeFields{Field<MeshOptions>{"size", &MeshOptions::size, Allowed::above(0, "m")}};
inline constexpr std::array kMeshErrorFields{
    Field<MeshOptions>{"max_depth_error[_mm]", &MeshOptions::max_depth_error, Allowed::atLeast(0, "m")},
};

}  // namespace taxelsim
