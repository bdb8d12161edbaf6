// Subcommands that are written in Python: `evaluate --policy` stands for all, which python/tests/test_program.py has.
#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

// Environment in which python3 is a shell script, first in PATH.
std::vector<std::string> withPython(const TemporaryDirectory& root, const std::string& script) {
  std::ofstream(root / "python3") << "#!/bin/sh\n" << script << "\n";
  std::filesystem::permissions(root / "python3", std::filesystem::perms::owner_all);
  return {"PATH=" + (root / "").string() + ":/usr/bin:/bin"};
}

TEST(PythonSubcommands, NeedThePythonPackage) {
  const TemporaryDirectory root, nothing;
  const auto without_packages = withPython(root, "PATH=/usr/bin:/bin exec python3 -I -S \"$@\"");
  const Outcome outcome = runTaxelsim({"evaluate", "scene.yaml", "--policy", "p.onnx"}, {.environment = without_packages});
  expectRefused(outcome, "evaluate --policy needs the Python package taxelsim");
  const std::vector<std::string> video{"render", "out", "-o", "a.mp4"};
  for (const auto& environment : {without_packages, {"PATH=" + nothing.path().string()}})
    expectRefused(runTaxelsim(video, {.environment = environment}), "render a.mp4 needs the Python package taxelsim");
}

TEST(PythonSubcommands, RunInPython) {
  const TemporaryDirectory root;
  const auto environment = withPython(root, "if [ \"$1\" = -c ]; then shift 3; echo \"$@\"; exit 7; fi");
  const Outcome outcome = runTaxelsim({"evaluate", "scene.yaml", "--policy=p.onnx", "--json"}, {.environment = environment});
  EXPECT_EQ(outcome.status, 7) << outcome.err;
  EXPECT_EQ(outcome.out, "evaluate scene.yaml --policy=p.onnx --json\n");
}

}  // namespace
}  // namespace taxelsim::testing
