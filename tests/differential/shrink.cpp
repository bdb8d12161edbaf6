#include "differential/shrink.h"

#include "support/test.h"

namespace taxelsim::support {
namespace {

using Change = std::function<bool(ContactSet&)>;  // false: nothing to change

double rounded(double value, int digits) {
  if (value == 0) return 0;
  const double unit = std::pow(10, std::floor(std::log10(std::abs(value))) - digits + 1);
  return std::round(value / unit) * unit;
}

// Readout settings per taxel belong to the old grid.
void forgetTaxels(Sensor& sensor) {
  sensor.readout.taxel_gain.clear();
  sensor.readout.taxel_trigger.clear();
}

bool halve(int& count) {
  if (count < 2) return false;
  count /= 2;
  return true;
}

bool keepHalf(Mesh& mesh, bool first) {
  if (mesh.triangles.size() < 2) return false;
  const auto middle = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(mesh.triangles.size() / 2);
  if (first) {
    mesh.triangles.erase(middle, mesh.triangles.end());
  } else {
    mesh.triangles.erase(mesh.triangles.begin(), middle);
  }
  return true;
}

// Removes all objects but those that the contact uses.
bool removeUnused(ContactSet& set) {
  std::vector<Object> used;
  for (int& id : set.touches[0].ids) {
    if (id == kNoObject) continue;
    used.push_back(set.objects[static_cast<std::size_t>(id)]);
    id = static_cast<int>(used.size()) - 1;
  }
  const bool changed = used.size() < set.objects.size();
  if (changed) set.objects = used;
  return changed;
}

std::vector<Change> changesOf(const ContactSet& set) {
  std::vector<Change> changes{removeUnused};
  const std::size_t num_slots = set.touches[0].ids.size();
  for (std::size_t slot = 0; num_slots > 1 && slot < num_slots; ++slot) {
    changes.emplace_back([slot](ContactSet& s) {
      s.touches[0].ids.erase(s.touches[0].ids.begin() + static_cast<std::ptrdiff_t>(slot));
      s.touches[0].X_SO.erase(s.touches[0].X_SO.begin() + static_cast<std::ptrdiff_t>(slot));
      return true;
    });
  }
  changes.emplace_back([](ContactSet& s) {
    const bool changed = s.sensor.psf.size > 1 || s.sensor.psf.sigma > 0;
    s.sensor.psf = {};
    return changed;
  });
  for (std::size_t p = 0; set.sensor.patches.size() > 1 && p < set.sensor.patches.size(); ++p) {
    changes.emplace_back([p](ContactSet& s) {
      forgetTaxels(s.sensor);
      s.sensor.patches.erase(s.sensor.patches.begin() + static_cast<std::ptrdiff_t>(p));
      return true;
    });
  }
  for (std::size_t p = 0; p < set.sensor.patches.size(); ++p) {
    for (int GridPatch::*const count : {&GridPatch::num_rows, &GridPatch::num_cols}) {
      changes.emplace_back([p, count](ContactSet& s) {
        forgetTaxels(s.sensor);
        return halve(s.sensor.patches[p].*count);
      });
    }
    changes.emplace_back([p](ContactSet& s) { return std::exchange(s.sensor.patches[p].X_SP, Pose{}) != Pose{}; });
  }
  changes.emplace_back([](ContactSet& s) { return std::exchange(s.sensor.samples_per_taxel, 1) > 1; });
  for (std::size_t slot = 0; slot < num_slots; ++slot) {
    changes.emplace_back([slot](ContactSet& s) {
      return std::exchange(s.touches[0].X_SO[slot].rotation, {1, 0, 0, 0}) != Quaternion{1, 0, 0, 0};
    });
    for (const bool first : {true, false}) {
      changes.emplace_back([slot, first](ContactSet& s) {
        const int id = s.touches[0].ids[slot];
        Mesh* mesh = id == kNoObject ? nullptr : std::get_if<Mesh>(&s.objects[static_cast<std::size_t>(id)].shape);
        return mesh != nullptr && keepHalf(*mesh, first);
      });
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int digits : {1, 2, 4}) {
        changes.emplace_back([slot, axis, digits](ContactSet& s) {
          double& coordinate = s.touches[0].X_SO[slot].position[axis];
          return std::exchange(coordinate, rounded(coordinate, digits)) != coordinate;
        });
      }
    }
  }
  return changes;
}

}  // namespace

ContactSet shrink(ContactSet set, const std::function<bool(const ContactSet&)>& differs, int max_calls) {
  bool progress = true;
  while (progress) {
    progress = false;
    for (const Change& change : changesOf(set)) {
      ContactSet smaller = set;
      if (!change(smaller)) continue;
      if (max_calls-- == 0) return set;
      if (!differs(smaller)) continue;
      set = smaller;
      progress = true;
      break;  // the other changes were those of the larger set
    }
  }
  return set;
}

std::string sceneText(const ContactSet& set) {
  std::ostringstream text;
  text.precision(17);
  text << sensorText(set.sensor);
  const Touch& touch = set.touches[0];
  for (std::size_t slot = 0; slot < touch.ids.size(); ++slot) {
    if (touch.ids[slot] == kNoObject) continue;
    const Object& object = set.objects[static_cast<std::size_t>(touch.ids[slot])];
    text << "object " << object.name << ", pose x y z qw qx qy qz:";
    for (const double value : touch.X_SO[slot].position) text << " " << value;
    for (const double value : touch.X_SO[slot].rotation) text << " " << value;
    text << "\n";
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) {
      for (const auto& v : mesh->vertices) text << "v " << v[0] << " " << v[1] << " " << v[2] << "\n";
      for (const auto& t : mesh->triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    } else if (const Sphere* sphere = std::get_if<Sphere>(&object.shape)) {
      text << "radius " << sphere->radius << "\n";
    } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&object.shape)) {
      text << "radius " << cylinder->radius << ", length " << cylinder->length << "\n";
    } else if (const Capsule* capsule = std::get_if<Capsule>(&object.shape)) {
      text << "radius " << capsule->radius << ", length " << capsule->length << "\n";
    } else if (const Box* box = std::get_if<Box>(&object.shape)) {
      text << "size " << box->size[0] << " " << box->size[1] << " " << box->size[2] << "\n";
    } else if (const Cone* cone = std::get_if<Cone>(&object.shape)) {
      text << "radius " << cone->radius << ", height " << cone->height << "\n";
    } else if (const Torus* torus = std::get_if<Torus>(&object.shape)) {
      text << "major_radius " << torus->major_radius << ", minor_radius " << torus->minor_radius << "\n";
    }
  }
  return text.str();
}

}  // namespace taxelsim::support
