// Cases of the comparison by name: objects, arrays and poses.
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
  std::string note;                                 // differences between peers; empty: none
  std::vector<Object> objects;                      // of all peers but Embree
  std::vector<std::shared_ptr<const Mesh>> meshes;  // (num_objects), for Embree, which knows triangles only
  std::size_t num_triangles = 0;                    // over all objects
  double depth_tolerance = 0;                       // m, deviation of Embree's surface from the others'
  bool embree_only = false;                         // other peers run the case of the same name without "_full"
  double load_seconds = 0;                          // s, for loadMesh() to read and simplify
  bool slides = false;                              // frames follow each other in small steps; else each has other poses
  Poses poses;

  std::size_t numInstances() const { return poses.ids.size(); }
};

// The frames of one turn. Sliding objects: several, continuing those of the previous turn. Others: one, with the poses shifted to other
// instances than in the previous turn.
std::vector<Poses> framesOf(const Case& work, int turn);

// All cases, in running order.
std::vector<std::string> caseNames();

// The sensor with the rows and columns of `array`, such as "6x14". Throws Error(kInput) for other text.
Sensor withArray(const Sensor& sensor, const std::string& array);

// Makes cases. Caches meshes, since a fine one takes seconds.
class CaseMaker {
 public:
  // `objects`: the folder scenes/objects.
  explicit CaseMaker(std::string objects) : objects_(std::move(objects)) {}

  // Throws Error(kInput) for an unknown name.
  Case make(const std::string& full_name, const Sensor& sensor, int num_instances);

 private:
  struct Kept {
    std::shared_ptr<const Mesh> mesh;
    double load_seconds = 0;
  };
  const Kept& shipped(const std::string& file, const MeshOptions& options);
  const Kept& ellipsoid(int levels);   // 20 x 4^levels triangles
  const Kept& simplified(int levels);  // the same, simplified by loadMesh()
  void addPrism(Case& work);
  void addEllipsoid(Case& work, const char* name, int levels);
  void addSimplified(Case& work, int levels, bool full_for_embree);
  bool addShipped(Case& work, const std::string& name);  // false for another name
  void addObjects(Case& work, const std::string& name);

  std::string objects_;
  std::map<std::string, Kept> kept_;
};

}  // namespace taxelsim::bench
