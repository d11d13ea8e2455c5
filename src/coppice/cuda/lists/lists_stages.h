#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "coppice/cuda/field/field_view.h"
#include "coppice/cuda/field/upload_field.h"
#include "coppice/cuda/lists/box_tree_stages.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/cuda/lists/list_kernels.h"
#include "coppice/field/list_kernel.h"

namespace coppice::cuda {

/// For how many entries there is room.
struct ListRoom {
    std::uint32_t own = 0;     ///< of all own lists
    std::uint32_t rivals = 0;  ///< of all lists of rivals
};

/// The lists of a field's regions, in arrays of the executor: those of find_contacts() on the CPU, in the
/// order in which the field takes them.
struct DeviceLists {
    RegionLists own;                       ///< segments that a region's tube grows together with
    RegionLists rivals;                    ///< segments that it is in contact with
    std::span<const std::uint32_t> state;  ///< see state_of()
};

/// What became of lists.
struct ListState {
    ListRoom entries;  ///< that there are; that of rivals is meaningless where own had too little room
    /// A list was longer than kLongestList: which segments the CPU would leave out depends on the order of a
    /// flood that is not made here. Then the CPU has to make the lists.
    bool is_cut = false;

    /// Whether the lists are as promised, if they were given this room.
    bool fits(ListRoom room) const { return entries.own <= room.own && entries.rivals <= room.rivals; }
};

/// More room, after lists did not fit: enough for those that could be counted.
inline ListRoom grown(const ListRoom& room, const ListState& state) {
    const bool own_fits = state.entries.own <= room.own;
    return {std::max(room.own, state.entries.own),
            own_fits ? std::max(room.rivals, state.entries.rivals) : room.rivals};
}

/// Room that is enough for most surfaces.
inline ListRoom usual_room(std::size_t regions) {
    return {static_cast<std::uint32_t>(1024 + 16 * regions), static_cast<std::uint32_t>(1024 + 8 * regions)};
}

/// Puts the segments in order along a curve: before their first search, and again when they have moved far.
template <class Exec>
std::span<const std::uint32_t> rival_order(Exec& exec, const ContactTables& tables,
                                           const ContactGeometry& geometry) {
    const auto capsules = exec.template array<DeviceSupport>(tables.segments.size());
    const auto boxes = exec.template array<Box3>(tables.segments.size());
    exec.each("support rivals", capsules.size(), SupportRivals{tables, geometry, capsules, boxes});
    return box_order(exec, std::span<const Box3>(boxes));
}

/// The boxes of the regions: see FieldRegion.
template <class Exec>
std::span<const Box3> region_boxes(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry) {
    const auto boxes = exec.template array<Box3>(tables.tubes.size());
    exec.each("bound regions", boxes.size(), BoundRegions{tables, geometry, boxes});
    return boxes;
}

/// Begins to make the lists; does not wait. `order` is of rival_order(), of these places or others: it
/// changes time alone, but where more than kMostNear segments meet one region. The CPU looks at as many for a
/// run of regions, and so may miss some that are found here.
///
/// Lists are the same as the CPU's for the same arithmetic. A card fuses products and sums, so that a segment
/// that only just reaches the box of a region may be in one and not in the other.
///
/// Where there is too little room, all lists are empty. O((regions + lists) log n), but for nodes with very
/// many children, all of which are looked at.
template <class Exec>
DeviceLists begin_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                           std::span<const std::uint32_t> order, ListRoom room) {
    const std::size_t regions = tables.tubes.size(), segments = tables.segments.size();
    const std::span<const Box3> boxes = region_boxes(exec, tables, geometry);
    const auto state = exec.template array<std::uint32_t>(3);
    exec.clear(state);

    const auto supports = exec.template array<DeviceSupport>(segments);
    exec.each("support segments", segments, SupportSegments{geometry, supports});
    const auto of_tubes = exec.template array<DeviceSupport>(regions);
    exec.each("support tubes", regions, SupportTubes{tables, geometry, supports, of_tubes});
    const OwnSearch search{tables, boxes, supports, of_tubes, state.subspan(2)};
    const auto own_first = exec.template array<std::uint32_t>(regions + 1);
    exec.each("count own", regions + 1, CountOwn{search, own_first});
    exec.exclusive_scan(std::span<const std::uint32_t>(own_first), own_first);
    const auto own = exec.template array<std::uint32_t>(room.own);
    exec.each("fill own", regions, FillOwn{search, own_first, own});

    const auto capsules = exec.template array<DeviceSupport>(segments);
    const auto capsule_boxes = exec.template array<Box3>(segments);
    exec.each("support rivals", segments, SupportRivals{tables, geometry, capsules, capsule_boxes});
    const DeviceBoxTree tree = box_tree(exec, std::span<const Box3>(capsule_boxes), order);
    const auto rows = exec.template array<std::uint32_t>(regions * kMostRivals);
    const auto first = exec.template array<std::uint32_t>(regions + 1);
    exec.each("find rivals", regions + 1,
              FindRivals{tables, boxes, capsules, tree, own_first, own, rows, first});
    exec.exclusive_scan(std::span<const std::uint32_t>(first), first);
    const auto rivals = exec.template array<std::uint32_t>(room.rivals);
    exec.each("fill rivals", regions, FillRivals{tables.in_order, rows, first, rivals, own_first, own});
    exec.each("sum up lists", 1, SumUp{own_first, first, state});
    exec.each("empty lists", regions + 1, EmptyUnfit{state, own.size(), rivals.size(), own_first, first});
    return {{own_first, own}, {first, rivals}, state};
}

/// Waits for lists.
template <class Exec>
ListState state_of(Exec& exec, const DeviceLists& lists) {
    std::array<std::uint32_t, 3> state{};
    exec.download(lists.state, std::span<std::uint32_t>(state));
    return {{state[0], state[1]}, state[2] != 0};
}

/// Lists that were waited for.
struct ContactsFound {
    DeviceLists lists;
    ListState state;  ///< the lists are of use unless it is cut
};

/// The same in as much room as it takes; `room` is tried first. Waits.
template <class Exec>
ContactsFound find_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                            std::span<const std::uint32_t> order, ListRoom room) {
    for (;;) {
        const DeviceLists lists = begin_contacts(exec, tables, geometry, order, room);
        const ListState state = state_of(exec, lists);
        if (state.is_cut || state.fits(room)) return {lists, state};
        room = grown(room, state);
    }
}

/// Copies the places and radii of a surface.
template <class Exec>
ContactGeometry upload_geometry(Exec& exec, const ContactInput& input) {
    const auto upload = [&]<class T>(const T& values) {
        return exec.upload(std::span<const typename T::value_type>(values));
    };
    return {upload(device_segments(input.field)), input.field.reach(),
            upload(input.skeleton.positions()),   upload(input.skeleton.radii()),
            upload(input.tubes.tree.positions()), upload(input.tubes.tree.radii()),
            upload(input.control.cage.quads),     upload(input.control.cage.positions),
            upload(input.control.anchors)};
}

/// Uploads all that the lists are made of, and finds them. Waits.
template <class Exec>
ContactsFound find_contacts(Exec& exec, const ContactInput& input) {
    const ContactTables tables = upload_contacts(exec, contact_topology(input));
    const ContactGeometry geometry = upload_geometry(exec, input);
    return find_contacts(exec, tables, geometry, rival_order(exec, tables, geometry),
                         usual_room(tables.tubes.size()));
}

}  // namespace coppice::cuda
