// `taxelsim stiffness`: parameters of the contact laws from a material or from one measurement.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/text.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "figures/text.h"
#include "scene/sensor_file.h"
#include "sensor/fields.h"
#include "taxelsim/error.h"
#include "taxelsim/stiffness.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

// Predictions: flat pins at one depth, and a hexagonal stamp under a weight, computed as the disc of the same area.
constexpr std::array<double, 3> kPinDiameters{0.001, 0.002, 0.012};  // m
constexpr double kPinDepth = 0.001;                                  // m
constexpr double kHexagonArea = 124e-6;                              // m^2
constexpr double kHexagonLoad = 0.5 * 9.80665;                       // N, 500 g

struct StiffnessArguments {
  std::optional<double> youngs_modulus, shore_a, pin_force, pin_depth, pin_diameter, taxel_stiffness, area_stiffness, match_pin_diameter;
  std::string pitch, law;
  double thickness = 0;
  double poisson_ratio = Material{}.poisson_ratio;
  double friction_coefficient = 0;
  bool json = false;
};

// Exactly one option, or the three of a pin, says how stiff the skin is.
void checkOptions(const StiffnessArguments& a) {
  std::vector<std::string> given;
  if (a.youngs_modulus) given.push_back("--youngs-modulus");
  if (a.shore_a) given.push_back("--shore-a");
  const std::array<std::pair<const char*, bool>, 3> pin{
      {{"--pin-force", a.pin_force.has_value()}, {"--pin-depth", a.pin_depth.has_value()}, {"--pin-diameter", a.pin_diameter.has_value()}}};
  const auto first = std::find_if(pin.begin(), pin.end(), [](const auto& option) { return option.second; });
  if (first != pin.end()) given.push_back(first->first);
  if (a.taxel_stiffness) given.push_back("--taxel-stiffness");
  if (a.area_stiffness) given.push_back("--area-stiffness");
  constexpr const char* kOneOf =
      "--youngs-modulus, --shore-a, --pin-force with --pin-depth and --pin-diameter, --taxel-stiffness with --pitch, or --area-stiffness";
  if (given.empty()) throw Error(ErrorKind::kInput, fmt::format("the stiffness is missing: give one of {}", kOneOf));
  if (given.size() > 1) {
    throw Error(ErrorKind::kInput, fmt::format("{}: not allowed together: give one of {}", fmt::join(given, " and "), kOneOf));
  }
  for (const auto& [name, is_given] : pin) {
    if (first != pin.end() && !is_given) throw Error(ErrorKind::kInput, fmt::format("{} is missing: {} needs it", name, first->first));
  }
  if (a.taxel_stiffness && a.pitch.empty()) throw Error(ErrorKind::kInput, "--pitch is missing: --taxel-stiffness needs it");
  if (!a.taxel_stiffness && !a.pitch.empty()) throw Error(ErrorKind::kInput, "--pitch: only allowed with --taxel-stiffness");
  if (a.match_pin_diameter && !a.youngs_modulus && !a.shore_a) {
    throw Error(ErrorKind::kInput,
                "--match-pin-diameter: only allowed with --youngs-modulus or --shore-a; a measurement gives the springs");
  }
}

// "X,Y" or one number for both.
std::array<double, 2> parsePitch(const std::string& text) {
  const std::size_t comma = text.find(',');
  const std::string x = text.substr(0, comma), y = comma == std::string::npos ? x : text.substr(comma + 1);
  std::array<double, 2> pitch{};
  if (!parseNumber(x, pitch[0]) || !parseNumber(y, pitch[1])) {
    throw Error(ErrorKind::kInput, fmt::format("--pitch: {} is not allowed: X,Y, two numbers > 0 m", oneLine(text)));
  }
  return pitch;
}

SkinData dataOf(const StiffnessArguments& a) {
  SkinData data{.thickness = a.thickness, .poisson_ratio = a.poisson_ratio};
  if (a.pin_force) {
    data.stiffness = PinPress{*a.pin_force, *a.pin_depth, *a.pin_diameter};
  } else if (a.taxel_stiffness) {
    data.stiffness = TaxelStiffness{*a.taxel_stiffness, parsePitch(a.pitch)};
  } else if (a.area_stiffness) {
    data.stiffness = AreaStiffness{*a.area_stiffness};
  } else {
    data.stiffness = KnownModulus{a.shore_a ? shoreAModulus(*a.shore_a) : *a.youngs_modulus, a.match_pin_diameter};
  }
  return data;
}

