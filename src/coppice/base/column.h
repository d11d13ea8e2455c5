#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace coppice {

/// Allocates memory for arrays of megabytes, in huge pages if the system has them: filling fresh small pages
/// costs ten times more.
void* allocate_large(std::size_t bytes);
void free_large(
    void* p) noexcept;  ///< Releases memory of `allocate_large`; has no effect for a null pointer.

/// An allocator that leaves plain values uninitialised (also those with default member values, such as Vec3),
/// so that large arrays are touched first by the threads that fill them.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
    static constexpr std::size_t kLarge = std::size_t{4} << 20;  ///< [bytes]

    template <class U>
    /// Required by the standard.
    struct rebind {
        using other = UninitializedAllocator<U>;  ///< for values of U
    };
    /// Allocates memory for `count` values, from the heap or, if it is large, in huge pages.
    T* allocate(std::size_t count) {
        if (count < kLarge / sizeof(T)) return std::allocator<T>::allocate(count);
        if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(allocate_large(count * sizeof(T)));
    }
    /// Releases memory of `allocate` for the same `count`.
    void deallocate(T* p, std::size_t count) noexcept {
        if (count < kLarge / sizeof(T)) return std::allocator<T>::deallocate(p, count);
        free_large(p);
    }
    template <class U, class... Args>
    /// Leaves plain values without arguments uninitialised; constructs others as usual.
    void construct(U* p, Args&&... args) {
        if constexpr (sizeof...(Args) > 0) {
            ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
        } else if constexpr (!std::is_trivially_copyable_v<U> || !std::is_trivially_destructible_v<U>) {
            ::new (static_cast<void*>(p)) U;
        }
    }
};

/// A vector that leaves plain numbers uninitialised on `resize`.
template <class T>
using Buffer = std::vector<T, UninitializedAllocator<T>>;

/// An array indexed by one kind of id: a column of a structure of arrays.
template <class IdType, class T>
class Column {
  public:
    Column() = default;  ///< no values
    /// `size` copies of a value
    explicit Column(std::uint32_t size, const T& value = T{}) : values_(size, value) {}
    Column(std::initializer_list<T> values) : values_(values) {}            ///< the values for ids 0, 1, ...
    explicit Column(std::vector<T> values) : values_(std::move(values)) {}  ///< takes ownership of the vector

    /// number of values; ids below it are valid
    std::uint32_t size() const { return static_cast<std::uint32_t>(values_.size()); }
    void reserve(std::uint32_t size) { values_.reserve(size); }  ///< reserves memory for that many values
    void resize(std::uint32_t size) { values_.resize(size); }    ///< new values are T{}
    void push_back(T value) { values_.push_back(std::move(value)); }  ///< adds the value of id `size()`

    T& operator[](IdType id) { return values_[id.index()]; }              ///< id must be valid; unchecked
    const T& operator[](IdType id) const { return values_[id.index()]; }  ///< id must be valid; unchecked

    std::span<const T> span() const { return values_; }              ///< in order of id
    std::span<T> span() { return values_; }                          ///< in order of id
    friend bool operator==(const Column&, const Column&) = default;  ///< compares the values

  private:
    std::vector<T> values_;
};

}  // namespace coppice
