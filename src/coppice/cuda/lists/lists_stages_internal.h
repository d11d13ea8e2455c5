#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/field/upload_field_internal.h"
#include "coppice/cuda/lists/box_tree_stages_internal.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/lists/list_kernels_internal.h"
#include "coppice/field/list_kernel.h"

namespace coppice::cuda {

/// Capacity for entries of lists.
struct ListRoom {
    std::uint32_t own = 0;          ///< of all own lists
    std::uint32_t competitors = 0;  ///< of all lists of competing segments
};

/// The lists of a field's regions, in arrays of the executor: equal to those of find_contacts() on the CPU,
/// in the order in which the field uses them.
struct DeviceLists {
    RegionLists own;                       ///< segments with which a region's tube is connected
    RegionLists competitors;               ///< segments with which it is in contact
    std::span<const std::uint32_t> state;  ///< see read_state()
};

/// Status of lists.
struct ListState {
    ListRoom
        entries;  ///< required capacity; that of competing segments is meaningless if own had too little room
    /// A list was longer than kLongestList: the segments that the CPU omits depend on the order of a flood
    /// that is not computed here, so the CPU has to make the lists.
    bool is_cut = false;

    /// Returns whether the lists are complete, given this capacity.
    bool fits(ListRoom room) const {
        return entries.own <= room.own && entries.competitors <= room.competitors;
    }
};

/// Returns a larger capacity after lists did not fit: enough for those that could be counted.
inline ListRoom grown(const ListRoom& room, const ListState& state) {
    const bool own_fits = state.entries.own <= room.own;
    return {std::max(room.own, state.entries.own),
            own_fits ? std::max(room.competitors, state.entries.competitors) : room.competitors};
}

/// Returns a capacity that is sufficient for most surfaces.
inline ListRoom usual_room(std::size_t regions) {
    return {static_cast<std::uint32_t>(1024 + 16 * regions), static_cast<std::uint32_t>(1024 + 8 * regions)};
}

/// Sorts the segments along a curve: required before the first search, and again when they have moved far.
template <class Exec>
std::span<const std::uint32_t> competitor_order(Exec& exec, const ContactTables& tables,
                                                const ContactGeometry& geometry) {
    const auto order = exec.template array<std::uint32_t>(tables.segments.size());
    const auto before = exec.mark();
    const auto capsules = exec.template array<DeviceSupport>(tables.segments.size());
    const auto boxes = exec.template array<Box3>(tables.segments.size());
    exec.each("support competitors", capsules.size(), SupportCompetitors{tables, geometry, capsules, boxes});
    order_boxes(exec, std::span<const Box3>(boxes), order);
    if (!tables.first_segment.empty()) sort_by_surface(exec, tables.first_segment, order);
    exec.rewind(before);
    return order;
}

/// Computes the boxes of the regions: see FieldRegion.
template <class Exec>
std::span<const Box3> region_boxes(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry) {
    const auto boxes = exec.template array<Box3>(tables.tubes.size());
    exec.each("bound regions", boxes.size(), BoundRegions{tables, geometry, boxes});
    return boxes;
}

/// Output arrays of lists.
struct ListArrays {
    std::span<std::uint32_t> state;                          ///< see read_state()
    std::span<std::uint32_t> own_first, own;                 ///< see RegionLists
    std::span<std::uint32_t> competitor_first, competitors;  ///< see RegionLists
    DeviceLists lists() const {
        return {{own_first, own}, {competitor_first, competitors}, state};
    }  ///< read-only view
};

/// Allocates memory for the lists of `regions` regions.
template <class Exec>
ListArrays list_arrays(Exec& exec, std::size_t regions, ListRoom room) {
    const auto numbers = [&](std::size_t count) { return exec.template array<std::uint32_t>(count); };
    return {numbers(3), numbers(regions + 1), numbers(room.own), numbers(regions + 1),
            numbers(room.competitors)};
}

/// Fills the own lists: see begin_contacts().
template <class Exec>
void fill_own(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
              std::span<const Box3> boxes, const ListArrays& out) {
    const std::size_t regions = tables.tubes.size(), segments = tables.segments.size();
    const auto before = exec.mark();
    const auto supports = exec.template array<DeviceSupport>(segments);
    exec.each("support segments", segments, SupportSegments{geometry, supports});
    const auto of_tubes = exec.template array<DeviceSupport>(regions);
    exec.each("support tubes", regions, SupportTubes{tables, geometry, supports, of_tubes});
    const OwnSearch search{tables, boxes, supports, of_tubes, out.state.subspan(2)};
    exec.each("count own", regions + 1, CountOwn{search, out.own_first});
    exec.exclusive_scan(std::span<const std::uint32_t>(out.own_first), out.own_first);
    exec.each("fill own", regions, FillOwn{search, out.own_first, out.own});
    exec.rewind(before);
}

/// Fills the lists of competing segments, after the own ones, and converts both to segment numbers.
template <class Exec>
void fill_competitors(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                      std::span<const Box3> boxes, std::span<const std::uint32_t> order,
                      const ListArrays& out) {
    const std::size_t regions = tables.tubes.size(), segments = tables.segments.size();
    const auto before = exec.mark();
    const auto capsules = exec.template array<DeviceSupport>(segments);
    const auto capsule_boxes = exec.template array<Box3>(segments);
    exec.each("support competitors", segments, SupportCompetitors{tables, geometry, capsules, capsule_boxes});
    const DeviceBoxTree tree = box_tree(exec, std::span<const Box3>(capsule_boxes), order);
    const auto rows = exec.template array<std::uint32_t>(regions * kMaxCompetitors);
    const auto crowded = exec.template array<std::uint32_t>(1 + regions);
    exec.clear(crowded.first(1));
    const CompetitorSearch search{tables,
                                  boxes,
                                  capsules,
                                  tree,
                                  out.own_first,
                                  out.own,
                                  rows,
                                  out.competitor_first,
                                  crowded.first(1),
                                  crowded.subspan(1)};
    exec.each("find competitors", regions + 1, FindCompetitors{search});
    constexpr std::size_t kMaxGroups = 1024, kShare = 16;
    const std::size_t groups = std::min(kMaxGroups, regions / kShare + 1);
    exec.groups("find crowded competitors", groups,
                FindCrowdedCompetitors{search, static_cast<std::uint32_t>(groups),
                                       exec.template array<FindCrowdedCompetitors::Room>(groups)});
    exec.exclusive_scan(std::span<const std::uint32_t>(out.competitor_first), out.competitor_first);
    exec.each("fill competitors", regions,
              FillCompetitors{tables.in_order, rows, out.competitor_first, out.competitors, out.own_first,
                              out.own});
    exec.rewind(before);
}

/// Starts the computation of the lists; does not wait. `order` is the result of competitor_order(), for these
/// positions or others: it only affects time, unless more than kMaxNear segments intersect one region. The
/// CPU applies that limit to a run of regions, and may therefore miss some segments that are found here.
///
/// Lists equal those of the CPU for the same arithmetic. A GPU fuses products and sums, so that a segment
/// that barely reaches the box of a region may be in only one of them.
///
/// If there is too little room, all lists are empty. O((regions + lists) log n), except for nodes with very
/// many children, all of which are tested.
template <class Exec>
void begin_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                    std::span<const std::uint32_t> order, const ListArrays& out) {
    const auto before = exec.mark();
    exec.clear(out.state);
    const std::span<const Box3> boxes = region_boxes(exec, tables, geometry);
    fill_own(exec, tables, geometry, boxes, out);
    fill_competitors(exec, tables, geometry, boxes, order, out);
    exec.each("sum up lists", 1, SumUp{out.own_first, out.competitor_first, out.state});
    exec.each(
        "empty lists", out.own_first.size(),
        EmptyUnfit{out.state, out.own.size(), out.competitors.size(), out.own_first, out.competitor_first});
    exec.rewind(before);
}

