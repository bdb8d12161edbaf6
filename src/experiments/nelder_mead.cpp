#include "experiments/nelder_mead.h"

#include <nlopt.h>

#include <exception>
#include <memory>

#include "taxelsim/error.h"

namespace taxelsim {
namespace {

struct Objective {
  const std::function<double(const std::vector<double>&)>& cost;
  nlopt_opt optimizer;
  std::exception_ptr failure{};
};

// NLopt is written in C: no exception may pass through it.
double evaluate(unsigned count, const double* point, double*, void* data) {
  auto& objective = *static_cast<Objective*>(data);
  try {
    return objective.cost({point, point + count});
  } catch (...) {
    objective.failure = std::current_exception();
    nlopt_force_stop(objective.optimizer);
    return 0;
  }
}

}  // namespace

void minimizeNelderMead(const std::vector<double>& start, const NelderMeadOptions& options,
                        const std::function<double(const std::vector<double>&)>& cost) {
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimizer(
      nlopt_create(NLOPT_LN_NELDERMEAD, static_cast<unsigned>(start.size())), nlopt_destroy);
  Objective objective{cost, optimizer.get()};
  nlopt_set_min_objective(optimizer.get(), evaluate, &objective);
  nlopt_set_initial_step1(optimizer.get(), options.step);
  nlopt_set_xtol_abs1(optimizer.get(), options.tolerance);
  nlopt_set_maxeval(optimizer.get(), options.max_evaluations);
  std::vector<double> point = start;
  double least = 0;
  const nlopt_result result = nlopt_optimize(optimizer.get(), point.data(), &least);
  if (objective.failure) std::rethrow_exception(objective.failure);
  if (result < 0 && result != NLOPT_ROUNDOFF_LIMITED)
    throw Error(ErrorKind::kInput, std::string("Nelder-Mead: ") + nlopt_result_to_string(result));
}

}  // namespace taxelsim
