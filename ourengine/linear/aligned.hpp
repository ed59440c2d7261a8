// Vectors on cache-line boundaries, for the SIMD kernels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace ourengine {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kAlignment{64};
  CacheLineAllocator() = default;
  template <class U>
  explicit CacheLineAllocator(const CacheLineAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kAlignment)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, kAlignment); }
  template <class U>
  bool operator==(const CacheLineAllocator<U>&) const {
    return true;
  }
};

using AlignedDoubles = std::vector<double, CacheLineAllocator<double>>;
using AlignedIntegers = std::vector<std::int64_t, CacheLineAllocator<std::int64_t>>;

}  // namespace ourengine
