// Constants of a run, shared by all its batches of episodes.
#pragma once

#include <vector>

#include "episodes/draw.h"
#include "episodes/true_edge.h"
#include "taxelsim/device.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

inline bool hasContactFeatures(const OutputOptions& outputs) {
  return outputs.contact_features || outputs.clean_contact_features;
}

struct EpisodePlan {
  // read_outputs: optional outputs that are read. `scene_to_run` must outlive this.
  EpisodePlan(const Scene& scene_to_run, const OutputOptions& read_outputs, int num_regions);

  const Scene& scene;
  EpisodeDrawer drawer;
  OutputOptions outputs;
  int max_regions;              // rows of regions, if contact features are computed
  int num_sensors;              // per robot, and simulator instances per instance of the batch
  int num_joints;               // per robot; 0 for FreeFlying
  int num_frames;               // per episode
  double dt;                    // s, between frames
  int control_period;           // frames
  std::vector<TrueEdge> edges;  // (num_objects)
  bool starts_at_load;          // the force of the first frame is the load, as the taxels' forces on a level skin sum to it
  bool device_clock = false;    // whether the simulator measures its times
  bool export_memory = false;   // whether another interface of the device imports outputs
  int host_threads = 0;         // that share the host's work for a batch; 0: hostThreads()

  SimulatorOptions simulatorOptions(int num_instances) const;
};

}  // namespace taxelsim
