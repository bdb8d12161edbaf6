#version 460
#extension GL_GOOGLE_include_directive : require
// Objects, poses and loads, or contact points, that another interface has written to memory of the device: the records that passes read, as
// the host writes them.
//
// An invocation owns an instance.
// In:  input_ids (num_instances x SLOTS), input_poses (num_instances x SLOTS x 7: position, m, rotation w, x, y, z), input_loads, N, NaN
//      for none; features of the frame before: how far a load search has moved the objects.
//      With CONTACTS instead input_positions (num_instances x CONTACTS x 3), m, input_forces (num_instances x CONTACTS), N, and
//      input_counts (num_instances).
// Out: with CONTACTS contacts and num_contacts. Otherwise loads, with OVER_TILES; poses and, with FRICTION, motions (num_instances x
// SLOTS): objects that may press, then empty ones; load and flag of instances;
//      input_problems: num_instances minus the first instance whose objects or load are not allowed. Its slot stays empty.
// State: placed_poses (num_instances x SLOTS x kPlacedNumbers), with FRICTION.
// Shared memory: none.
// Reference: src/simulation/near_slots.cpp, motions.cpp, passes/load_search.cpp and pack/pack_contacts.cpp.

#include "shared/features.h"
#include "passes/declare.glsl"
#include "passes/place.h"

#include "common/pose_record.glsl"
#include "common/motion_record.glsl"

void report(uint word, uint instance) { atomicMax(input_problems[word], step_record.batch.x - instance); }

Pose inputPose(uint slot) {
  uint first = 7 * slot;
  return Pose(dvec3(input_poses[first], input_poses[first + 1], input_poses[first + 2]),
              dvec4(input_poses[first + 3], input_poses[first + 4], input_poses[first + 5], input_poses[first + 6]));
}

// Written so that NaN fails.
bool isAllowed(int id, Pose X_SO) {
  double square = X_SO.rotation.x * X_SO.rotation.x + X_SO.rotation.y * X_SO.rotation.y + X_SO.rotation.z * X_SO.rotation.z +
                  X_SO.rotation.w * X_SO.rotation.w;
  return id >= 0 && id < int(NUM_OBJECTS) && isFinite(X_SO.position) && abs(sqrt(square) - 1.0lf) <= double(LENGTH_TOLERANCE);
}

// Returns whether the instance is driven by load.
bool placeLoad(uint i) {
  float load = input_loads[i];
  bool is_driven = !isnan(load);
  if (is_driven && !(LOADS && load >= 0.0 && !isinf(load))) {
    report(kLoadProblems, i);
    is_driven = false;
  }
  instances[i].drive.x = load;
  if (is_driven) instances[i].keys.w |= kFlagLoadDriven;
  return is_driven;
}

// Moves the pose of a slot to placed_poses. Returns the motion since the one there.
MotionRecord moved(uint i, uint slot, int id, Pose X_SO) {
  uint first = kPlacedNumbers * (i * SLOTS + slot);
  Pose before = Pose(dvec3(placed_poses[first + 1], placed_poses[first + 2], placed_poses[first + 3]),
                     dvec4(placed_poses[first + 4], placed_poses[first + 5], placed_poses[first + 6], placed_poses[first + 7]));
  before.position.z += double(features[kFeatureLoadOffset * step_record.batch.x + i]);
  Pose now = Pose(X_SO.position, normalized(X_SO.rotation));
  bool is_known = (instances[i].keys.w & kFlagFirstStep) == 0 && id >= 0 && int(placed_poses[first]) == id;
  placed_poses[first] = double(id);
  for (uint k = 0; k < 3; ++k) placed_poses[first + 1 + k] = now.position[k];
  for (uint k = 0; k < 4; ++k) placed_poses[first + 4 + k] = now.rotation[k];
  return motionRecord(before, now, is_known, slot);
}

// The bracket of a search over tiles for `count` objects, from just clear of the sensor to past its skin.
void startSearch(uint i, bool is_driven, uint count) {
  const float kLargest = 3.4028235e38;
  LoadRecord load = LoadRecord(vec4(0, 0, 0, kLoadSearching), vec4(0));
  float low = kLargest, high = -kLargest;
  for (uint k = 0; k < count; ++k) {
    PoseRecord pose = poses[i * SLOTS + k];
    LoadBoundsRecord bounds = load_bounds[uint(pose.object.x)];
    float center = pose.row2.w, half_size = 0.0;
    for (uint axis = 0; axis < 3; ++axis) {
      center += pose.row2[axis] * bounds.center[axis];
      half_size += abs(pose.row2[axis]) * bounds.half_size[axis];
    }
    low = min(low, center - half_size);
    high = max(high, center + half_size);
  }
  if (is_driven && count > 0) {
    float up = HIGHEST - low + CLEARANCE, down = LOWEST - high;
    load.bracket = vec4(max(up - FIRST_STEP, 0.5 * (up + down)), down, up, kLoadSearching);
    load.forces.x = kLargest;
  }
  loads[i] = load;
}

// Contact points as the records that contacts.comp reads. An instance with one that is not allowed has none.
void placeContacts(uint i) {
  double most = double(MOST_COORDINATE);
  int count = input_counts[i];
  bool are_allowed = count >= 0 && count <= int(CONTACTS);
  for (uint k = i * CONTACTS; are_allowed && k < i * CONTACTS + uint(count); ++k) {
    dvec3 p = dvec3(input_positions[3 * k], input_positions[3 * k + 1], input_positions[3 * k + 2]);
    double force = input_forces[k];
    are_allowed = abs(p.x) <= most && abs(p.y) <= most && abs(p.z) <= most && force >= 0.0lf && force <= double(MOST_FORCE);
    contacts[k].point = vec4(vec3(p), float(force));
  }
  if (!are_allowed) report(kContactProblems, i);
  num_contacts[i] = are_allowed ? uint(count) : 0;
}

void placeObjects(uint i) {
  SkinBase base = SkinBase(vec4(BASE_X, BASE_Y, BASE_Z, BASE_LOWEST), vec4(BASE_ORIGIN, 0, 0, 0));
  bool is_driven = placeLoad(i);
  uint count = 0;
  for (uint slot = 0; slot < SLOTS; ++slot) {
    int id = input_ids[i * SLOTS + slot];
    Pose X_SO = inputPose(i * SLOTS + slot);
    if (id != -1 && !isAllowed(id, X_SO)) {
      report(kObjectProblems, i);
      id = -1;
    }
    MotionRecord motion;
    if (FRICTION) motion = moved(i, slot, id, X_SO);
    if (id < 0) continue;
    PoseRecord record = poseRecord(uint(id), slot, X_SO);
    if (!is_driven && isBehind(objects[id], record, base)) continue;
    poses[i * SLOTS + count] = record;
    if (FRICTION) motions[i * SLOTS + count] = motion;
    ++count;
  }
  if (OVER_TILES) startSearch(i, is_driven, count);
  for (; count < SLOTS; ++count) {
    poses[i * SLOTS + count] = kNoPose;
    if (FRICTION) motions[i * SLOTS + count] = kNoMotion;
  }
}

void main() {
  uint i = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (i >= step_record.batch.x || (instances[i].keys.w & kFlagHeld) != 0) return;
  if (CONTACTS > 0) {
    placeContacts(i);
  } else {
    placeObjects(i);
  }
}
