// The keys of scenes (scene/keys/block.h).
#pragma once

#include <array>
#include <string_view>

#include "scene/keys/block.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// In the order of Scene::Kind.
inline constexpr std::array<std::string_view, 4> kSceneKindNames{"servo", "contacts", "grasp", "contact_points"};

const Block& sceneKeys(Scene::Kind kind);

const Block& conditionKeys();
const Block& graspConditionKeys();        // kind grasp
const Block& randomizationKeys();         // kind contacts
const Block& servoRandomizationKeys();    // kind servo
const Block& graspRandomizationKeys();    // kind grasp
const Block& readoutRandomizationKeys();  // kind contact_points

}  // namespace taxelsim
