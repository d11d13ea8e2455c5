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

/// Memory for arrays of megabytes, in huge pages where the system has them: filling fresh small pages costs
/// ten times more.
void* allocate_large(std::size_t bytes);
void free_large(void* p) noexcept;  ///< Gives back what `allocate_large` gave; nothing for a null pointer.

/// Allocator that leaves plain values uninitialised (also those with default member values, such as Vec3), so
/// that large arrays are touched first by the threads that fill them.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
    static constexpr std::size_t kLarge = std::size_t{4} << 20;  ///< [bytes]

    template <class U>
    /// What the standard asks of an allocator.
    struct rebind {
        using other = UninitializedAllocator<U>;  ///< for values of U
    };
    /// Memory for `count` values, from the heap or, where it is large, as huge pages.
    T* allocate(std::size_t count) {
        if (count < kLarge / sizeof(T)) return std::allocator<T>::allocate(count);
        if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
        return static_cast<T*>(allocate_large(count * sizeof(T)));
    }
    /// Gives back what `allocate` gave for the same `count`.
    void deallocate(T* p, std::size_t count) noexcept {
        if (count < kLarge / sizeof(T)) return std::allocator<T>::deallocate(p, count);
        free_large(p);
    }
    template <class U, class... Args>
    /// Does nothing for plain values without arguments; else makes the value as usual.
    void construct(U* p, Args&&... args) {
        if constexpr (sizeof...(Args) > 0) {
            ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
        } else if constexpr (!std::is_trivially_copyable_v<U> || !std::is_trivially_destructible_v<U>) {
            ::new (static_cast<void*>(p)) U;
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
    Column() = default;  ///< no values
    /// `size` copies of a value
    explicit Column(std::uint32_t size, const T& value = T{}) : values_(size, value) {}
    Column(std::initializer_list<T> values) : values_(values) {}  ///< these values, for ids 0, 1, ...
    explicit Column(std::vector<T> values) : values_(std::move(values)) {}  ///< takes the vector over

    /// number of values; ids below it are valid
    std::uint32_t size() const { return static_cast<std::uint32_t>(values_.size()); }
    void reserve(std::uint32_t size) { values_.reserve(size); }       ///< memory for this many
    void resize(std::uint32_t size) { values_.resize(size); }         ///< new ones are T{}
    void push_back(T value) { values_.push_back(std::move(value)); }  ///< for the id `size()`

    T& operator[](IdType id) { return values_[id.index()]; }              ///< id must be valid; unchecked
    const T& operator[](IdType id) const { return values_[id.index()]; }  ///< id must be valid; unchecked

    std::span<const T> span() const { return values_; }              ///< in order of id
    std::span<T> span() { return values_; }                          ///< in order of id
    friend bool operator==(const Column&, const Column&) = default;  ///< value by value

  private:
    std::vector<T> values_;
};

}  // namespace coppice
