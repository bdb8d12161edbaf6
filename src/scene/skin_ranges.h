// Ranges of a scene's randomization that are factors on its skin, and those of the sensor's mounting.
#pragma once

#include <array>
#include <optional>

#include "taxelsim/scene.h"
#include "taxelsim/skin_variation.h"

namespace taxelsim {

struct SkinRange {
  const char* name;  // of the key and of the column under meta/
  std::optional<Range> Randomization::*range;
  float SkinVariation::*value;
  const char* unit;
  const char* text;
};
// In the order in which episodes draw them.
inline constexpr std::array kSkinRanges{
    SkinRange{"stiffness", &Randomization::stiffness, &SkinVariation::stiffness, "1", "Factor on all moduli of the skin."},
    SkinRange{"friction", &Randomization::friction, &SkinVariation::friction, "1", "Factor on the friction of the skin."},
    SkinRange{"trigger", &Randomization::trigger, &SkinVariation::trigger, "1", "Factor on the trigger of every taxel."},
    SkinRange{"hysteresis", &Randomization::hysteresis, &SkinVariation::hysteresis, "1", "Factor on the hysteresis of the readout."},
    SkinRange{"delay", &Randomization::delay, &SkinVariation::delay, "1", "Factor on the delay of the readout."},
    SkinRange{"psf_width", &Randomization::psf_width, &SkinVariation::psf_width, "1",
              "Factor on the RMS width of the point spread function."},
    SkinRange{"trigger_spread", &Randomization::trigger_spread, &SkinVariation::trigger_spread, "1",
              "Standard deviation of the logarithm of a further factor on each taxel's trigger."},
};

// Pose X_NS of a sensor in the frame where its robot believes it.
struct Mounting {
  float x = 0, y = 0;                  // m
  float yaw = 0, pitch = 0, roll = 0;  // rad
};

struct MountingRange {
  const char* name;
  std::optional<Range> Randomization::*range;
  float Mounting::*value;
  const char* unit;
  const char* text;
};
inline constexpr std::array kMountingRanges{
    MountingRange{"mounting_x", &Randomization::mounting_x, &Mounting::x, "m",
                  "Offset of the sensors along x from where the robot believes them."},
    MountingRange{"mounting_y", &Randomization::mounting_y, &Mounting::y, "m", "The same along y."},
    MountingRange{"mounting_yaw", &Randomization::mounting_yaw, &Mounting::yaw, "rad",
                  "Rotation of the sensors about z, after pitch and roll."},
    MountingRange{"mounting_pitch", &Randomization::mounting_pitch, &Mounting::pitch, "rad", "Rotation about y, after roll."},
    MountingRange{"mounting_roll", &Randomization::mounting_roll, &Mounting::roll, "rad", "Rotation about x."},
};

// Whether the skin differs between episodes.
bool variesSkin(const Randomization& randomization);

// Whether the sensor's mounting does.
bool variesMounting(const Randomization& randomization);

// Throws Error with the name of a range as its field where this sensor does not allow one of its limits.
void checkSkinRanges(const Randomization& randomization, const Sensor& sensor);

}  // namespace taxelsim
