// Checks of a scene, which need not come from a file.
#pragma once

#include <string>

#include "taxelsim/scene.h"

namespace taxelsim {

// The word of scene files.
std::string wordOf(Scene::Kind kind);

// Throws Error(kInput) with the path of the field, the value found and what is allowed.
void checkScene(const Scene& scene);

// Parts of checkScene() for settings that depend on each other; paths are relative to the block of the file.
void checkRates(const Scene& scene);                   // control_rate, a whole fraction of simulation_rate
void checkTask(const Task& task, const Scene& scene);  // criteria, duration of the episode, edges of the objects
void checkRecordedEpisodes(const Scene& scene);        // num_episodes, at most those of the recording, which it must have

// Not a part of checkScene(), because only an evaluation uses the task of a grasp. duration: s, of an episode.
void checkGraspTask(const GraspTask& task, double duration);

}  // namespace taxelsim
