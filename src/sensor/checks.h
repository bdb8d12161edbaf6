// The parts of checkSensor(). Each throws Error with the path of the field, its value and what is allowed.
#pragma once

#include "base/field_checks.h"
#include "sensor/fields.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

void checkSkin(const Skin& skin);
void checkLayer(const Sensor& sensor);
void checkPsf(const Sensor& sensor);
void checkReadout(const Sensor& sensor);

// Sum of the weights of a kernel.
double kernelSum(const Psf& psf);

}  // namespace taxelsim
