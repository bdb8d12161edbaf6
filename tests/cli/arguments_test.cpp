// Help, version and wrong arguments: one line, exit status 2.
#include <sys/stat.h>

#include "cli/command_line.h"
#include "support/test.h"
#include "taxelsim/version.h"

namespace taxelsim::testing {
namespace {

const std::vector<std::string> kCommands{"devices",  "frame",      "generate",     "finish",  "inspect",           "render",
                                         "evaluate", "experiment", "characterize", "compare", "calibrate-readings"};

TEST(Help, EverySubcommandHasAnExample) {
  for (const std::string& command : kCommands) {
    const Outcome outcome = succeed({command, "--help"});
    EXPECT_TRUE(outcome.err.empty()) << outcome.err;
    EXPECT_THAT(outcome.out, ::testing::HasSubstr(":\n  taxelsim " + command + " "));
    EXPECT_THAT(outcome.out, ::testing::Not(::testing::HasSubstr(" in ["))) << "a range in the type of an option\n" << outcome.out;
  }
  const Outcome all = succeed({"--help"});
  for (const std::string& command : kCommands) EXPECT_NE(all.out.find("\n  " + command), std::string::npos) << command;
}

TEST(Help, Version) {
  const Outcome outcome = succeed({"--version"});
  EXPECT_EQ(outcome.out, std::string("taxelsim ") + kVersion + "\n");
}

TEST(Arguments, AreRefusedInOneLine) {
  expectRefused(runTaxelsim({}), "subcommand");
  expectRefused(runTaxelsim({"simulate"}), "taxelsim --help");
  expectRefused(runTaxelsim({"simulate"}), "unknown subcommand 'simulate'; there are devices, frame, generate");
  expectRefused(runTaxelsim({"devices", "--colour"}), "unknown option --colour (see taxelsim devices --help)");
  expectRefused(runTaxelsim({"--log-level", "loud", "devices"}), "--log-level");
  expectRefused(runTaxelsim({"generate"}), "taxelsim generate --help");
  expectRefused(runTaxelsim({"generate", "scene.yaml"}), "--output");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--episodes", "0"}), "--episodes");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--episodes", "-3"}), "--episodes");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--episodes", "many"}), "--episodes");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--seed", "1.5"}), "--seed");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--seed", "-1"}), "--seed");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-o", "out", "--batch-size", "0"}), "--batch-size");
  expectRefused(runTaxelsim({"inspect"}), "directory");
  expectRefused(runTaxelsim({"render", "out"}), "--output");
  expectRefused(runTaxelsim({"render", "out", "-o", "a.png", "--frames", "0"}), "--frames");
  expectRefused(runTaxelsim({"render", "out", "-o", "a.png", "--episode", "-1"}), "--episode");
}

TEST(Arguments, MisspelledWordsAreNamedWithTheNearest) {
  expectRefused(runTaxelsim({"frme"}), "unknown subcommand 'frme'; did you mean frame?");
  expectRefused(runTaxelsim({"--log-level", "error", "genrate", "scene.yaml"}), "unknown subcommand 'genrate'; did you mean generate?");
  expectRefused(runTaxelsim({"frame", "--sensors", "x"}), "unknown option --sensors; did you mean --sensor? (see taxelsim frame --help)");
  expectRefused(runTaxelsim({"frame", "--sensor", "x", "--lod=3"}), "unknown option --lod; did you mean --load?");
  expectRefused(runTaxelsim({"generate", "scene.yaml", "-x", "3"}), "unknown option -x");
  expectRefused(runTaxelsim({"frame", "--sensor", "x", "--log-levl", "error"}), "did you mean --log-level?");
  expectRefused(runTaxelsim({"inspect", "a", "b"}), "not expected: b");
}

TEST(Arguments, NumbersWithoutQuotesAreShownWithThem) {
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "sphere:0.01", "--pose", "0", "0", "-0.0095", "1", "0", "0", "0"}),
                "--pose 0 0 -0.0095 1 0 0 0: these numbers are one argument and need quotes: --pose \"0 0 -0.0095 1 0 0 0\"");
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--rpy-deg", "0", "90", "0"}), "--rpy-deg \"0 90 0\"");
}

TEST(Arguments, ValuesThatAreNoNumbersAreNamed) {
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "half_space", "--load", "5N"}), "--load: 5N is not a number");
  expectRefused(runTaxelsim({"compare", "a", "b", "--at", "x"}), "--at: x is not a number");
}

TEST(Arguments, PicturesArePngFiles) {
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--png", "x.jpg"}), "--png: x.jpg: pictures are PNG files");
  expectRefused(runTaxelsim({"evaluate", "s.yaml", "--png", "x"}), "--png: x: pictures are PNG files");
  expectRefused(runTaxelsim({"compare", "a", "b", "-o", "x.svg"}), "--output: x.svg: pictures are PNG files");
  expectRefused(runTaxelsim({"render", "a", "-o", "png"}), "--output: png: the name must end in .png, or in .webp, .mp4 or .gif");
}

