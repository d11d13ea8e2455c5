#pragma once

#include <cstdint>
#include <cstring>
#include <span>

namespace coppice {

/// FNV-1a over bytes: identifies results in benchmarks and tests; not for hash tables of untrusted keys.
class Hash {
  public:
    /// Adds the bytes of values, which must have no padding.
    template <class T>
    Hash& add(std::span<const T> values) {
        for (const std::byte b : std::as_bytes(values))
            value_ = (value_ ^ static_cast<std::uint64_t>(b)) * 0x100000001b3ull;
        return *this;
    }
    /// Adds the bytes of one value.
    template <class T>
    Hash& add(const T& value) {
        return add(std::span<const T>(&value, 1));
    }
    std::uint64_t value() const { return value_; }  ///< hash of everything added, in order

  private:
    std::uint64_t value_ = 0xcbf29ce484222325ull;
};

}  // namespace coppice
