#pragma once

namespace mane::fixtures {

/// Counts this thread's heap allocations, malloc and all that is built on it, while it lives.
class AllocationCount {
 public:
  AllocationCount();
  ~AllocationCount();
  [[nodiscard]] long count() const;
};

}  // namespace mane::fixtures
