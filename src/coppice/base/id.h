#pragma once

#include <compare>
#include <cstdint>

namespace coppice {

/// Names one element of one value: a node of a skeleton, a face of a mesh. Ids of different kinds do not mix.
/// The default id is `none()`.
template <class Tag>
class Id {
  public:
    constexpr Id() = default;                                      ///< names nothing
    constexpr explicit Id(std::uint32_t index) : index_(index) {}  ///< the element of this index
    static constexpr Id none() { return {}; }                      ///< names nothing

    constexpr std::uint32_t index() const { return index_; }              ///< 2^32 - 1 for `none()`
    constexpr explicit operator bool() const { return index_ != kNone; }  ///< false for `none()`
    friend constexpr auto operator<=>(Id, Id) = default;  ///< by index; `none()` is the greatest

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    std::uint32_t index_ = kNone;
};

using NodeId = Id<struct NodeTag>;      ///< of a Skeleton
using StableId = Id<struct StableTag>;  ///< of a node through all edits of its tree: see Skeleton::stable_id
using VertexId = Id<struct VertexTag>;  ///< of a mesh
using FaceId = Id<struct FaceTag>;      ///< of a mesh

}  // namespace coppice
