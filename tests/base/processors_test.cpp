#include "base/processors.h"

#include <sched.h>

#include <climits>

#include "support/temporary_directory.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

class Quotas : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text;
  }
  int processors() const { return controlGroupProcessors(root_ / "self", root_ / "mount"); }

 private:
  TemporaryDirectory root_;
};

TEST_F(Quotas, LeastQuotaOfVersion2) {
  EXPECT_EQ(processors(), INT_MAX) << "no groups";
  write("self", "0::/jobs/7\n");
  EXPECT_EQ(processors(), INT_MAX) << "no files";
  write("mount/jobs/7/cpu.max", "max 100000\n");
  EXPECT_EQ(processors(), INT_MAX);
  write("mount/jobs/cpu.max", "450000 100000\n");
  EXPECT_EQ(processors(), 4) << "of the group around it, without the half";
  write("mount/jobs/7/cpu.max", "20000 100000\n");
  EXPECT_EQ(processors(), 1) << "a fifth of a processor";
}

TEST_F(Quotas, QuotaOfVersion1) {
  write("self", "12:cpu,cpuacct:/jobs\n4:memory:/jobs/7\n");
  write("mount/cpu/jobs/cpu.cfs_period_us", "50000\n");
  write("mount/cpu/jobs/cpu.cfs_quota_us", "-1\n");
  EXPECT_EQ(processors(), INT_MAX);
  write("mount/cpu/jobs/cpu.cfs_quota_us", "100000\n");
  EXPECT_EQ(processors(), 2);
}

TEST(UsableProcessors, AreThoseOfTheAffinityMask) {
  cpu_set_t before, one;
  ASSERT_EQ(sched_getaffinity(0, sizeof(before), &before), 0);
  EXPECT_LE(usableProcessors(), CPU_COUNT(&before));
  CPU_ZERO(&one);
  for (int processor = 0; CPU_COUNT(&one) == 0; ++processor)
    if (CPU_ISSET(processor, &before)) CPU_SET(processor, &one);
  ASSERT_EQ(sched_setaffinity(0, sizeof(one), &one), 0);
  EXPECT_EQ(usableProcessors(), 1);
  sched_setaffinity(0, sizeof(before), &before);
}

}  // namespace
}  // namespace taxelsim::testing
