// Minimisation without derivatives, by NLopt's Nelder-Mead simplex method.
#pragma once

#include <functional>
#include <vector>

namespace taxelsim {

struct NelderMeadOptions {
  double step = 0.1;          // initial step along each coordinate
  double tolerance = 1e-3;    // stops when the simplex is this small in all coordinates
  int max_evaluations = 100;  // or after so many evaluations
};

// Calls `cost` from `start` on until a stopping rule holds; `cost` keeps the best point itself. An infinite cost marks an invalid point. An
// exception of `cost` ends the search and is rethrown. Deterministic: no stopping rule depends on time.
void minimizeNelderMead(const std::vector<double>& start, const NelderMeadOptions& options,
                        const std::function<double(const std::vector<double>&)>& cost);

}  // namespace taxelsim
