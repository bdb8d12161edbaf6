#include "peers/fft_layer_peer.h"

#include <algorithm>
#include <numeric>
#include <variant>

#include "peers/threads.h"
#include "sensor/elastic_layer.h"

namespace taxelsim::bench {
namespace {

constexpr int kBlock = 8;               // instances that a thread takes at once
constexpr std::size_t kPieceSize = 16;  // instances that a thread solves in pairs, at most

LayerGrid gridOf(const Sensor& sensor) {
  const LayerNodes nodes = layerNodes(sensor);
  return {nodes.num_rows, nodes.num_cols};
}

std::vector<double> influenceOf(const Sensor& sensor) {
  const LayerNodes nodes = layerNodes(sensor);
  return layerInfluence(std::get<ElasticLayer>(sensor.skin.law), sensor.skin.thickness, nodes.spacing, nodes.num_rows, nodes.num_cols);
}

std::vector<float> relative(const std::vector<double>& influence) {
  std::vector<float> result;
  for (const double value : influence) result.push_back(static_cast<float>(value / influence.front()));
  return result;
}

// As src/simulation/pack/pack_layer.cpp: a surface that rises somewhere may be touched above the object's lowest points. And as
// shaders/elastic_layer/initial_guess.glsl.
LayerLimits limitsOf(const ElasticLayer& law, const std::vector<float>& influence) {
  constexpr float kReachOfBulge = 2;
  const bool bulges = std::any_of(influence.begin(), influence.end(), [](float a) { return a < -1e-6f; });
  return {.tolerance = static_cast<float>(law.tolerance),
          .max_iterations = law.iterations,
          .reach = bulges ? kReachOfBulge : 0,
          .beyond_contact = law.base == ElasticLayer::Base::kHalfSpace ? 0.4f : 0};
}

}  // namespace

FftLayerPeer::FftLayerPeer(const Sensor& sensor, LayerProduct product, int num_instances, int num_threads)
    : product_(product),
      num_instances_(num_instances),
      num_threads_(threadsOf(num_threads)),
      own_influence_(influenceOf(sensor).front()),
      grid_(gridOf(sensor)),
      influence_(relative(influenceOf(sensor))),
      limits_(limitsOf(std::get<ElasticLayer>(sensor.skin.law), influence_)),
      pressure_(static_cast<std::size_t>(num_instances) * grid_.size(), 0),
      iterations_(static_cast<std::size_t>(num_instances), 0),
      residuals_(static_cast<std::size_t>(num_instances), 0),
      work_(static_cast<std::size_t>(num_threads_)),
      direct_(grid_, influence_),
      order_(static_cast<std::size_t>(num_instances)) {
  const auto most = static_cast<std::size_t>(paddedLength(grid_.num_rows)) * static_cast<std::size_t>(paddedLength(grid_.num_cols));
  for (Work& work : work_) {
    work.solves.assign(2, LayerSolve(grid_, limits_));
    work.arrays = std::make_unique<FftConvolution::Arrays>(most);
  }
}

std::vector<float> FftLayerPeer::padded(std::span<const double> overlaps) const {
  std::vector<float> result(static_cast<std::size_t>(num_instances_) * grid_.size(), kNoOverlap);
  std::size_t from = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_instances_); ++i) {
    for (int row = 0; row < grid_.num_rows; ++row) {
      for (int col = 0; col < grid_.num_cols; ++col, ++from) {
        result[i * grid_.size() + grid_.at(row, col)] = static_cast<float>(std::max(overlaps[from], static_cast<double>(kNoOverlap)));
      }
    }
  }
  return result;
}

void FftLayerPeer::run(std::span<const float> padded_overlaps, bool cold) {
  if (product_ == LayerProduct::kDirect) {
    solveDirectly(padded_overlaps, cold);
  } else {
    solveByFft(padded_overlaps, cold);
  }
}

void FftLayerPeer::solveDirectly(std::span<const float> overlaps, bool cold) {
  inThreads(num_threads_, num_instances_, kBlock, [&](int thread, int instance) {
    Work& work = work_[static_cast<std::size_t>(thread)];
    LayerSolve& solve = work.solves.front();
    bool goes_on = solve.begin(overlaps.data() + static_cast<std::size_t>(instance) * grid_.size(), pressuresOf(instance), cold);
    while (goes_on) {
      direct_(solve, solve.input(), solve.product(), work.sources);
      goes_on = solve.advance();
    }
    note(instance, solve);
  });
}

