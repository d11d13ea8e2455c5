#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "coppice/base/column.h"
#include "coppice/base/compressed_rows.h"
#include "coppice/cuda/field/field_view.h"
#include "coppice/field/contact_lists.h"
#include "coppice/field/convolution_field.h"
#include "coppice/mesh/control_mesh.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice::cuda {

/// What a search knows of a segment, named by its child node.
struct alignas(16) SegmentLink {
    std::uint32_t start;  ///< the node where it begins; a root is its own
    std::uint32_t thick;  ///< the node whose radius it begins with
    NodeId rival_of;      ///< the tube that wraps it; none where it is no one's rival
    std::uint32_t rank;   ///< its place in a list of all segments
};

/// What a search knows of a tube, and of the region about it.
struct alignas(16) TubeLink {
    NodeId parent;         ///< none for the first of a tree
    std::uint32_t end;     ///< one past the last tube of its subtree
    std::uint32_t seed;    ///< the tube with which the flood of the region begins
    std::uint32_t source;  ///< the node of the skeleton that the region is named by
};

/// How the segments, tubes and quads of a surface hang together: all that its lists are made of, but for
/// places and radii.
struct ContactTopology {
    std::vector<SegmentLink> segments;       ///< by child node
    Buffer<std::uint32_t> in_order;          ///< segments by rank: axis by axis, or ascending without blend
    std::vector<TubeLink> tubes;             ///< by tube, which is by region
    CompressedRows<std::uint32_t> contents;  ///< the segments that each tube wraps
    CompressedRows<std::uint32_t> quads;     ///< the cage quads of each region
    /// Of several surfaces: the first segment of each, and one more. Empty: there is one.
    std::vector<std::uint32_t> first_segment;
};

/// What a surface is made of: `tubes` wrap the segments of `skeleton`, of which `field` was made, and have
/// the quads of `control`.
struct ContactInput {
    const Skeleton& skeleton;       ///< that of the field
    TubeTree tubes;                 ///< one for each region; depth-first order
    const ConvolutionField& field;  ///< its contact must be above 0; needs no regions
    const ControlMesh& control;     ///< the cage about the tubes
};

/// Stays valid while nodes move and until radii change so that another child is the thickest. O(n).
ContactTopology contact_topology(const ContactInput& input);

/// The same of several surfaces as one: segments, tubes and quads of each follow those of the one before.
/// None is a rival of another's.
ContactTopology contact_topology(std::span<const ContactInput> inputs);

/// A ContactTopology in the arrays of an executor, by the same names.
struct ContactTables {
    /// See there.
    /// @{
    std::span<const SegmentLink> segments;
    std::span<const std::uint32_t> in_order;
    std::span<const TubeLink> tubes;
    std::span<const std::uint32_t> first_content, contents;
    std::span<const std::uint32_t> first_quad, quads;
    std::span<const std::uint32_t> first_segment;
    /// @}
};

/// Places and radii of several surfaces as one: see contact_topology(). Their fields have the same options.
struct ContactPlaces {
    /// See ContactGeometry.
    /// @{
    std::vector<DeviceSegment> segments;
    float reach = 0;
    std::vector<Vec3> nodes, tube_nodes, cage, anchors;
    std::vector<float> radii, tube_radii;
    std::vector<Quad> quads;
    /// @}

    /// One surface at least. O(n).
    explicit ContactPlaces(std::span<const ContactInput> inputs);
};

/// Places and radii, in the arrays of an executor: those that other stages read too.
struct ContactGeometry {
    std::span<const DeviceSegment> segments;  ///< of the field
    float reach = 0;                          ///< of the field
    std::span<const Vec3> nodes;              ///< [m] of the field's skeleton
    std::span<const float> radii;             ///< [m] of the field's skeleton
    std::span<const Vec3> tube_nodes;         ///< [m]
    std::span<const float> tube_radii;        ///< [m]
    std::span<const Quad> quads;              ///< of the cage
    std::span<const Vec3> cage;               ///< [m] vertices
    std::span<const Vec3> anchors;            ///< [m] one for each vertex of the cage
};

/// Copies a topology: once for each surface.
template <class Exec>
ContactTables upload_contacts(Exec& exec, const ContactTopology& t) {
    const auto upload = [&]<class T>(const T& values) {
        return exec.upload(std::span<const typename T::value_type>(values));
    };
    return {upload(t.segments),       upload(t.in_order),    upload(t.tubes),       upload(t.contents.first),
            upload(t.contents.items), upload(t.quads.first), upload(t.quads.items), upload(t.first_segment)};
}

}  // namespace coppice::cuda
