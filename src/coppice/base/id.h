#pragma once

#include <compare>
#include <cstdint>

namespace coppice {

/// The index of no element, in place of an index of 32 bits.
inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

/// Identifies an element of an object: a node of a skeleton, a face of a mesh. Ids of different kinds are
/// different types. The default id is `none()`.
template <class Tag>
class Id {
  public:
    constexpr Id() = default;                                      ///< refers to no element
    constexpr explicit Id(std::uint32_t index) : index_(index) {}  ///< the element of this index
    static constexpr Id none() { return {}; }                      ///< refers to no element

    constexpr std::uint32_t index() const { return index_; }                 ///< 2^32 - 1 for `none()`
    constexpr explicit operator bool() const { return index_ != kNoIndex; }  ///< false for `none()`
    friend constexpr auto operator<=>(Id, Id) = default;  ///< by index; `none()` is the largest

  private:
    std::uint32_t index_ = kNoIndex;
};

using NodeId = Id<struct NodeTag>;      ///< of a Skeleton
using StableId = Id<struct StableTag>;  ///< of a node through all edits of its tree: see Skeleton::stable_id

}  // namespace coppice