/// Computes the lists in new arrays.
template <class Exec>
DeviceLists begin_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                           std::span<const std::uint32_t> order, ListRoom room) {
    const ListArrays out = list_arrays(exec, tables.tubes.size(), room);
    begin_contacts(exec, tables, geometry, order, out);
    return out.lists();
}

/// Waits for lists and returns their status.
template <class Exec>
ListState read_state(Exec& exec, const DeviceLists& lists) {
    std::array<std::uint32_t, 3> state{};
    exec.download(lists.state, std::span<std::uint32_t>(state));
    return {{state[0], state[1]}, state[2] != 0};
}

/// Completed lists.
struct ContactsFound {
    DeviceLists lists;
    ListState state;    ///< usable unless truncated
    ListArrays arrays;  ///< arrays that contain the lists
};

/// Computes the lists with as much room as required, starting with `room`. Waits.
template <class Exec>
ContactsFound find_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                            std::span<const std::uint32_t> order, ListRoom room) {
    const auto before = exec.mark();
    for (;;) {
        const ListArrays arrays = list_arrays(exec, tables.tubes.size(), room);
        begin_contacts(exec, tables, geometry, order, arrays);
        const ListState state = read_state(exec, arrays.lists());
        if (state.is_cut || state.fits(room)) return {arrays.lists(), state, arrays};
        room = grown(room, state);
        exec.rewind(before);
    }
}

/// Copies the positions and radii of several surfaces as one: see contact_topology().
template <class Exec>
ContactGeometry upload_geometry(Exec& exec, std::span<const ContactInput> inputs) {
    const ContactPlaces places(inputs);
    const auto upload = [&]<class T>(const std::vector<T>& values) {
        return exec.upload(std::span<const T>(values));
    };
    return {upload(places.segments),   places.reach,
            upload(places.nodes),      upload(places.radii),
            upload(places.tube_nodes), upload(places.tube_radii),
            upload(places.quads),      upload(places.cage),
            upload(places.anchors)};
}

/// Copies those of one surface.
template <class Exec>
ContactGeometry upload_geometry(Exec& exec, const ContactInput& input) {
    return upload_geometry(exec, std::span(&input, 1));
}

/// Uploads all input of the lists, and finds them. Waits.
template <class Exec>
ContactsFound find_contacts(Exec& exec, const ContactInput& input) {
    const ContactTables tables = upload_contacts(exec, contact_topology(input));
    const ContactGeometry geometry = upload_geometry(exec, input);
    return find_contacts(exec, tables, geometry, competitor_order(exec, tables, geometry),
                         usual_room(tables.tubes.size()));
}

}  // namespace coppice::cuda
