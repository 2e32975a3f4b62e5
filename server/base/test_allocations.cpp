#include "base/test_allocations.h"

#include <cerrno>
#include <cstddef>

// Counted by one thread at a time while a count lives.
namespace {
thread_local bool counting = false;
thread_local long allocations = 0;
void Count() { allocations += counting; }
}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

// The sanitizers own malloc and call this for each.
extern "C" void __sanitizer_malloc_hook(const volatile void*, size_t) { Count(); }

#else

// In front of glibc's own; operator new and Eigen call these.
extern "C" {
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* block, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

void* malloc(size_t size) {
  Count();
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  Count();
  return __libc_calloc(count, size);
}
void* realloc(void* block, size_t size) {
  Count();
  return __libc_realloc(block, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  Count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, size_t alignment, size_t size) {
  Count();
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
}

#endif

namespace mane::fixtures {

AllocationCount::AllocationCount() {
  allocations = 0;
  counting = true;
}
AllocationCount::~AllocationCount() { counting = false; }
long AllocationCount::count() const { return allocations; }

}  // namespace mane::fixtures
