// What the stores have acknowledged survives kill -9: a process that writes is killed at a random
// moment, many times over on one file; each time all that it acknowledged, ever, is there and
// whole, whatever it had half written is not, and the file is sound.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <sstream>
#include <thread>
#include <vector>

#include "storage/test_folder.h"
#include "storage/test_grooms.h"

extern char** environ;

namespace mane::storage {
namespace {

constexpr int kRounds = 30;
constexpr std::chrono::seconds kDeadline{60};  // Of a round.

// A running storage_writer and the end of the pipe that it acknowledges on.
class Writer {
 public:
  Writer(const std::filesystem::path& database, uint64_t first_number) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    acknowledgements_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::string program = MANE_STORAGE_WRITER, path = database,
                number = fmt::to_string(first_number);
    char* arguments[] = {program.data(), path.data(), number.data(), nullptr};
    if (posix_spawn(&process_, program.c_str(), &actions, nullptr, arguments, environ) != 0) {
      process_ = -1;
    }
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    Kill();
    if (acknowledgements_ >= 0) close(acknowledgements_);
  }

  [[nodiscard]] bool started() const { return process_ > 0; }
  [[nodiscard]] const std::string& received() const { return received_; }

  // Reads on until there are `lines` lines. False at the end of the pipe or of the time.
  bool ReadLines(size_t lines) {
    const auto end = std::chrono::steady_clock::now() + kDeadline;
    while (static_cast<size_t>(std::count(received_.begin(), received_.end(), '\n')) < lines) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      pollfd ready{acknowledgements_, POLLIN, 0};
      if (left.count() <= 0 || poll(&ready, 1, static_cast<int>(left.count())) <= 0) return false;
      char buffer[4096];
      const ssize_t size = read(acknowledgements_, buffer, sizeof(buffer));
      if (size <= 0) return false;
      received_.append(buffer, static_cast<size_t>(size));
    }
    return true;
  }

  // Kills it with SIGKILL and takes what is left in the pipe. True if the signal ended it.
  bool Kill() {
    if (process_ <= 0) return false;
    kill(process_, SIGKILL);
    int status = 0;
    const bool ended = waitpid(process_, &status, 0) == process_;
    process_ = -1;
    ReadLines(SIZE_MAX);
    return ended && WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  }

 private:
  pid_t process_ = -1;
  int acknowledgements_ = -1;
  std::string received_;
};

struct Acknowledged {
  std::vector<uint64_t> grooms, jobs;

  void Add(const std::string& lines) {
    std::istringstream stream(lines);
    std::string kind;
    uint64_t number = 0;
    while (stream >> kind >> number) (kind == "job" ? jobs : grooms).push_back(number);
  }
};

void ExpectWholeGroom(GroomStore& store, uint64_t number) {
  const GroomContent expected = TestContent(number);
  const auto record = store.Get(fmt::format("groom-{}", number));
  MANE_ASSERT_OK(record);
  EXPECT_EQ(*record, TestGroom(number, expected));
  const auto content = store.GetContent(record->id);
  MANE_ASSERT_OK(content);
  EXPECT_EQ(*content, expected);
}

void ExpectSound(const std::filesystem::path& path) {
  auto database = Database::Open(path);
  MANE_ASSERT_OK(database);
  auto check = database->Prepare("PRAGMA integrity_check");
  MANE_ASSERT_OK(check);
  MANE_ASSERT_OK(check->Step());
  EXPECT_EQ(check->Bytes(0), "ok");
}

void ExpectAllThere(const std::filesystem::path& path, const Acknowledged& acknowledged) {
  auto grooms = GroomStore::Open(path);
  MANE_ASSERT_OK(grooms);
  for (const uint64_t number : acknowledged.grooms) {
    SCOPED_TRACE(fmt::format("groom {}", number));
    ExpectWholeGroom(**grooms, number);
  }
  auto jobs = JobStore::Open(path);
  MANE_ASSERT_OK(jobs);
  for (const uint64_t number : acknowledged.jobs) {
    SCOPED_TRACE(fmt::format("job {}", number));
    const auto job = (*jobs)->Get(fmt::format("job-{}", number));
    MANE_ASSERT_OK(job);
    EXPECT_EQ(job->description, fmt::format("Job {}", number));
  }
}

// Every groom that is there is whole, acknowledged or not; each round may have left one that was
// stored but not yet acknowledged.
void ExpectNothingTorn(const std::filesystem::path& path, size_t acknowledged) {
  auto grooms = GroomStore::Open(path);
  MANE_ASSERT_OK(grooms);
  size_t there = 0;
  std::string token;
  do {
    const auto page = (*grooms)->List(kMaxPageSize, token);
    MANE_ASSERT_OK(page);
    for (const auto& record : page->records) ExpectWholeGroom(**grooms, record.seed);
    there += page->records.size();
    token = page->next_page_token;
  } while (!token.empty());
  EXPECT_GE(there, acknowledged);
  EXPECT_LE(there, acknowledged + kRounds);
}

TEST(KillTest, WhatWasAcknowledgedSurvives) {
  TestFolder folder;
  std::mt19937_64 random(20240117);
  Acknowledged all;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(fmt::format("round {}", round));
    Writer writer(folder.DatabasePath(), 1000 * (static_cast<uint64_t>(round) + 1));
    ASSERT_TRUE(writer.started());
    // Some acknowledgements, then an instant within the next few commits.
    ASSERT_TRUE(writer.ReadLines(1 + random() % 6)) << writer.received();
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 12'000));
    ASSERT_TRUE(writer.Kill());
    Acknowledged now;
    now.Add(writer.received());
    ASSERT_FALSE(now.grooms.empty() && now.jobs.empty());
    all.Add(writer.received());
    ExpectAllThere(folder.DatabasePath(), now);
  }
  ExpectAllThere(folder.DatabasePath(), all);
  ExpectNothingTorn(folder.DatabasePath(), all.grooms.size());
  ExpectSound(folder.DatabasePath());
  EXPECT_GE(all.grooms.size(), size_t{kRounds});
}

}  // namespace
}  // namespace mane::storage