// Poses are checked before files are opened or devices listed.
TEST(Arguments, PosesAreRefusedInOneLine) {
  const auto frame = [](const std::string& pose) {
    return runTaxelsim({"frame", "--sensor", "no.yaml", "--object", "sphere:0.01", "--pose", pose});
  };
  expectRefused(frame("0 0"), "has 2 numbers, not 3 or 7");
  expectRefused(frame(""), "has 0 numbers");
  expectRefused(frame("0 0 0 1 0 0 0 0"), "more than 7");
  expectRefused(frame("0 0 0.01 1 1 0 0"), "length 1.41421");
  expectRefused(frame("0 0 0.01 0 0 0 0"), "length 0");
  expectRefused(frame("nan 0 0 1 0 0 0"), "number 1 cannot be read");
  expectRefused(frame("0 inf 0 1 0 0 0"), "number 2 cannot be read");
  expectRefused(frame("0 0 1e999 1 0 0 0"), "number 3 cannot be read");
  expectRefused(frame("0 0 0x1 1 0 0 0"), "number 3 cannot be read");
  expectRefused(frame("0 0 up 1 0 0 0"), "number 3 cannot be read");
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "sphere:0.01"}), "--pose is missing");
  const auto turned = [&](const std::string& pose, const std::string& rotation) {
    return runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "sphere:0.01", "--pose", pose, "--rpy-deg", rotation});
  };
  expectRefused(turned("0 0 0 1 0 0 0", "0 0 0"), "has a rotation: --rpy-deg excludes it");
  expectRefused(turned("0 0 0", "0 0"), "--rpy-deg \"0 0\": has 2 numbers, not 3");
  expectRefused(turned("0 0 0", "0 0 361"), "361 is not allowed: from -360 to 360");
  expectRefused(
      runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "half_space", "--load", "1", "--rpy-deg", "0 0 0", "--rpy-deg", "0 0 0"}),
      "1 --object but 2 --rpy-deg");
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "half_space", "--object", "half_space", "--load", "1"}),
                "2 --object but 0 --pose");
  expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "sphere:0.01", "--object", "sphere:1", "--pose", "0 0 0 1 0 0 0"}),
                "2 --object but 1 --pose");
  std::vector<std::string> many{"frame", "--sensor", "s.yaml"};
  for (int i = 0; i < 9; ++i) many.insert(many.end(), {"--object", "half_space", "--pose", "-0.1 0 0 1 0 0 0"});
  expectRefused(runTaxelsim(many), "at most 8");
  for (const std::string load : {"-1", "nan", "inf", "heavy"})
    expectRefused(runTaxelsim({"frame", "--sensor", "s.yaml", "--object", "sphere:0.01", "--pose", "0 0 0 1 0 0 0", "--load", load}),
                  "--load");
}

TEST(Arguments, FilesThatAreNotThere) {
  expectRefused(runTaxelsim({"inspect", "/nowhere"}), "/nowhere");
  expectRefused(runTaxelsim({"render", "/nowhere", "-o", "/tmp/x.png"}), "/nowhere");
}

// A pipe would block the program, and a device may have no end. Each kind of file, named on the command line or by another file.
TEST(Arguments, FilesThatAreNotRegularAreRefused) {
  const TemporaryDirectory root;
  const std::string sensor = TAXELSIM_SOURCE_DIR "/scenes/sensors/wts0614_soft_cover.yaml", zero = "/dev/zero";
  const auto written = [&](const std::string& name, const std::string& text) {
    std::ofstream(root / name) << text;
    return std::string(root / name);
  };
  const auto scene = [&](const std::string& name, const std::string& sensor_file, const std::string& object) {
    return written(name, "format_version: 1\nname: a\nkind: contacts\nsensor: " + sensor_file + "\nobjects: [" + object + "]\n");
  };
  for (const std::string extension : {"yaml", "obj", "stl", "ply", "glb", "gltf", "csv", "urdf"})
    ASSERT_EQ(mkfifo((root / ("pipe." + extension)).c_str(), 0600), 0);
  const std::string pipe = root / "pipe.", yaml = pipe + "yaml", csv = pipe + "csv";
  std::vector<std::vector<std::string>> commands{
      {"generate", yaml, "-o", root / "out"},
      {"generate", zero, "-o", root / "out"},
      {"evaluate", yaml},
      {"experiment", yaml},
      {"characterize", yaml, "-o", root / "out"},
      {"frame", "--sensor", yaml, "--object", "sphere:0.01", "--load", "1"},
      {"frame", "--sensor", sensor, "--contacts", csv},
      {"frame", "--sensor", sensor, "--contacts", zero},
      {"devices", "--plan", yaml},
      {"devices", "--plan", scene("sensor.yaml", yaml, "{sphere: {radius_mm: 5}}")},
      {"devices", "--plan", scene("mesh.yaml", sensor, "{mesh: pipe.obj}")},
      {"devices", "--plan", scene("waypoints.yaml", sensor, "{sphere: {radius_mm: 5}, motion: {waypoints: {file: pipe.csv}}}")},
      {"devices", "--plan", scene("contour.yaml", sensor, "{box: {size_mm: [9, 9, 9]}, contour: {file: pipe.csv}}")},
      {"characterize", "-o", root / "out",
       written("table.yaml", "format_version: 1\nmeasurement: force_depth\nsensor: " + sensor +
                                 "\ntable: pipe.csv\nindenter: {flat_pin: {radius_mm: 0.5}}\n")},
  };
  for (const char* extension : {"obj", "stl", "ply", "glb", "gltf"})
    commands.push_back({"frame", "--sensor", sensor, "--object", pipe + extension, "--pose", "0 0 0.01"});
  for (const auto& command : commands) {
    const Outcome outcome = runTaxelsim(command);
    SCOPED_TRACE(command[0] + " " + command[1] + " " + command.back());
    expectRefused(outcome, "not a");  // regular file, or file
  }
}

}  // namespace
}  // namespace taxelsim::testing
