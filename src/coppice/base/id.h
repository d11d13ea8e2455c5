#pragma once

#include <compare>
#include <cstdint>

namespace coppice {

/// Names one element of one value: a node of a skeleton, a face of a mesh. Ids of different kinds do not mix.
/// The default id is `none()`.
template <class Tag>
class Id {
  public:
    constexpr Id() = default;
    constexpr explicit Id(std::uint32_t index) : index_(index) {}
    static constexpr Id none() { return {}; }

    constexpr std::uint32_t index() const { return index_; }
    constexpr explicit operator bool() const { return index_ != kNone; }
    friend constexpr auto operator<=>(Id, Id) = default;

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;
    std::uint32_t index_ = kNone;
};

using NodeId = Id<struct NodeTag>;
using VertexId = Id<struct VertexTag>;
using FaceId = Id<struct FaceTag>;

}  // namespace coppice
