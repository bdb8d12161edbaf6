// Tables of fields (base/field.h) of shapes and of the options of mesh files. checkObject(), loadMesh() and the reader of scenes use them.
#pragma once

#include <array>
#include <string_view>

#include "base/field.h"
#include "taxelsim/object.h"

namespace taxelsim {

inline constexpr Allowed kLength = Allowed::above(0, "m");

inline constexpr std::array kSphereFields{Field<Sphere>{"radius[_mm]", &Sphere::radius, kLength, kRequired, "Radius"}};
inline constexpr std::array kCylinderFields{
    Field<Cylinder>{"radius[_mm]", &Cylinder::radius, kLength, kRequired, "Radius"},
    Field<Cylinder>{"length[_mm]", &Cylinder::length, kLength, kRequired, "Length along z"},
};
inline constexpr std::array kCapsuleFields{
    Field<Capsule>{"radius[_mm]", &Capsule::radius, kLength, kRequired, "Radius"},
    Field<Capsule>{"length[_mm]", &Capsule::length, Allowed::atLeast(0, "m"), kRequired, "Length of the straight part along z"},
};
inline constexpr std::array kBoxFields{Field<Box>{"size[_mm]", &Box::size, kLength, kRequired, "Full sides along x, y and z"}};
inline constexpr std::array kConeFields{
    Field<Cone>{"radius[_mm]", &Cone::radius, kLength, kRequired, "Radius of the base at z = height"},
    Field<Cone>{"height[_mm]", &Cone::height, kLength, kRequired, "Height"},
};
inline constexpr std::array kTorusFields{
    Field<Torus>{"major_radius[_mm]", &Torus::major_radius, kLength, kRequired,
                 "Radius from the centre to the middle of the tube, above minor_radius"},
    Field<Torus>{"minor_radius[_mm]", &Torus::minor_radius, kLength, kRequired, "Radius of the tube"},
};

inline constexpr std::array kMeshScaleFields{
    Field<MeshOptions>{"scale", &MeshOptions::scale, Allowed::above(0, "m per unit of the file"), kOptional, "Metres per unit of the file"},
};
inline constexpr std::array<std::string_view, 3> kUpAxisNames{"x", "y", "z"};  // in the order of UpAxis
inline constexpr std::array kMeshSizeFields{
    Field<MeshOptions>{"size", &MeshOptions::size, Allowed::above(0, "m"), kOptional, "Longest side of the bounding box"}};
inline constexpr std::array kMeshErrorFields{
    Field<MeshOptions>{"max_depth_error[_mm]", &MeshOptions::max_depth_error, Allowed::atLeast(0, "m"), kOptional,
                       "Largest Hausdorff distance of the simplified surface; 0 keeps every triangle"},
};

}  // namespace taxelsim
