// Solver of an elastic layer on the CPU: the equations, first guess and stop of taxelsim, with products by FFTW or by direct sums, one
// thread per core over the instances. It is given the depths and ends with the pressures. Not part of the simulator.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "peers/layer_products.h"
#include "peers/layer_solve.h"
#include "taxelsim/sensor.h"

namespace taxelsim::bench {

enum class LayerProduct {
  kFft,        // FFTs of the window of an instance, two instances at once
  kWholeFfts,  // FFTs of the whole grid, one instance at a time: what a program for one contact does
  kDirect,     // sums over the nodes with pressure
};

class FftLayerPeer {
 public:
  // `sensor` with law ElasticLayer and point sampling. num_threads 0: one per core.
  FftLayerPeer(const Sensor& sensor, LayerProduct product, int num_instances, int num_threads);

  // Overlaps (num_instances x num_nodes), m, of object and undeformed skin, at most its thickness, in the layout that run() takes.
  std::vector<float> padded(std::span<const double> overlaps) const;

  // Solves a frame of all instances. `cold`: not from the pressures of the frame before. Starts and joins its threads.
  void run(std::span<const float> padded_overlaps, bool cold);

  // Of an instance, (num_nodes), Pa.
  std::vector<double> pressures(int instance) const;
  double meanIterations() const;
  float largestResidual() const;

 private:
  using Class = std::pair<int, int>;  // lengths of a convolution

  void solveDirectly(std::span<const float> overlaps, bool cold);
  void solveByFft(std::span<const float> overlaps, bool cold);
  void classify(std::span<const float> overlaps);
  // Instances begin to end of order_, which have one class, in pairs.
  void solvePairs(std::span<const float> overlaps, bool cold, std::size_t thread, std::size_t begin, std::size_t end);
  void note(int instance, const LayerSolve& solve);
  float* pressuresOf(int instance) { return pressure_.data() + static_cast<std::size_t>(instance) * grid_.size(); }

  LayerProduct product_;
  int num_instances_, num_threads_;
  double own_influence_;  // m/Pa, of a node on itself
  LayerGrid grid_;
  std::vector<float> influence_;  // (num_nodes), over own_influence_
  LayerLimits limits_;
  std::vector<float> pressure_;  // (num_instances x padded nodes), m
  std::vector<int> iterations_;
  std::vector<float> residuals_;
  // Of a thread.
  struct Work {
    std::vector<LayerSolve> solves;  // two
    DirectProduct::Sources sources;
    std::unique_ptr<FftConvolution::Arrays> arrays;
    std::vector<RowPart> parts;
  };
  std::vector<Work> work_;
  DirectProduct direct_;
  std::map<Class, std::unique_ptr<FftConvolution>> convolutions_;
  std::vector<std::pair<Class, int>> order_;                 // class and instance, sorted
  std::vector<std::pair<std::size_t, std::size_t>> pieces_;  // of order_, a class each
};

}  // namespace taxelsim::bench
