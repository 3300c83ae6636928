// What a reader may do to its process, played by readers of our own.
#include "mesh_import_child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "binpick/train/errors.hpp"
#include "train/out_of_memory.hpp"
#include "train/tetrahedron.hpp"

namespace binpick::train {
namespace {

using testing::HasSubstr;

// What a reader that behaves like `reader` leads to; empty when its mesh arrives.
std::string fault_of(FileReader reader, const ChildLimits& limits = {}) {
  try {
    read_in_child(reader, "part", limits);
  } catch (const ImportError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadInChild, DeliversWhatTheReaderFound) {
  const FileContent content = read_in_child(
      [](const std::string& path) {
        return FileContent{tetrahedron(), path.size(), "a bent\nfacet"};
      },
      "part", {});
  EXPECT_EQ(content.mesh.vertices_mm, tetrahedron().vertices_mm);
  EXPECT_EQ(content.mesh.triangles, tetrahedron().triangles);
  EXPECT_EQ(content.skipped_count, 4u);
  EXPECT_EQ(content.remarks, "a bent facet");
}

TEST(ReadInChild, NamesTheSignalOfACrash) {
  EXPECT_EQ(fault_of([](const std::string&) -> FileContent { abort(); }),
            "its reader crashed (Aborted)");
  EXPECT_EQ(fault_of([](const std::string&) -> FileContent {
              raise(SIGSEGV);
              return {};
            }),
            "its reader crashed (Segmentation fault)");
}

TEST(ReadInChild, PassesOnTheReadersFault) {
  EXPECT_EQ(fault_of([](const std::string& path) -> FileContent {
              throw ImportError("no\x1bsense in " + path);
            }),
            "no sense in part");
  EXPECT_EQ(fault_of([](const std::string&) -> FileContent { throw 1; }), "its reader gave up");
  const std::string fault = fault_of([](const std::string&) -> FileContent {
    throw std::runtime_error(std::string(1'000'000, 'x'));
  });
  EXPECT_LT(fault.size(), 5000u);
}

TEST(ReadInChild, EndsAReaderThatWaitsForEver) {
  ChildLimits limits;
  limits.wall_s = 0.3;
  EXPECT_EQ(fault_of(
                [](const std::string&) -> FileContent {
                  for (;;) pause();
                },
                limits),
            "reading it took longer than 0.3 s");
}

TEST(ReadInChild, EndsAReaderThatComputesForEver) {
  ChildLimits limits;
  limits.processor_s = 1;
  EXPECT_EQ(fault_of(
                [](const std::string&) -> FileContent {
                  volatile bool running = true;
                  while (running) {
                  }
                  return {};
                },
                limits),
            "reading it took more than 1 s of processor time");
}

TEST(ReadInChild, LimitsMemory) {
  ChildLimits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  const std::string fault = fault_of(
      [](const std::string&) -> FileContent {
        FileContent content;
        content.mesh.vertices_mm.resize(100'000'000);
        return content;
      },
      limits);
  EXPECT_THAT(fault, HasSubstr(kOutOfMemory));
}

TEST(ReadInChild, NoticesAReaderThatLeavesWithoutAWord) {
  EXPECT_EQ(fault_of([](const std::string&) -> FileContent { _exit(0); }),
            "its reader ended without a result");
}

TEST(ReadInChild, NoticesGarbageInThePipe) {
  // A reader gone astray writes to every descriptor that it can reach.
  EXPECT_EQ(fault_of([](const std::string&) -> FileContent {
              const std::string garbage(200, 'g');
              for (int fd = 3; fd < 64; ++fd) {
                if (write(fd, garbage.data(), garbage.size()) < 0) continue;
              }
              _exit(0);
            }),
            "its reader answered with garbage");
}

TEST(ReadInChild, RefusesMoreTrianglesThanTheLimit) {
  EXPECT_THAT(fault_of([](const std::string&) -> FileContent {
                FileContent content;
                content.mesh.triangles.resize(kTrianglesMax + 1);
                return content;
              }),
              HasSubstr("more than 2000000 triangles"));
}

TEST(ReadInChild, ServesThreadsAtOnce) {
  std::vector<std::string> faults(6);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < faults.size(); ++i) {
    threads.emplace_back([&faults, i] {
      faults[i] = i % 2 == 0 ? fault_of([](const std::string&) -> FileContent { abort(); })
                             : fault_of([](const std::string&) { return FileContent{}; });
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < faults.size(); ++i) {
    EXPECT_EQ(faults[i], i % 2 == 0 ? "its reader crashed (Aborted)" : "");
  }
}

}  // namespace
}  // namespace binpick::train
