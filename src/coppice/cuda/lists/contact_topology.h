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

/// Properties of a segment for a search, identified by its child node.
struct alignas(16) SegmentLink {
    std::uint32_t start;   ///< start node; a root is its own
    std::uint32_t thick;   ///< node that determines the start radius
    NodeId competitor_of;  ///< tube that wraps it; invalid if it competes with no region
    std::uint32_t rank;    ///< index in a list of all segments
};

/// Properties of a tube, and of the region around it, for a search.
struct alignas(16) TubeLink {
    NodeId parent;         ///< invalid for the first tube of a tree
    std::uint32_t end;     ///< one past the last tube of its subtree
    std::uint32_t seed;    ///< tube at which the flood of the region starts
    std::uint32_t source;  ///< node of the skeleton that identifies the region
};

/// Connectivity of the segments, tubes and quads of a surface: all input of its lists except positions and
/// radii.
struct ContactTopology {
    std::vector<SegmentLink> segments;       ///< by child node
    Buffer<std::uint32_t> in_order;          ///< segments by rank: sorted by axis, or ascending without blend
    std::vector<TubeLink> tubes;             ///< by tube, which equals the region
    CompressedRows<std::uint32_t> contents;  ///< the segments that each tube wraps
    CompressedRows<std::uint32_t> quads;     ///< the cage quads of each region
    /// For several surfaces: the first segment of each, plus the end. Empty for one surface.
    std::vector<std::uint32_t> first_segment;
};

/// Input of a surface: `tubes` wrap the segments of `skeleton`, from which `field` was made, and own the
/// quads of `control`.
struct ContactInput {
    const Skeleton& skeleton;       ///< skeleton of the field
    TubeTree tubes;                 ///< one for each region; depth-first order
    const ConvolutionField& field;  ///< its contact must be above 0; needs no regions
    const ControlMesh& control;     ///< the cage around the tubes
};

/// Remains valid while nodes move, as long as radii do not change the thickest child. O(n).
ContactTopology contact_topology(const ContactInput& input);

/// Creates the topology of several surfaces as one: segments, tubes and quads of each follow those of the
/// previous one. Segments of different surfaces never compete.
ContactTopology contact_topology(std::span<const ContactInput> inputs);

/// A ContactTopology in the arrays of an executor, with the same names.
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

/// Positions and radii of several surfaces as one: see contact_topology(). Their fields must have the same
/// options.
struct ContactPlaces {
    /// See ContactGeometry.
    /// @{
    std::vector<DeviceSegment> segments;
    float reach = 0;
    std::vector<Vec3> nodes, tube_nodes, cage, anchors;
    std::vector<float> radii, tube_radii;
    std::vector<Quad> quads;
    /// @}

    /// Requires at least one surface. O(n).
    explicit ContactPlaces(std::span<const ContactInput> inputs);
};

/// Positions and radii in the arrays of an executor, which other stages also read.
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

/// Copies a topology; required once for each surface.
template <class Exec>
ContactTables upload_contacts(Exec& exec, const ContactTopology& t) {
    const auto upload = [&]<class T>(const T& values) {
        return exec.upload(std::span<const typename T::value_type>(values));
    };
    return {upload(t.segments),       upload(t.in_order),    upload(t.tubes),       upload(t.contents.first),
            upload(t.contents.items), upload(t.quads.first), upload(t.quads.items), upload(t.first_segment)};
}

}  // namespace coppice::cuda
