// What the scene of a data set says about its sensor and its objects.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "taxelsim/dataset.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::figures {

// The sensor, whole; of a scene of kind grasp the one of that name. None for a scene without it, or whose taxels are in another file (a
// mesh, a URDF).
std::optional<Sensor> recordedSensor(const Manifest& manifest, const std::string& name = "");

// Number of objects of the scene.
std::size_t numRecordedObjects(const Manifest& manifest);

// Object `index` of the scene, its mesh simplified within `max_depth_error` (m). `assets`: folders, searched with their subfolders for the
// mesh by name and SHA-256. Throws Error(kInput) for an object that the scene does not have, and a mesh that is not found; no other file is
// opened.
Object recordedObject(const Manifest& manifest, std::size_t index, std::span<const std::filesystem::path> assets, double max_depth_error);

}  // namespace taxelsim::figures
