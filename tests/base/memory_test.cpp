#include "base/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include "support/temporary_directory.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

class ControlGroups : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  std::uint64_t limit() const { return controlGroupMemory(root_ / "self", root_ / "mount"); }

 private:
  TemporaryDirectory root_;
};

TEST_F(ControlGroups, LeastLimitOfVersion2) {
  EXPECT_EQ(limit(), kNoLimit) << "no groups";
  write("self", "0::/jobs/7\n");
  EXPECT_EQ(limit(), kNoLimit) << "no files";
  write("mount/jobs/7/memory.max", "max\n");
  EXPECT_EQ(limit(), kNoLimit);
  write("mount/jobs/memory.max", "3000000000\n");
  EXPECT_EQ(limit(), 3000000000u) << "of the group around it";
  write("mount/jobs/7/memory.max", "1000000000\n");
  EXPECT_EQ(limit(), 1000000000u);
}

TEST_F(ControlGroups, LimitOfAContainer) {
  write("self", "0::/\n");
  write("mount/memory.max", "500000000\n");
  EXPECT_EQ(limit(), 500000000u);
}

TEST_F(ControlGroups, LimitOfVersion1) {
  write("self", "12:cpu,cpuacct:/jobs\n4:memory:/jobs/7\n");
  write("mount/memory/jobs/7/memory.limit_in_bytes", "700000000\n");
  write("mount/jobs/memory.max", "5\n");
  EXPECT_EQ(limit(), 700000000u);
}

TEST(UsableMemory, IsAtMostThatOfTheMachineAndTheProcess) {
  const std::uint64_t usable = usableMemory();
  EXPECT_GT(usable, std::uint64_t{1} << 20);
  EXPECT_LE(usable, static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)));
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // whose address space is larger
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  const rlimit less{usable / 2, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &less), 0);
  EXPECT_EQ(usableMemory(), usable / 2);
  setrlimit(RLIMIT_AS, &before);
#endif
}

}  // namespace
}  // namespace taxelsim::testing
