// Discretization of an elastic layer: the nodes on which its contact is solved, and the influence of a pressure on each. The solver is in
// src/reference/elastic_layer.h in double precision, shaders/elastic_layer.comp on the device.
#pragma once

#include <array>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// The samples of a patch and of the skin's margin around it: a grid centred on the patch, row u along x, column v along y of P. Sample (a,
// b) of taxel (i, j) is node (margin_rows + i s + a, margin_cols + j s + b).
struct LayerNodes {
  int num_rows = 0;
  int num_cols = 0;
  int margin_rows = 0;  // on either side
  int margin_cols = 0;
  std::array<double, 2> spacing{};  // m

  double area() const { return spacing[0] * spacing[1]; }
};

// Of the sensor's first patch.
LayerNodes layerNodes(const Sensor& sensor);

// The sensor with the nodes as taxels of one sample, without spread and readout.
Sensor sensorOfNodes(const Sensor& sensor, const LayerNodes& nodes);

// Modulus E* = E / (1 - nu^2) of a half-space under a rigid indenter.
double planeModulus(double elastic_modulus, double poisson_ratio);

// Ratio L of a bonded layer's compliance to a half-space's at k h = x >= 0, k the wave number and h the thickness: w^(k) = 2 / (E* k) L(k
// h) p^(k). Frictionless top, bonded base; from the plane-strain solution of the layer for a surface load cos(k x).
double layerKernel(double x, double poisson_ratio);
inline constexpr double kLayerKernelEnd = 24;  // 1 - L is below 1e-14 beyond

// Displacement (m) of the node u rows and v columns away from a cell under 1 Pa, (num_rows x num_cols); even in u and v. A bonded layer of
// `thickness` (m).
std::vector<double> layerInfluence(const ElasticLayer& layer, double thickness, const std::array<double, 2>& spacing, int num_rows,
                                   int num_cols);

// Compliances of nodes whose cells an object covers in part, relative to that of a whole cell on itself (the first of layerInfluence()).
//
// A rigid disc of area s A on a half-space sinks by F / (2 E* a), a = sqrt(s A / pi): the shape that stands for a part with the share s of
// a cell of area A. The base takes from a point what it does not take from a cell; between two parts it acts as the image of a point in a
// mirror at half of `image_depth`, exact at distance 0. shaders/elastic_layer/cells.glsl has the formula.
struct CellCompliance {
  double disc = 0;         // of the disc with the cell's area, on a half-space
  double free = 0;         // of the cell, on a half-space
  double base = 0;         // of a point less that of a cell, what the base adds to each; 0 without a base
  double point = 0;        // m: of a point on a half-space, times distance
  double image_depth = 0;  // m; 0 without a base
};

CellCompliance cellCompliance(const ElasticLayer& layer, double thickness, const std::array<double, 2>& spacing);

}  // namespace taxelsim
