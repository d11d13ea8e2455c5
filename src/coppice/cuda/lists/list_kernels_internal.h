#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "coppice/base/kernel/partition_point.h"
#include "coppice/cuda/exec/atomics_internal.h"
#include "coppice/cuda/lists/box_tree_stages_internal.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/field/list_kernel.h"

namespace coppice::cuda {

/// A support in the layout of the GPU: four loads of 16 bytes.
struct alignas(16) DeviceSupport {
    SegmentSupport capsule;
};
static_assert(sizeof(DeviceSupport) == 64);

/// Computes the boxes of the regions.
struct BoundRegions {
    ContactTables tables;
    ContactGeometry geometry;
    std::span<Box3> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        Box3 box;
        for (std::uint32_t k = tables.first_quad[r]; k < tables.first_quad[r + 1]; ++k) {
            const Quad quad = geometry.quads[tables.quads[k]];
            for (const std::uint32_t v : quad) {
                box.extend(geometry.cage[v]);
                box.extend(geometry.anchors[v]);
            }
        }
        out[r] = region_box(box, geometry.radii[tables.tubes[r].source]);
    }
};

/// Computes the supports of segments.
struct SupportSegments {
    ContactGeometry geometry;
    std::span<DeviceSupport> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        out[s].capsule = segment_support(geometry.segments[s].constants, geometry.reach);
    }
};

/// Computes the supports of tubes.
struct SupportTubes {
    struct Capsules {
        std::span<const DeviceSupport> of;
        COPPICE_HOST_DEVICE const SegmentSupport& operator[](std::uint32_t s) const { return of[s].capsule; }
    };
    ContactTables tables;
    ContactGeometry geometry;
    std::span<const DeviceSupport> segments;
    std::span<DeviceSupport> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t t) const {
        const std::uint32_t first = tables.first_content[t];
        const auto inside = tables.contents.subspan(first, tables.first_content[t + 1] - first);
        Segment line{};
        if (inside.empty()) {
            const NodeId p = tables.tubes[t].parent;
            line.a = geometry.tube_nodes[p ? p.index() : t];
            line.b = geometry.tube_nodes[t];
            line.radius_b = geometry.tube_radii[t];
        }
        out[t].capsule = tube_support(inside, Capsules{segments}, line);
    }
};

/// Computes the supports within which segments compete.
struct SupportCompetitors {
    ContactTables tables;
    ContactGeometry geometry;
    std::span<DeviceSupport> out;
    std::span<Box3> boxes;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        const SegmentLink link = tables.segments[s];
        const SegmentSupport capsule = competitor_capsule(
            {geometry.nodes[link.start], geometry.nodes[s], geometry.radii[link.thick], geometry.radii[s]});
        out[s].capsule = capsule;
        boxes[s] = capsule.box;
    }
};

/// The box of a region with derived data for overlap tests.
struct RegionProbe {
    Box3 box;
    Vec3 center;  // NaN if the box is empty, so that no support overlaps it
    float half_diagonal;
    COPPICE_HOST_DEVICE explicit RegionProbe(const Box3& b)
        : box(b), center(b.center()), half_diagonal(0.5f * b.diagonal()) {}
    COPPICE_HOST_DEVICE bool touches(const DeviceSupport& s) const {
        return may_touch(s.capsule, box, center, half_diagonal);
    }
};

/// Sorts a short list in place.
COPPICE_HOST_DEVICE inline void sort_ranks(std::uint32_t* list, std::uint32_t count) {
    std::uint32_t gap = 1;
    while (3 * gap + 1 < count) gap = 3 * gap + 1;
    for (; gap > 0; gap /= 3) {
        for (std::uint32_t i = gap; i < count; ++i) {
            const std::uint32_t rank = list[i];
            std::uint32_t k = i;
            for (; k >= gap && list[k - gap] > rank; k -= gap) list[k] = list[k - gap];
            list[k] = rank;
        }
    }
}

/// Finds the same `own` lists as find_contacts() on the CPU, using the connected subtree of the region's
/// tube, which in depth-first order is a range with gaps.
struct OwnSearch {
    ContactTables tables;
    std::span<const Box3> boxes;              ///< of regions
    std::span<const DeviceSupport> segments;  ///< supports of segments
    std::span<const DeviceSupport> tubes;     ///< supports of tubes
    std::span<std::uint32_t> cut;             ///< one number: 1 if the result depends on the order of a flood