void FftLayerPeer::solveByFft(std::span<const float> overlaps, bool cold) {
  classify(overlaps);
  inThreads(num_threads_, static_cast<int>(pieces_.size()), 1, [&](int thread, int piece) {
    const auto& [begin, end] = pieces_[static_cast<std::size_t>(piece)];
    solvePairs(overlaps, cold, static_cast<std::size_t>(thread), begin, end);
  });
}

// Sorts the instances by the lengths that their windows need, largest first, and divides them into pieces; plans convolutions that are new.
void FftLayerPeer::classify(std::span<const float> overlaps) {
  inThreads(num_threads_, num_instances_, kBlock, [&](int thread, int instance) {
    LayerWindow window;
    partsInReach(grid_, overlaps.data() + static_cast<std::size_t>(instance) * grid_.size(), limits_.reach,
                 work_[static_cast<std::size_t>(thread)].parts, window);
    Class needed{0, 0};
    if (product_ == LayerProduct::kWholeFfts) window = {0, grid_.num_rows, 0, grid_.num_cols};
    if (window.end_row > 0) needed = {paddedLength(window.numRows()), paddedLength(window.numCols())};
    order_[static_cast<std::size_t>(instance)] = {needed, instance};
  });
  std::sort(order_.begin(), order_.end(), std::greater<>());
  pieces_.clear();
  const std::size_t piece_size = product_ == LayerProduct::kWholeFfts ? 1 : kPieceSize;
  for (std::size_t begin = 0; begin < order_.size();) {
    const Class& of_piece = order_[begin].first;
    std::size_t end = begin + 1;
    while (end < order_.size() && end - begin < piece_size && order_[end].first == of_piece) ++end;
    pieces_.emplace_back(begin, end);
    begin = end;
    std::unique_ptr<FftConvolution>& convolution = convolutions_[of_piece];
    if (!convolution && of_piece.first > 0) {
      convolution = std::make_unique<FftConvolution>(grid_, influence_, of_piece.first, of_piece.second);
    }
  }
}

void FftLayerPeer::solvePairs(std::span<const float> overlaps, bool cold, std::size_t thread, std::size_t begin, std::size_t end) {
  Work& work = work_[thread];
  const FftConvolution* convolution = convolutions_.find(order_[begin].first)->second.get();
  std::array<LayerSolve*, 2> pair{};
  std::array<int, 2> instance{};
  while (true) {
    for (std::size_t which = 0; which < 2; ++which) {
      while (!pair[which] && begin < end) {
        LayerSolve& solve = work.solves[which];
        const int next = instance[which] = order_[begin++].second;
        if (solve.begin(overlaps.data() + static_cast<std::size_t>(next) * grid_.size(), pressuresOf(next), cold)) {
          pair[which] = &solve;
        } else {
          note(next, solve);
        }
      }
    }
    if (!pair[0] && !pair[1]) return;
    (*convolution)(pair, *work.arrays);
    for (std::size_t which = 0; which < 2; ++which) {
      if (!pair[which] || pair[which]->advance()) continue;
      note(instance[which], *pair[which]);
      pair[which] = nullptr;
    }
  }
}

void FftLayerPeer::note(int instance, const LayerSolve& solve) {
  iterations_[static_cast<std::size_t>(instance)] = solve.iterations();
  residuals_[static_cast<std::size_t>(instance)] = solve.residual();
}

std::vector<double> FftLayerPeer::pressures(int instance) const {
  std::vector<double> result;
  const float* of_instance = pressure_.data() + static_cast<std::size_t>(instance) * grid_.size();
  for (int row = 0; row < grid_.num_rows; ++row) {
    for (int col = 0; col < grid_.num_cols; ++col) result.push_back(of_instance[grid_.at(row, col)] / own_influence_);
  }
  return result;
}

double FftLayerPeer::meanIterations() const {
  return std::accumulate(iterations_.begin(), iterations_.end(), 0.0) / num_instances_;
}

float FftLayerPeer::largestResidual() const {
  return *std::max_element(residuals_.begin(), residuals_.end());
}

}  // namespace taxelsim::bench
