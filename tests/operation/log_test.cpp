// The log: what reaches the journal, and that whoever says something never waits for it.
#include "log/log.hpp"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <thread>
#include <vector>

#include "core/allocation_count.hpp"
#include "temporary_folder.hpp"

namespace binpick::app {
namespace {

using testing::HasSubstr;

// The journal's end of the socket.
class TestJournal {
 public:
  TestJournal() {
    fd_ = socket(AF_UNIX, SOCK_DGRAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path().c_str(), path().size());
    const timeval limit{20, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~TestJournal() { close(fd_); }

  std::string path() const { return folder_.file("socket"); }
  // The fields of the next message; empty: none came for a long time.
  std::map<std::string, std::string> next() {
    char bytes[4096];
    const ssize_t count = recv(fd_, bytes, sizeof bytes, 0);
    std::map<std::string, std::string> fields;
    std::istringstream lines(
        std::string(bytes, static_cast<std::size_t>(std::max<ssize_t>(0, count))));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t equals = line.find('=');
      EXPECT_NE(equals, std::string::npos) << line;
      fields[line.substr(0, equals)] = line.substr(equals + 1);
    }
    return fields;
  }

 private:
  TemporaryFolder folder_;
  int fd_ = -1;
};

LogParams params_for(const std::string& journal_path) {
  LogParams params;
  params.journal_path = journal_path;
  return params;
}

TEST(Log, TheJournalGetsFields) {
  TestJournal journal;
  Log log(params_for(journal.path()));
  log.about_cycle(LogLevel::kWarning, 42, "sensor_lost", "no frame for %d ms", 900);
  auto fields = journal.next();
  EXPECT_EQ(fields["MESSAGE"], "no frame for 900 ms");
  EXPECT_EQ(fields["PRIORITY"], "4");
  EXPECT_EQ(fields["SYSLOG_IDENTIFIER"], "binpickd");
  EXPECT_EQ(fields["BINPICK_CYCLE"], "42");
  EXPECT_EQ(fields["BINPICK_CAUSE"], "sensor_lost");
  EXPECT_EQ(fields.size(), 5u);
  log.info("ready");
  fields = journal.next();
  EXPECT_EQ(fields["PRIORITY"], "6");
  EXPECT_EQ(fields.size(), 3u);
}

TEST(Log, ALineEndNeverMakesAField) {
  TestJournal journal;
  Log log(params_for(journal.path()));
  log.error("%s", "a\nPRIORITY=0\nb");
  auto fields = journal.next();
  EXPECT_EQ(fields["MESSAGE"], "a PRIORITY=0 b");
  EXPECT_EQ(fields["PRIORITY"], "3");
}

TEST(Log, LongMessagesAreCut) {
  TestJournal journal;
  Log log(params_for(journal.path()));
  log.info("%s", std::string(5000, 'x').c_str());
  EXPECT_EQ(journal.next()["MESSAGE"], std::string(LogLine::kTextBytes - 1, 'x'));
}

TEST(Log, SaysNoMoreThanItsLevel) {
  TestJournal journal;
  LogParams params = params_for(journal.path());
  params.level = LogLevel::kWarning;
  Log log(params);
  log.info("not said");
  log.debug("not said");
  log.warning("said");
  EXPECT_EQ(journal.next()["MESSAGE"], "said");
  log.set_level(LogLevel::kDebug);
  log.debug("said now");
  EXPECT_EQ(journal.next()["MESSAGE"], "said now");
}

TEST(Log, WhatIsSaidTooOftenIsCountedAndToldLater) {
  TestJournal journal;
  LogParams params = params_for(journal.path());
  params.rate = {3, 300'000'000};
  Log log(params);
  const auto say = [&](int i) { log.warning("lost %d", i); };
  for (int i = 0; i < 10; ++i) say(i);
  log.warning("another kind");
  for (const char* text : {"lost 0", "lost 1", "lost 2", "another kind"})
    EXPECT_EQ(journal.next()["MESSAGE"], text);
  EXPECT_EQ(log.counters().suppressed, 7u);
  std::this_thread::sleep_for(std::chrono::milliseconds(350));
  say(10);
  auto fields = journal.next();
  EXPECT_EQ(fields["MESSAGE"], "lost 10 (and 7 like it were left out)");
  EXPECT_EQ(fields["BINPICK_SUPPRESSED"], "7");
}

TEST(Log, WithoutAJournalLinesGoToTheErrorOutput) {
  int pipe_fds[2];
  ASSERT_EQ(pipe(pipe_fds), 0);
  {
    LogParams params = params_for("/nowhere/socket");
    params.fallback_fd = pipe_fds[1];
    Log log(params);
    log.warning("a %d", 1);
    log.info("b");
  }
  close(pipe_fds[1]);
  char bytes[256];
  const ssize_t count = read(pipe_fds[0], bytes, sizeof bytes);
  close(pipe_fds[0]);
  EXPECT_EQ(std::string(bytes, static_cast<std::size_t>(count)),
            "binpickd: warning: a 1\nbinpickd: b\n");
}

// Nobody reads the journal's socket, so the writer stands still after a few lines.
TEST(Log, AJournalThatHangsCostsLinesAndNoTime) {
  TestJournal journal;
  LogParams params = params_for(journal.path());
  params.rate.burst = 0;
  params.fallback_fd = -1;
  Log log(params);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 5000; ++i) log.info("line %d", i);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 20.0) << "5000 waits would have taken longer";
  EXPECT_GT(log.counters().dropped, 4000u);
  // The reader comes: first what was in time, in order, then how much was lost.
  bool told = false;
  for (int i = 0; i < 400 && !told; ++i)
    told = journal.next()["MESSAGE"].find("lines are lost") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST(Log, EveryLineOfManyThreadsComesOnceAndWhole) {
  TestJournal journal;
  LogParams params = params_for(journal.path());
  params.rate.burst = 0;
  Log log(params);
  constexpr int kThreads = 4, kLines = 200;
  std::atomic<int> said{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&log, &said, t] {
      for (int i = 0; i < kLines; ++i) {
        // Not faster than the journal is read.
        while (said - static_cast<int>(log.counters().written) > 100) std::this_thread::yield();
        ++said;
        log.info("thread %d line %d end", t, i);
      }
    });
  }
  std::array<int, kThreads> next{};
  for (int n = 0; n < kThreads * kLines; ++n) {
    int t = -1, i = -1;
    char end[4] = "";
    const std::string text = journal.next()["MESSAGE"];
    ASSERT_EQ(std::sscanf(text.c_str(), "thread %d line %d %3s", &t, &i, end), 3) << text;
    EXPECT_STREQ(end, "end");
    EXPECT_EQ(i, next[static_cast<std::size_t>(t)]++) << "of thread " << t;
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(log.counters().dropped, 0u);
}

TEST(Log, NothingIsTakenFromTheHeap) {
  if (!allocations_counted()) GTEST_SKIP() << "SKIPPED: a sanitizer holds malloc";
  TestJournal journal;
  LogParams params = params_for(journal.path());
  params.rate.burst = 5;
  Log log(params);
  log.info("first");
  journal.next();
  const long long before = allocation_count();
  for (int i = 0; i < 1000; ++i) {
    log.info("line %d %.1f %s", i, i * 0.5, "text");
    log.about_cycle(LogLevel::kInfo, 7, "done", "cycle");
  }
  const timespec pause{0, 1'000'000};
  for (int i = 0; i < 20'000 && log.counters().written < 11; ++i) nanosleep(&pause, nullptr);
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(log.counters().written, 11u);
}

TEST(JournalSocket, IsUsedOnlyWhereTheErrorOutputIsTheJournals) {
  unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(JournalSocket::path_of_journal(), "");
  setenv("JOURNAL_STREAM", "1:2", 1);
  EXPECT_EQ(JournalSocket::path_of_journal(), "");
  struct stat status {};
  ASSERT_EQ(fstat(STDERR_FILENO, &status), 0);
  const std::string ours = std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  setenv("JOURNAL_STREAM", ours.c_str(), 1);
  EXPECT_EQ(JournalSocket::path_of_journal(), "/run/systemd/journal/socket");
  unsetenv("JOURNAL_STREAM");
}

}  // namespace
}  // namespace binpick::app