// The assumptions behind both numbers, one sentence each.
struct Assumptions {
  std::string springs, layer;
};

Assumptions assumptionsOf(const StiffnessArguments& a) {
  const std::string wide = "a contact much wider than the skin is thick";
  if (a.pin_force) {
    return {"independent springs: pin force / (pin area x pin depth)",
            "a bonded layer, frictionless under the pin, with this force at this depth"};
  }
  if (a.taxel_stiffness) {
    return {"taxel stiffness / (pitch x times pitch y): the taxels around it are pressed equally deep",
            "confined modulus / thickness is the area stiffness: " + wide};
  }
  if (a.area_stiffness) return {"as given: pressure / depth", "confined modulus / thickness is the area stiffness: " + wide};
  std::string modulus = "as given";
  if (a.shore_a) modulus = fmt::format("Shore A {}, formula of Gent (1958)", numberText(*a.shore_a));
  if (a.shore_a && *a.shore_a < 40) modulus += "; below 40 the formula departs from measurements";
  if (a.match_pin_diameter) {
    return {fmt::format("springs with the force of the layer under a flat pin of {} mm diameter", numberText(1e3 * *a.match_pin_diameter)),
            modulus};
  }
  return {"confined modulus / thickness: " + wide + "; --match-pin-diameter for narrower ones", modulus};
}

struct PinPrediction {
  double diameter = 0;        // m
  double depth = 0;           // m
  double springs_force = 0;   // N
  double layer_force = 0;     // N
  double area_stiffness = 0;  // N/m^3: springs with the layer's force
};

struct Predictions {
  std::vector<PinPrediction> pins;
  double hexagon_springs_depth = 0, hexagon_layer_depth = 0;  // m
};

const Skin& skinOf(const std::vector<Skin>& skins, std::string_view law) {
  return *std::find_if(skins.begin(), skins.end(), [&](const Skin& skin) { return kLawNames[skin.law.index()] == law; });
}

Predictions predict(const std::vector<Skin>& skins) {
  const Skin &springs = skinOf(skins, "winkler"), &layer = skinOf(skins, "elastic_layer");
  Predictions result;
  for (const double diameter : kPinDiameters) {
    PinPrediction& pin = result.pins.emplace_back(PinPrediction{.diameter = diameter, .depth = std::min(kPinDepth, layer.thickness)});
    pin.springs_force = pinForce(springs, diameter, pin.depth);
    pin.layer_force = pinForce(layer, diameter, pin.depth);
    pin.area_stiffness = pin.layer_force / (std::numbers::pi / 4 * diameter * diameter * pin.depth);
  }
  const double equivalent_diameter = 2 * std::sqrt(kHexagonArea / std::numbers::pi);
  result.hexagon_springs_depth = pinDepth(springs, equivalent_diameter, kHexagonLoad);
  result.hexagon_layer_depth = pinDepth(layer, equivalent_diameter, kHexagonLoad);
  return result;
}

std::string depthText(double depth, double thickness) {
  return depth <= thickness ? roundedText(1e3 * depth) + " mm" : "out of reach";
}

std::string predictionTable(const Predictions& predictions, double thickness) {
  std::vector<std::vector<std::string>> rows{
      {"prediction, linear elasticity", "springs", "elastic_layer", "springs with the layer's force"}};
  for (const PinPrediction& pin : predictions.pins) {
    rows.push_back(
        {fmt::format("force of a flat pin of {} mm diameter, {} mm deep", numberText(1e3 * pin.diameter), numberText(1e3 * pin.depth)),
         roundedText(pin.springs_force) + " N", roundedText(pin.layer_force) + " N", roundedText(pin.area_stiffness) + " N/m^3"});
  }
  rows.push_back({fmt::format("depth of a hexagon of {:g} mm^2 under 500 g", 1e6 * kHexagonArea),
                  depthText(predictions.hexagon_springs_depth, thickness), depthText(predictions.hexagon_layer_depth, thickness), ""});
  return tableText(rows);
}

// What a law takes from the stiffness, as a comment before its block.
std::string lawComment(const SkinStiffness& stiffness, std::string_view law) {
  const std::string springs = fmt::format("springs: area stiffness {} N/m^3", roundedText(stiffness.area_stiffness));
  if (law == "elastic_layer") return fmt::format("bonded layer: Young's modulus {} Pa", roundedText(stiffness.material.elastic_modulus));
  if (law == "mass_spring_damper")
    return springs + "; mass, stiffness (N/m) and damping are those of a taxel's output, by default SkinSim's";
  if (law == "deformation_mask") return springs + "; the saturation pressure is RobWorkSim's";
  if (law == "proximity") return springs + "; reads their force, although nothing presses";
  if (law == "lugre") return springs + "; the friction parameters are the defaults";
  return springs;
}

