// Counts what the program takes from the heap, by whatever name (new, malloc, a library's own).
// Include it in one source file of a test program: it defines malloc.
#pragma once

#include <atomic>
#include <cstddef>

namespace farhand {

inline std::atomic<std::size_t> heap_allocations{0};

// Calls f and returns how many allocations happened meanwhile.
template <typename F>
std::size_t allocations_in(F&& f) {
  const std::size_t before = heap_allocations;
  f();
  return heap_allocations - before;
}

}  // namespace farhand

#ifdef FARHAND_SANITIZED

#include <sanitizer/allocator_interface.h>

namespace farhand {
inline const int kAllocationHook = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++heap_allocations; }, [](const volatile void*) {});
}  // namespace farhand

#else

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

void* malloc(std::size_t size) {
  ++farhand::heap_allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++farhand::heap_allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  ++farhand::heap_allocations;
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++farhand::heap_allocations;
  return __libc_memalign(alignment, size);
}
}

#endif
