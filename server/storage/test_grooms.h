#pragma once

#include <cstdint>
#include <random>
#include <string>

#include "storage/groom_store.h"
#include "storage/job_store.h"

// Grooms and jobs that follow from their number, for kill_test and the process it kills: each
// tells the other's work whole from torn.
namespace mane::storage {

/// FNV-1a, 64 bits.
inline uint64_t Digest(std::string_view bytes) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return hash;
}

/// 0 to 256 KiB of noise, most of it short, so that there are many commits and long ones too.
inline std::string TestBytes(uint64_t seed) {
  std::mt19937_64 random(seed);
  const size_t limit = random() % 4 == 0 ? 262'144 : 8'192;
  std::string bytes(random() % limit, '\0');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

inline GroomContent TestContent(uint64_t number) {
  return {TestBytes(2 * number), TestBytes(2 * number + 1)};
}

inline GroomRecord TestGroom(uint64_t number, const GroomContent& content) {
  GroomRecord record;
  record.id = fmt::format("groom-{}", number);
  record.request_id = fmt::format("request-{}", number);
  record.display_name = fmt::format("Groom {}", number);
  record.seed = number;
  record.guide_count = static_cast<uint32_t>(number % 1000);
  record.longest_guide_m = 1e-3 * static_cast<double>(number);
  record.etag = fmt::format("{:016x}{:016x}", Digest(content.groom), Digest(content.rest));
  record.create_time_ns = static_cast<int64_t>(number);
  if (number % 2 == 1) record.import_summary = std::string("\0summary", 8);
  return record;
}

inline NewJob TestJob(uint64_t number) {
  return {fmt::format("job-{}", number), "", "test", fmt::format("Job {}", number),
          TestBytes(number)};
}

}  // namespace mane::storage
