#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "coppice/cage/hub_internal.h"

namespace coppice::cage_internal {

/// Minimum cosine of the angle between a stem and a leader that continues it.
inline constexpr float kMinCosine = 0.64f;

/// The cage around a branch node at which the leader continues the stem: two rings, below and above the
/// laterals, joined by four faces, and each lateral leaves through one of these. There is a ring of quads
/// between a thin lateral and the edge of its face. Each lateral has four vertices of valence 5; there are no
/// other irregular vertices.
class Openings {
  public:
    /// Returns nullopt if the leader turns from the stem, a lateral is nearly as thick as the stem or leaves
    /// along it, or two leave through the same face. O(k) for k branches.
    static std::optional<Openings> plan(std::span<const Branch> branches, std::uint32_t stem,
                                        std::uint32_t leader);

    /// [m] Returns the minimum length of a branch that is required.
    float reach(std::uint32_t branch) const;

    /// `room`: [m] available length of each branch. Returns nullopt if it is too small.
    std::optional<Hub> build(std::span<const float> room) const;

  private:
    // A lateral as seen from the stem.
    struct Lateral {
        std::uint32_t branch = 0;
        float radius = 0;
        float azimuth = 0;
        float half_width = 0;        // by azimuth
        std::array<Vec3, 4> corner;  // counter-clockwise about its direction, the two lower ones first
        float low = 0, high = 0;     // of the corners along the axis
        float way = 0;               // along the lateral, to the farthest corner
        std::uint32_t face = 0;
        bool is_wide() const;
    };

    Openings(std::span<const Branch> branches, std::uint32_t stem, std::uint32_t leader);
    bool add_lateral(std::uint32_t i, const Branch& b);
    bool choose_phase();
    float worst_side(float phase) const;
    bool is_open(std::uint32_t face) const;
    Vec3 on_axis(float height) const;
    void add_ring(float height, Hub& hub) const;
    void open(const Lateral& l, Hub& hub) const;

    Branch stem_, leader_;
    std::uint32_t stem_number_, leader_number_;
    float radius_;
    Frame frame_;
    std::vector<Lateral> lateral_;
    float phase_ = 0;           // azimuth of the middle of face 0
    float widened_ = 0;         // outward displacement of the corners of face 0
    float low_ = 0, high_ = 0;  // of all laterals, along the axis
    float margin_ = 0;          // preferred distance between these and the rings
};

}  // namespace coppice::cage_internal