    /// Calls visit(segment), for at most kLongestList segments.
    template <class Visit>
    COPPICE_HOST_DEVICE void run(std::uint32_t region, const Visit& visit) const {
        const RegionProbe probe(boxes[region]);
        std::uint32_t reached = 0, found = 0;
        visit_connected(region, probe, [&](std::uint32_t t) {
            if (++reached > kLongestList) {
                raise_to(cut[0], 1u);
                return false;
            }
            for (std::uint32_t k = tables.first_content[t]; k < tables.first_content[t + 1]; ++k) {
                const std::uint32_t s = tables.contents[k];
                if (found < kLongestList && (t == region || probe.touches(segments[s]))) {
                    visit(s);
                    ++found;
                }
            }
            return true;
        });
    }

  private:
    COPPICE_HOST_DEVICE TubeRelation kin(std::uint32_t t) const {
        return {t, tables.tubes[t].end, tables.tubes[t].parent};
    }
    /// Calls visit(tube), ascending, for the seed and all related tubes of the region's tube that are
    /// connected with it through others that touch the box, until it returns false. All tubes between related
    /// tubes are related.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_connected(std::uint32_t region, const RegionProbe& probe,
                                             const Visit& visit) const {
        const TubeRelation own = kin(region);
        const std::uint32_t seed = tables.tubes[region].seed;
        NodeId top = tables.tubes[seed].parent;
        if (!top) {
            visit(seed);  // a tree of one node
            return;
        }
        for (NodeId up = tables.tubes[top.index()].parent; up && probe.touches(tubes[top.index()]);
             up = tables.tubes[top.index()].parent) {
            top = up;
        }
        const std::uint32_t end = tables.tubes[top.index()].end;
        for (std::uint32_t t = top.index() + 1; t < end;) {
            if (t == seed || (are_related(kin(t), own) && probe.touches(tubes[t]))) {
                if (!visit(t)) return;
                ++t;
            } else {
                t = tables.tubes[t].end;
            }
        }
    }
};

/// Computes counts[r] = length of the own list of region r, and 0 after the last.
struct CountOwn {
    OwnSearch search;
    std::span<std::uint32_t> counts;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t count = 0;
        if (r + 1 < counts.size()) search.run(r, [&](std::uint32_t) { ++count; });
        counts[r] = count;
    }
};

/// Writes the ranks of the own segments of each region, ascending, unless there is too little room.
struct FillOwn {
    OwnSearch search;
    std::span<const std::uint32_t> first;
    std::span<std::uint32_t> ranks;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        if (first[r + 1] > ranks.size()) return;
        std::uint32_t* const list = ranks.data() + first[r];
        std::uint32_t count = 0;
        search.run(r, [&](std::uint32_t s) { list[count++] = search.tables.segments[s].rank; });
        sort_ranks(list, count);
    }
};

/// Finds the same `competitors` lists as find_contacts() on the CPU.
struct CompetitorSearch {
    ContactTables tables;
    std::span<const Box3> boxes;               ///< of regions
    std::span<const DeviceSupport> capsules;   ///< supports within which segments compete
    DeviceBoxTree tree;                        ///< tree of their boxes
    std::span<const std::uint32_t> own_first;  ///< of regions
    std::span<const std::uint32_t> own;        ///< ranks
    std::span<std::uint32_t> rows;             ///< kMaxCompetitors ranks for each region, in any order
    std::span<std::uint32_t> counts;           ///< number of competing segments, and 0 after the last region
    std::span<std::uint32_t> crowded_count;    ///< one number, initially 0: number of entries of ...
    std::span<std::uint32_t> crowded;          ///< ... this list of regions that take too long for one thread

