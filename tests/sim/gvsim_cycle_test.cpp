// A simulator that serves for weeks: many hosts come and go, and it stays as it was.
#include <dirent.h>
#include <gtest/gtest.h>

#include <fstream>

#include "raw_gev_host.hpp"
#include "simulator_process.hpp"
#include "tiny_scene.hpp"

namespace binpick {
namespace {

int entry_count(const std::string& folder) {
  int count = 0;
  DIR* entries = opendir(folder.c_str());
  while (entries != nullptr && readdir(entries) != nullptr) ++count;
  if (entries != nullptr) closedir(entries);
  return count;
}

struct Resources {
  int threads = 0, descriptors = 0;
  long resident_pages = 0;
};

Resources resources_of(pid_t pid) {
  const std::string process = "/proc/" + std::to_string(pid);
  Resources resources{entry_count(process + "/task"), entry_count(process + "/fd"), 0};
  std::ifstream memory(process + "/statm");
  long size = 0;
  memory >> size >> resources.resident_pages;
  return resources;
}

void one_host(const std::string& address) {
  RawGevHost host(address);
  host.start(576);
  for (int i = 0; i < 3; ++i) {
    host.trigger();
    EXPECT_FALSE(host.packets(10000, 5).empty());
  }
  EXPECT_EQ(host.write(0x10030, 1), 0);
  EXPECT_EQ(host.write(0x0a00, 0), 0);
}

TEST(Gvsim, StaysAsItIsOverManyHosts) {
  TinyScene scene(3);
  const std::string address = loopback_address();
  SimulatorProcess sim(GVSIM, {"--bind", address, "--scenes", scene.path()});
  for (int i = 0; i < 20; ++i) one_host(address);
  const Resources before = resources_of(sim.pid());
  for (int i = 0; i < 100; ++i) one_host(address);
  const Resources after = resources_of(sim.pid());
  EXPECT_EQ(after.threads, before.threads);
  EXPECT_EQ(after.descriptors, before.descriptors);
  EXPECT_LE(after.resident_pages, before.resident_pages + 64);  // 256 kB
}

}  // namespace
}  // namespace binpick
