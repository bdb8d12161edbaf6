// Which instances a frame is computed for. A step of some instances holds the others: no pass writes any output or state of an instance
// that is held.
// In: instances, step_record.
#ifndef COMMON_INSTANCES_GLSL
#define COMMON_INSTANCES_GLSL
bool isHeld(uint instance) { return (instanceRecord(instance).keys.w & kFlagHeld) != 0; }

// `instance` may be beyond the batch.
bool isProcessed(uint instance) { return instance < step_record.batch.x && !isHeld(instance); }

// Whether the frame has new values of the instance, `clean` ones or measured ones: between the sensor's own frames the measured values
// stay.
bool hasNewValues(uint instance, bool clean) {
  uint flags = instanceRecord(instance).keys.w;
  return (flags & kFlagHeld) == 0 && (clean || (flags & kFlagNewFrame) != 0);
}
#endif
