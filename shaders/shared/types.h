// Types of the structs and constants that C++ and GLSL (std430) share. Every struct consists of 16-byte rows, so that both languages lay
// it out alike. In C++ the names are in taxelsim::layout.
// Frames: S sensor, P patch, O object, C chart (the frame of moments: P of a sensor of one grid patch, else S). X_PS maps S to P.
#ifndef TAXELSIM_SHADERS_SHARED_TYPES_H
#define TAXELSIM_SHADERS_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace taxelsim::layout {
using uint = std::uint32_t;
using glm::dvec2;
using glm::ivec4;
using glm::uvec4;
using glm::vec4;
}  // namespace taxelsim::layout
#define TAXELSIM_LAYOUT_BEGIN namespace taxelsim::layout {
#define TAXELSIM_LAYOUT_END }
#define TAXELSIM_CONSTANT inline constexpr uint
#define TAXELSIM_FLOAT inline constexpr float
#else
#define TAXELSIM_LAYOUT_BEGIN
#define TAXELSIM_LAYOUT_END
#define TAXELSIM_CONSTANT const uint
#define TAXELSIM_FLOAT const float
#endif

#endif
