// Forces of rigid objects on a two-parameter foundation (foundation_law.h) in closed form, and the errors of the device at many places.
#pragma once

#include <vector>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

struct Form {
  Object object;
  double tip;    // m, below the object's origin
  double depth;  // m
  double force;  // N, closed form
  double error;  // largest relative error at any place
};

// A flat pin 1 mm deep.
Form pin(double radius, double error);

// A sphere of 5 mm without the approximation of a parabola: w = depth - f(r) inside of the contact radius a, f' (a) its slope at the edge,
// outside proportional to K0(r / l).
Form sphere(double a, double error = 0.03);

// Largest relative errors of forces at 50 random places each within 2 mm of S's origin along x and y, with the default number of sweeps.
std::vector<double> worstErrors(const Sensor& sensor, const std::vector<Form>& forms);

// Expects the errors of the forms.
void expectForms(const Sensor& sensor, const std::vector<Form>& forms);

}  // namespace taxelsim
