#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace coppice {

/// Allocator that leaves plain values uninitialised, so that large arrays are touched first by the threads that fill them.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = UninitializedAllocator<U>;
    };
    template <class U, class... Args>
    void construct(U* p, Args&&... args) {
        if constexpr (sizeof...(Args) == 0) {
            ::new (static_cast<void*>(p)) U;
        } else {
            ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
        }
    }
};

/// A vector whose `resize` does not clear plain numbers.
template <class T>
using Buffer = std::vector<T, UninitializedAllocator<T>>;

/// An array indexed by one kind of id: column of a structure of arrays.
template <class IdType, class T>
class Column {
  public:
    Column() = default;
    explicit Column(std::uint32_t size, const T& value = T{}) : values_(size, value) {}
    Column(std::initializer_list<T> values) : values_(values) {}
    explicit Column(std::vector<T> values) : values_(std::move(values)) {}

    std::uint32_t size() const { return static_cast<std::uint32_t>(values_.size()); }
    void reserve(std::uint32_t size) { values_.reserve(size); }
    void resize(std::uint32_t size) { values_.resize(size); }
    void push_back(T value) { values_.push_back(std::move(value)); }

    T& operator[](IdType id) { return values_[id.index()]; }
    const T& operator[](IdType id) const { return values_[id.index()]; }

    std::span<const T> span() const { return values_; }
    std::span<T> span() { return values_; }
    friend bool operator==(const Column&, const Column&) = default;

  private:
    std::vector<T> values_;
};

}  // namespace coppice
