// Cross-validation of stamp images and of force curves (cross_validate.h). `others`: measurements that are in every fit.
#pragma once

#include <vector>

#include "taxelsim/characterize.h"
#include "taxelsim/cross_validate.h"

namespace taxelsim {

// Each load is left out in turn.
CrossValidation validateStamps(const std::vector<Measurement>& stamps, const std::vector<Measurement>& others);

// Each measurement is cut into two parts, which predict each other.
CrossValidation validateForceCurves(const std::vector<Measurement>& curves, const std::vector<Measurement>& others);

// As characterize(). Raises `longest` (s) to the processor time that it took.
Characterization timedFit(const std::vector<Measurement>& measurements, double& longest);

}  // namespace taxelsim
