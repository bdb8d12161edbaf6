// Rates of taxel forces and moments under a rigid motion of the objects, by the transport equation of the pressure. For all laws except
// ElasticLayer (layer_rates.h).
//
// An object moves with the velocity field u = v + w x p and carries its surface z = -d(x, y) along, so that d_t = -u_z - u_x d_x - u_y d_y
// at the surface. For a pressure f(d) this is, in conservative form,
//
//   f_t = -div J - f' u_z0,      J_x = f v_x - G w_y - f y w_z
//                                J_y = f v_y + G w_x + f x w_z       G = d f - (integral of f from 0 to d)
//                                u_z0 = v_z + y w_x - x w_y          f' = df/dd
//
//             J_y
//          +---^---+       finite volumes: the force of a taxel changes by the flux through its four sides plus the source in its samples.
//     J_x  | o   o |  J_x  f and G on a side are the means of the samples on both sides; at the rim of the patch they are extrapolated
//      --> |       | -->   linearly from inside.
//          | o   o |
//          +---^---+       The flux form needs no slopes d_x, d_y, which are unbounded at vertical walls of an object.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "reference/frame.h"

namespace taxelsim::reference {

// Rigid motion of the objects about the origin of P, in P: velocity v (m per unit), angular velocity w (rad per unit).
struct Motion {
  Vector3 v, w;
};

// Pressure law of one patch, evaluated at its samples. Grid order: row u along x, column v along y of P; arrays have shape (rows x cols).
class PressureField {
 public:
  // first_sample: index of the patch's first sample in the arrays of `frame`, which must outlive this.
  PressureField(const Sensor& sensor, const GridPatch& patch, std::size_t first_sample, const Frame& frame);

  double x(double u) const { return (u - (rows - 1) / 2.0) * hx; }  // m
  double y(double v) const { return (v - (cols - 1) / 2.0) * hy; }  // m
  double at(const std::vector<double>& values, int u, int v) const { return values[static_cast<std::size_t>(u * cols + v)]; }

  // Value on the side below row u (0 to rows) at column v, and below column v (0 to cols) at row u.
  double onRowSide(const std::vector<double>& values, int u, int v) const;
  double onColumnSide(const std::vector<double>& values, int u, int v) const;

  const int s;                          // samples per taxel along a side
  const int rows, cols;                 // samples
  const double hx, hy;                  // m, between samples
  std::vector<double> f, G, stiffness;  // Pa, Pa m, Pa/m; stiffness: mean of f' over the sample's cell

 private:
  std::size_t index(int u, int v) const;
  double depthAt(int u, int v) const;
  double elasticPressure(double d) const;
  double reach() const { return s > 1 ? std::max(hx, hy) : 0; }
  double depthStep(int u, int v, int du, int dv) const;
  double meanSlope(double d, double width) const;
  void addSample(int u, int v);
  void addCell(int u, int v);
  void addPoints(std::size_t n, bool is_full);

  int num_cols_;
  std::size_t first_;
  const Frame& frame_;
  double thickness_;
  Winkler law_;
  bool relaxes_;
};

// Rates of the taxel forces, (taxels of the patch), N per unit.
std::vector<double> taxelForceRates(const PressureField& field, const Motion& motion);

// Rates of the integrals of p, p x and p y over the patch: N, N m, N m per unit. Flux through the rim is lost.
Vector3 momentRates(const PressureField& field, const Motion& motion);

}  // namespace taxelsim::reference
