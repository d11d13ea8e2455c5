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
    const auto order = exec.template array<std::uint32_t>(tables.segments.size());
    const auto before = exec.mark();
    const auto capsules = exec.template array<DeviceSupport>(tables.segments.size());
    const auto boxes = exec.template array<Box3>(tables.segments.size());
    exec.each("support rivals", capsules.size(), SupportRivals{tables, geometry, capsules, boxes});
    order_boxes(exec, std::span<const Box3>(boxes), order);
    if (!tables.first_segment.empty()) sort_by_surface(exec, tables.first_segment, order);
    exec.rewind(before);
    return order;
}

/// The boxes of the regions: see FieldRegion.
template <class Exec>
std::span<const Box3> region_boxes(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry) {
    const auto boxes = exec.template array<Box3>(tables.tubes.size());
    exec.each("bound regions", boxes.size(), BoundRegions{tables, geometry, boxes});
    return boxes;
}

/// Where lists are written to.
struct ListArrays {
    std::span<std::uint32_t> state;                ///< see state_of()
    std::span<std::uint32_t> own_first, own;       ///< see RegionLists
    std::span<std::uint32_t> rival_first, rivals;  ///< see RegionLists
    DeviceLists lists() const { return {{own_first, own}, {rival_first, rivals}, state}; }  ///< to be read
};

/// Memory for the lists of so many regions.
template <class Exec>
ListArrays list_arrays(Exec& exec, std::size_t regions, ListRoom room) {
    const auto numbers = [&](std::size_t count) { return exec.template array<std::uint32_t>(count); };
    return {numbers(3), numbers(regions + 1), numbers(room.own), numbers(regions + 1), numbers(room.rivals)};
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

/// Fills the lists of rivals, after the own ones, and gives both their final names.
template <class Exec>
void fill_rivals(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                 std::span<const Box3> boxes, std::span<const std::uint32_t> order, const ListArrays& out) {
    const std::size_t regions = tables.tubes.size(), segments = tables.segments.size();
    const auto before = exec.mark();
    const auto capsules = exec.template array<DeviceSupport>(segments);
    const auto capsule_boxes = exec.template array<Box3>(segments);
    exec.each("support rivals", segments, SupportRivals{tables, geometry, capsules, capsule_boxes});
    const DeviceBoxTree tree = box_tree(exec, std::span<const Box3>(capsule_boxes), order);
    const auto rows = exec.template array<std::uint32_t>(regions * kMostRivals);
    const auto crowded = exec.template array<std::uint32_t>(1 + regions);
    exec.clear(crowded.first(1));
    const RivalSearch search{tables,
                             boxes,
                             capsules,
                             tree,
                             out.own_first,
                             out.own,
                             rows,
                             out.rival_first,
                             crowded.first(1),
                             crowded.subspan(1)};
    exec.each("find rivals", regions + 1, FindRivals{search});
    constexpr std::size_t kMaxGroups = 1024, kShare = 16;
    const std::size_t groups = std::min(kMaxGroups, regions / kShare + 1);
    exec.groups("find crowded rivals", groups,
                FindCrowdedRivals{search, static_cast<std::uint32_t>(groups),
                                  exec.template array<FindCrowdedRivals::Room>(groups)});
    exec.exclusive_scan(std::span<const std::uint32_t>(out.rival_first), out.rival_first);
    exec.each("fill rivals", regions,
              FillRivals{tables.in_order, rows, out.rival_first, out.rivals, out.own_first, out.own});
    exec.rewind(before);
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
void begin_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                    std::span<const std::uint32_t> order, const ListArrays& out) {
    const auto before = exec.mark();
    exec.clear(out.state);
    const std::span<const Box3> boxes = region_boxes(exec, tables, geometry);
    fill_own(exec, tables, geometry, boxes, out);
    fill_rivals(exec, tables, geometry, boxes, order, out);
    exec.each("sum up lists", 1, SumUp{out.own_first, out.rival_first, out.state});
    exec.each("empty lists", out.own_first.size(),
              EmptyUnfit{out.state, out.own.size(), out.rivals.size(), out.own_first, out.rival_first});
    exec.rewind(before);
}

/// The same in arrays of their own.
template <class Exec>
DeviceLists begin_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                           std::span<const std::uint32_t> order, ListRoom room) {
    const ListArrays out = list_arrays(exec, tables.tubes.size(), room);
    begin_contacts(exec, tables, geometry, order, out);
    return out.lists();
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
    ListState state;    ///< the lists are of use unless it is cut
    ListArrays arrays;  ///< that they lie in
};

/// The same in as much room as it takes; `room` is tried first. Waits.
template <class Exec>
ContactsFound find_contacts(Exec& exec, const ContactTables& tables, const ContactGeometry& geometry,
                            std::span<const std::uint32_t> order, ListRoom room) {
    const auto before = exec.mark();
    for (;;) {
        const ListArrays arrays = list_arrays(exec, tables.tubes.size(), room);
        begin_contacts(exec, tables, geometry, order, arrays);
        const ListState state = state_of(exec, arrays.lists());
        if (state.is_cut || state.fits(room)) return {arrays.lists(), state, arrays};
        room = grown(room, state);
        exec.rewind(before);
    }
}

/// Copies the places and radii of several surfaces as one: see contact_topology().
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

/// The same of one surface.
template <class Exec>
ContactGeometry upload_geometry(Exec& exec, const ContactInput& input) {
    return upload_geometry(exec, std::span(&input, 1));
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