    /// Calls visit(segment, is_competitor) for segments near a region, within a range of indices, until it
    /// returns false.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_near(std::uint32_t region, const RegionProbe& probe, PlaceRange places,
                                        const Visit& visit) const {
        tree.visit_overlapping(probe.box, places, [&](std::uint32_t s) {
            const SegmentLink link = tables.segments[s];
            if (!link.competitor_of) return true;
            return visit(s, probe.touches(capsules[s]) && !is_own(region, link.rank));
        });
    }
    /// Returns the indices in the tree of the segments of the region's surface.
    COPPICE_HOST_DEVICE PlaceRange find_places(std::uint32_t r) const {
        const auto first = tables.first_segment;
        if (first.empty()) return {0, static_cast<std::uint32_t>(tree.items().size())};
        const std::uint32_t surface = find_row(first, tables.tubes[r].source);
        return {first[surface], first[surface + 1]};
    }
    COPPICE_HOST_DEVICE bool has_room(std::uint32_t region) const {
        return !boxes[region].empty() && own_first[region + 1] <= own.size();
    }
    COPPICE_HOST_DEVICE std::uint32_t* row(std::uint32_t region) const {
        return rows.data() + std::size_t{region} * kMaxCompetitors;
    }

  private:
    COPPICE_HOST_DEVICE bool is_own(std::uint32_t r, std::uint32_t rank) const {
        const auto list = own.subspan(own_first[r], own_first[r + 1] - own_first[r]);
        const std::uint32_t place =
            kernel::partition_point(list, [&](std::uint32_t other) { return other < rank; });
        return place < list.size() && list[place] == rank;
    }
};

/// Finds the ranks of the competing segments of each region that is not crowded.
struct FindCompetitors {
    static constexpr std::uint32_t kFew = 64;  ///< maximum number of segments that one thread tests

    CompetitorSearch search;

    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t count = 0;
        if (r + 1 < search.counts.size() && search.has_room(r)) count = find(r);
        search.counts[r] = count;
    }

  private:
    COPPICE_HOST_DEVICE std::uint32_t find(std::uint32_t r) const {
        const RegionProbe probe(search.boxes[r]);
        std::uint32_t* const row = search.row(r);
        std::uint32_t count = 0, looked = 0;
        search.visit_near(r, probe, search.find_places(r), [&](std::uint32_t s, bool is_competitor) {
            if (++looked > kFew || (is_competitor && count == kMaxCompetitors)) {
                search.crowded[add_to(search.crowded_count[0], 1u)] = r;
                count = 0;
                return false;
            }
            if (is_competitor) row[count++] = search.tables.segments[s].rank;
            return true;
        });
        return count;
    }
};

/// Finds the competing segments of crowded regions, each with a group of threads; their number is not known
/// when `groups` groups are launched. If there are more than kMaxCompetitors, the closest among the first
/// kMaxNear tested segments are kept, slice by slice.
struct FindCrowdedCompetitors {
    static constexpr std::uint32_t kSlices = 128;  ///< number of parallel slices of the search of a region
    static constexpr std::uint32_t kBlock = 64;    ///< number of consecutive indices of one slice

    struct Near {
        std::uint32_t segment;
        float away;
        COPPICE_HOST_DEVICE bool before(const Near& o) const {
            return away < o.away || (away == o.away && segment < o.segment);
        }
    };
    /// Memory of one group, in the executor.
    struct Room {
        std::array<std::uint32_t, kSlices> looked, found;  ///< by slice
        std::array<Near, kMaxNear> near;
    };

    CompetitorSearch search;
    std::uint32_t groups;
    std::span<Room> rooms;

    template <class Group>
    COPPICE_HOST_DEVICE void operator()(std::uint32_t g, const Group& group) const {
        for (std::uint32_t k = g; k < search.crowded_count[0]; k += groups)
            find(search.crowded[k], rooms[g], group);
    }

