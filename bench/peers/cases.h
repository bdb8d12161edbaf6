// What the peers are compared on: objects, arrays and poses, by name.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

struct Poses {
  std::vector<int> ids;    // (num_instances), indices into objects
  std::vector<Pose> X_SO;  // (num_instances)
};

struct Case {
  std::string name;
  std::string note;                                 // what differs from one peer to another; empty: nothing
  std::vector<Object> objects;                      // for everybody but Embree
  std::vector<std::shared_ptr<const Mesh>> meshes;  // (num_objects): the same for Embree, which has triangles alone
  std::size_t num_triangles = 0;                    // of all objects
  double depth_tolerance = 0;                       // m: by how much Embree's surface may lie off the others'
  bool embree_only = false;                         // the other peers would do the case of the same name without "_full" again
  double load_seconds = 0;                          // of meshes that were read as loadMesh() does, simplifying them
  bool slides = false;                              // frames follow each other in small steps; else each has other poses
  Poses poses;

  std::size_t numInstances() const { return poses.ids.size(); }
};

// The frames of one turn: of objects that slide several, which go on from those of the turn before; else one, with the poses handed to
// other instances than in the turn before.
std::vector<Poses> framesOf(const Case& work, int turn);

// In the order in which they run, and those that run unless others are asked for.
std::vector<std::string> caseNames();

// The sensor with as many rows and columns as "6x14" says, nothing else changed. Throws Error(kInput) for text that does not.
Sensor withArray(const Sensor& sensor, const std::string& array);

// Makes cases and keeps their meshes, which may take long to make.
class CaseMaker {
 public:
  // The file of the prism.
  explicit CaseMaker(std::string prism) : prism_(std::move(prism)) {}

  // Throws Error(kInput) for an unknown name.
  Case make(const std::string& full_name, const Sensor& sensor, int num_instances);

 private:
  struct Kept {
    std::shared_ptr<const Mesh> mesh;
    double load_seconds = 0;
  };
  const Kept& prism();
  const Kept& ellipsoid(int levels);   // of 20 x 4^levels triangles
  const Kept& simplified(int levels);  // the same as loadMesh() gives it

  std::string prism_;
  std::map<std::string, Kept> kept_;
};

}  // namespace taxelsim::bench
