// Puts grooms and jobs until it is killed: storage_writer DATABASE FIRST_NUMBER. Writes one line to
// stdout for each that the store has acknowledged: `groom N` or `job N`. Exits 1 on an error.

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "storage/test_grooms.h"

namespace mane::storage {
namespace {

constexpr int64_t kNoLimit = 1'000'000'000;

template <typename T>
void Require(const Result<T>& result) {
  if (result) return;
  std::fprintf(stderr, "storage_writer: %s\n", result.error().message.c_str());
  std::exit(1);
}

// In one write, so that the reader never sees half a line; past stdio's buffer.
void Acknowledge(const char* kind, uint64_t number) {
  const std::string line = fmt::format("{} {}\n", kind, number);
  if (write(STDOUT_FILENO, line.data(), line.size()) != static_cast<ssize_t>(line.size())) {
    std::exit(1);
  }
}

[[noreturn]] void Write(const char* database, uint64_t number) {
  const auto grooms = GroomStore::Open(database);
  Require(grooms);
  const auto jobs = JobStore::Open(database);
  Require(jobs);
  for (;; ++number) {
    if (number % 4 == 0) {
      Require((*jobs)->Insert(TestJob(number), kNoLimit));
      Acknowledge("job", number);
    } else {
      const GroomContent content = TestContent(number);
      Require((*grooms)->Put(TestGroom(number, content), content));
      Acknowledge("groom", number);
    }
  }
}

}  // namespace
}  // namespace mane::storage

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  mane::storage::Write(argv[1], std::strtoull(argv[2], nullptr, 10));
}