std::string commented(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (result.empty() || result.back() == '\n') result += c == '\n' ? "#" : "# ";
    result += c;
  }
  return result;
}

double roundedNumber(double value) {
  return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
}

void printText(const StiffnessArguments& arguments, const SkinStiffness& stiffness, const std::vector<Skin>& skins) {
  const Assumptions assumptions = assumptionsOf(arguments);
  const Material& material = stiffness.material;
  std::string head = fmt::format(
      "Skin of {} mm, bonded to a rigid base, Poisson's ratio {}\n"
      "Young's modulus: {} Pa; {}\n"
      "Shear modulus: {} Pa. Confined modulus: {} Pa\n"
      "Area stiffness of springs: {} N/m^3; {}\n"
      "Tangential stiffness, for friction_coefficient > 0: {} N/m^3, shear modulus / thickness\n\n",
      numberText(1e3 * stiffness.thickness), numberText(material.poisson_ratio), roundedText(material.elastic_modulus), assumptions.layer,
      roundedText(shearModulus(material)), roundedText(confinedModulus(material)), roundedText(stiffness.area_stiffness),
      assumptions.springs, roundedText(stiffness.tangential_stiffness));
  head += predictionTable(predict(skins), stiffness.thickness);
  printOut("{}", commented(head));
  SkinStiffness rounded = stiffness;
  for (double* value : {&rounded.material.elastic_modulus, &rounded.area_stiffness, &rounded.tangential_stiffness}) {
    *value = roundedNumber(*value);
  }
  for (const Skin& skin : skinsOf(rounded, arguments.friction_coefficient)) {
    const std::string_view law = kLawNames[skin.law.index()];
    if (!arguments.law.empty() && law != arguments.law) continue;
    printOut("---\n# {}\n{}", lawComment(stiffness, law), skinText(skin));
  }
}

nlohmann::ordered_json jsonOf(const Skin& skin) {
  nlohmann::ordered_json json{{"thickness", skin.thickness}, {"law", kLawNames[skin.law.index()]}};
  const auto add = [&](const auto& law) {
    visitFields(law, [&](const auto& table) {
      for (const auto& field : table) {
        const ConstSettingPointer setting = field.in(law);
        const std::string name(field.name());
        if (const auto* number = std::get_if<const double*>(&setting)) json[name] = **number;
        if (const auto* whole = std::get_if<const int*>(&setting)) json[name] = **whole;
      }
    });
  };
  std::visit(add, skin.law);
  if (std::holds_alternative<ElasticLayer>(skin.law)) {
    json["base"] = "bonded";
    json["margin"] = skin.margin;
  }
  if (skin.friction.friction_coefficient > 0) {
    json["friction_coefficient"] = skin.friction.friction_coefficient;
    json["tangential_stiffness"] = skin.friction.tangential_stiffness;
  }
  return json;
}

void printJson(const StiffnessArguments& arguments, const SkinStiffness& stiffness, const std::vector<Skin>& skins) {
  const Assumptions assumptions = assumptionsOf(arguments);
  const Predictions predictions = predict(skins);
  const auto depthJson = [&](double depth) { return depth <= stiffness.thickness ? nlohmann::ordered_json(depth) : nullptr; };
  nlohmann::ordered_json json{{"thickness", stiffness.thickness},
                              {"poisson_ratio", stiffness.material.poisson_ratio},
                              {"elastic_modulus", stiffness.material.elastic_modulus},
                              {"elastic_modulus_assumption", assumptions.layer},
                              {"shear_modulus", shearModulus(stiffness.material)},
                              {"confined_modulus", confinedModulus(stiffness.material)},
                              {"area_stiffness", stiffness.area_stiffness},
                              {"area_stiffness_assumption", assumptions.springs},
                              {"tangential_stiffness", stiffness.tangential_stiffness},
                              {"pins", nlohmann::ordered_json::array()},
                              {"hexagon",
                               {{"area", kHexagonArea},
                                {"load", kHexagonLoad},
                                {"springs_depth", depthJson(predictions.hexagon_springs_depth)},
                                {"elastic_layer_depth", depthJson(predictions.hexagon_layer_depth)}}},
                              {"skins", nlohmann::ordered_json::array()}};
  for (const PinPrediction& pin : predictions.pins) {
    json["pins"].push_back({{"pin_diameter", pin.diameter},
                            {"pin_depth", pin.depth},
                            {"springs_pin_force", pin.springs_force},
                            {"elastic_layer_pin_force", pin.layer_force},
                            {"equivalent_area_stiffness", pin.area_stiffness}});
  }
  for (const Skin& skin : skins) {
    if (arguments.law.empty() || kLawNames[skin.law.index()] == arguments.law) json["skins"].push_back(jsonOf(skin));
  }
  printJsonText(json);
}