  private:
    template <class Group>
    COPPICE_HOST_DEVICE void find(std::uint32_t region, Room& room, const Group& group) const {
        const RegionProbe probe(search.boxes[region]);
        group.each(kSlices, [&](std::uint32_t slice) {
            std::uint32_t looked = 0;
            visit_slice(region, probe, slice, [&](std::uint32_t, bool) { return ++looked < kMaxNear; });
            room.looked[slice] = looked;
        });
        // Each slice tests the share of kMaxNear that the previous slices leave, and has room for all
        // results.
        group.each(1, [&](std::uint32_t) {
            std::uint32_t before = 0;
            for (std::uint32_t slice = 0; slice < kSlices; ++slice) {
                const auto most = static_cast<std::uint32_t>(kMaxNear);
                const std::uint32_t looked = kernel::smaller(room.looked[slice], most - before);
                room.looked[slice] = before;
                room.found[slice] = looked;
                before += looked;
            }
        });
        group.each(kSlices, [&](std::uint32_t slice) {
            const std::uint32_t begin = room.looked[slice], most = room.found[slice];
            std::uint32_t looked = 0, found = 0;
            if (most > 0) {
                visit_slice(region, probe, slice, [&](std::uint32_t s, bool is_competitor) {
                    if (is_competitor)
                        room.near[begin + found++] = {s, clearance(search.capsules[s].capsule, probe.center)};
                    return ++looked < most;
                });
            }
            room.found[slice] = found;
        });
        group.each(1, [&](std::uint32_t) {
            std::uint32_t count = 0;
            for (std::uint32_t slice = 0; slice < kSlices; ++slice) {
                const std::uint32_t begin = room.looked[slice];
                for (std::uint32_t k = 0; k < room.found[slice]; ++k)
                    room.near[count++] = room.near[begin + k];
            }
            room.found[0] = count;
        });
        const std::uint32_t count = room.found[0];
        group.each(count, [&](std::uint32_t k) {
            const Near here = room.near[k];
            std::uint32_t place = 0;
            for (std::uint32_t other = 0; other < count && place < kMaxCompetitors; ++other)
                place += room.near[other].before(here) ? 1 : 0;
            if (place < kMaxCompetitors)
                search.row(region)[place] = search.tables.segments[here.segment].rank;
        });
        group.each(1, [&](std::uint32_t) {
            search.counts[region] = kernel::smaller(count, static_cast<std::uint32_t>(kMaxCompetitors));
        });
    }
    /// Calls visit_near() for every kSlices-th block of indices.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_slice(std::uint32_t region, const RegionProbe& probe, std::uint32_t slice,
                                         const Visit& visit) const {
        const PlaceRange all = search.find_places(region);
        bool goes_on = true;
        for (std::uint32_t block = all.begin / kBlock + slice; goes_on && block * kBlock < all.end;
             block += kSlices) {
            const PlaceRange places{kernel::larger(all.begin, block * kBlock),
                                    kernel::smaller(all.end, (block + 1) * kBlock)};
            search.visit_near(region, probe, places, [&](std::uint32_t s, bool is_competitor) {
                return goes_on = visit(s, is_competitor);
            });
        }
    }
};

/// Concatenates the competing segments, and replaces ranks by segment numbers in both lists.
struct FillCompetitors {
    std::span<const std::uint32_t> in_order;  ///< segments by rank
    std::span<const std::uint32_t> rows;      ///< see CompetitorSearch
    std::span<const std::uint32_t> first;     ///< of regions
    std::span<std::uint32_t> competitors;
    std::span<const std::uint32_t> own_first;  ///< of regions
    std::span<std::uint32_t> own;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        if (own_first[r + 1] <= own.size()) name(own.data() + own_first[r], own_first[r + 1] - own_first[r]);
        const std::uint32_t count = first[r + 1] - first[r];
        if (first[r + 1] > competitors.size() || count == 0) return;
        std::uint32_t* const list = competitors.data() + first[r];
        for (std::uint32_t k = 0; k < count; ++k) list[k] = rows[std::size_t{r} * kMaxCompetitors + k];
        sort_ranks(list, count);
        name(list, count);
    }

  private:
    COPPICE_HOST_DEVICE void name(std::uint32_t* list, std::uint32_t count) const {
        for (std::uint32_t k = 0; k < count; ++k) list[k] = in_order[list[k]];
    }
};

/// Stores the sizes of all lists after counting.
struct SumUp {
    std::span<const std::uint32_t> own_first, competitor_first;
    std::span<std::uint32_t> state;  ///< entries of own and of competing lists; 1 if a list was truncated
    COPPICE_HOST_DEVICE void operator()(std::uint32_t) const {
        state[0] = own_first[own_first.size() - 1];
        state[1] = competitor_first[competitor_first.size() - 1];
    }
};

/// Empties all lists if some had too little room, so that earlier readers never access uninitialised memory.
struct EmptyUnfit {
    std::span<const std::uint32_t> state;  ///< see SumUp
    std::size_t own_room, competitor_room;
    std::span<std::uint32_t> own_first, competitor_first;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        if (state[0] <= own_room && state[1] <= competitor_room) return;
        own_first[r] = competitor_first[r] = 0;
    }
};

}  // namespace coppice::cuda
