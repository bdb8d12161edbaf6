/// @file
/// Fits the parameters of a sensor model to bench measurements (paper, section III).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

/// Estimate of one parameter of the sensor file or of a measurement.
struct Estimate {
  std::string parameter;  ///< Key in the sensor file, "skin.normal_contact_stiffness", or MEASUREMENT.contact_offset.
  std::string unit;       ///< SI unit of `value`, `low` and `high`; "" if dimensionless.
  /// Whether the measurements identify the parameter. If false, the sensor keeps its previous value and `remark` gives the reason.
  bool determined = false;
  double value = 0;    ///< Best fit.
  double low = 0;      ///< Lower end of the 95 % confidence interval.
  double high = 0;     ///< Upper end of the 95 % confidence interval.
  std::string remark;  ///< One line; empty if there is nothing to say.
};

/// Goodness of fit for one measurement.
struct FitQuality {
  std::string measurement;       ///< Name of the measurement.
  std::string unit;              ///< Unit of `rms`.
  double rms = 0;                ///< Root mean square of the residuals, without outliers.
  std::size_t num_rows = 0;      ///< Rows of the measurement.
  std::size_t num_outliers = 0;  ///< Rows that the fit excludes as outliers.
};

/// Measured data and the fitted curve, ready to plot.
struct FitFigure {
  /// One data series.
  struct Curve {
    std::string name;       ///< Legend entry.
    bool measured = false;  ///< Measured data, plotted as dots; otherwise the fit, plotted as a line.
    std::vector<double> x;  ///< (num_points), unit as in FitFigure::x_label.
    std::vector<double> y;  ///< (num_points), unit as in FitFigure::y_label.
  };

  std::string title;          ///< Title.
  std::string x_label;        ///< Label and unit of the x axis.
  std::string y_label;        ///< Label and unit of the y axis.
  std::vector<Curve> curves;  ///< Data series, in drawing order.
};

/// Gain and trigger of all taxels as functions of the temperature T: gain exp(gain_per_kelvin (T - reference)),
/// trigger + trigger_per_kelvin (T - reference).
struct TemperatureTerm {
  double reference = 0;           ///< Degrees Celsius, mean of the measurements that recorded it.
  double gain_per_kelvin = 0;     ///< 1/K.
  double trigger_per_kelvin = 0;  ///< N/K.
};

/// Gains of presses of stamps that depend on their load, because a bench does not carry every weight alike. They belong to the bench and
/// are no part of the sensor. log(gain) is a Gaussian process in log(load) with a mean of 0 and a squared-exponential covariance.
struct BenchGains {
  std::vector<double> loads;      ///< (num_presses), N.
  std::vector<double> log_gains;  ///< (num_presses), log(gain) relative to the sensor's gain.
  double load_spread = 0;         ///< Standard deviation of the process.
  double length = 1;              ///< Length of its covariance, in log(load).
  double press_spread = 0;        ///< Standard deviation between presses of one load, > 0.

  /// Expected log(gain) of a press under `load` (N); 0 beyond the loads of the presses, where nothing is known of the bench.
  double at(double load) const;
};

/// Result of characterize().
struct Characterization {
  Sensor sensor;                     ///< The sensor of the measurements with the fitted parameters.
  std::vector<Estimate> estimates;   ///< One entry per fitted parameter.
  std::vector<FitQuality> fits;      ///< One entry per measurement.
  std::vector<FitFigure> figures;    ///< Figures for a report.
  std::vector<int> dead_taxels;      ///< Taxels that did not respond to force, by index in storage order.
  std::vector<std::string> remarks;  ///< Warnings, one line each.
  /// Where measurements at several temperatures recorded it. `sensor` is the one at the reference temperature.
  std::optional<TemperatureTerm> temperature{};
  std::optional<BenchGains> bench_gains{};  ///< Where the evidence says that gains of presses depend on their load.
};

/// The fitted sensor at a temperature (degrees Celsius); without a TemperatureTerm at any.
Sensor sensorAt(const Characterization& fitted, double temperature);

/// Standard deviation of the logarithm of the fitted gains; none where fewer than two taxels above 0 have one.
std::optional<double> gainSpreadOf(const Characterization& fitted);

/// An array of the same kind as the fitted one, for data sets: Readout::gain_spread in place of the gains and triggers of its taxels, which
/// are then drawn in every episode. The median taxel keeps the gain of the fitted ones, in the logarithmic mean, and Readout::trigger.
/// Throws Error(kInput) if there is no gainSpreadOf().
Sensor withRandomGains(const Characterization& fitted);

/// Fits every parameter that the measurements identify.
///
/// The readout is fitted to force curves, the stiffness to force against depth, the point spread function to images of pins and stamps, and
/// the creep to step responses and stamps. All measurements must name the same sensor; it supplies every parameter that they do not
/// identify. Same measurements, same result. Throws Error(kInput), one line that begins with the measurement's file, if a measurement
/// cannot be used.
Characterization characterize(std::span<const Measurement> measurements);

}  // namespace taxelsim