// Names the option instead of the library's field.
[[noreturn]] void rethrowWithOption(const Error& error) {
  if (error.field().empty() || error.field().find(' ') != std::string::npos) throw error;
  std::string option = error.field() == "elastic_modulus" ? "youngs-modulus" : error.field();
  std::replace(option.begin(), option.end(), '_', '-');
  throw Error(ErrorKind::kInput, fmt::format("--{}: {}", option, error.reason()));
}

int runStiffness(const StiffnessArguments& arguments) {
  checkOptions(arguments);
  try {
    const SkinStiffness stiffness = skinStiffness(dataOf(arguments));
    const std::vector<Skin> skins = skinsOf(stiffness, arguments.friction_coefficient);
    if (arguments.json)
      printJson(arguments, stiffness, skins);
    else
      printText(arguments, stiffness, skins);
  } catch (const Error& error) {
    rethrowWithOption(error);
  }
  return kExitOk;
}

void addSources(CLI::App& command, StiffnessArguments& arguments) {
  command.add_option("--youngs-modulus", arguments.youngs_modulus, "Young's modulus of the skin, Pa")->type_name("PA");
  command
      .add_option("--shore-a", arguments.shore_a,
                  fmt::format("Shore A hardness of the skin, {:g} to {:g}, converted by Gent (1958)", kMinShoreA, kMaxShoreA))
      ->type_name("VALUE");
  command.add_option("--pin-force", arguments.pin_force, "Force on a flat pin that was pressed in, N")->type_name("N");
  command.add_option("--pin-depth", arguments.pin_depth, "Depth of this pin, m")->type_name("M");
  command.add_option("--pin-diameter", arguments.pin_diameter, "Diameter of this pin, m")->type_name("M");
  command
      .add_option("--taxel-stiffness", arguments.taxel_stiffness,
                  "Force per depth of one whole taxel, with the taxels around it pressed equally deep, N/m")
      ->type_name("N/M");
  command.add_option("--pitch", arguments.pitch, "Pitch of the taxels of --taxel-stiffness along x and y, m")->type_name("X,Y");
  command.add_option("--area-stiffness", arguments.area_stiffness, "Pressure per depth under a wide stamp, N/m^3")->type_name("N/M^3");
}

}  // namespace

void addStiffness(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("stiffness", "Print parameters of every contact law from a material or a measurement");
  command->footer(
      "Examples:\n  taxelsim stiffness --shore-a 30 --thickness 0.002\n"
      "  taxelsim stiffness --pin-force 2 --pin-depth 0.001 --pin-diameter 0.001 --thickness 0.002 --law winkler\n"
      "Prints the block `skin` of a sensor file for each law, and what the laws predict. docs/how_to/stiffness.md has the formulas.");
  const auto arguments = std::make_shared<StiffnessArguments>();
  addSources(*command, *arguments);
  command->add_option("--thickness", arguments->thickness, "Thickness of the skin, m")->required()->type_name("M");
  command->add_option("--poisson-ratio", arguments->poisson_ratio, "Poisson's ratio of the skin, 0 to below 0.5")
      ->capture_default_str()
      ->type_name("NU");
  command
      ->add_option(
          "--match-pin-diameter", arguments->match_pin_diameter,
          "With a material: springs that carry the force of the layer under a flat pin of this diameter, m. Default: springs for a "
          "contact much wider than the skin is thick")
      ->type_name("M");
  command->add_option("--friction-coefficient", arguments->friction_coefficient, "Add stick-slip friction where the law has it")
      ->capture_default_str()
      ->type_name("MU");
  command->add_option("--law", arguments->law, "Print this law only")
      ->check(silent(CLI::IsMember(std::vector<std::string>(kLawNames.begin(), kLawNames.end()))))
      ->type_name("LAW");
  command->add_flag("--json", arguments->json, "Print JSON, all numbers in full");
  command->callback([arguments, &action] { action = [arguments] { return runStiffness(*arguments); }; });
}

}  // namespace taxelsim::cli
