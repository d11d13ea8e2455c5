#pragma once

#include <cstdint>
#include <span>

#include "coppice/base/kernel/host_device.h"
#include "coppice/cuda/exec/atomics.h"
#include "coppice/cuda/lists/box_tree_stages.h"
#include "coppice/cuda/lists/contact_topology.h"
#include "coppice/field/list_kernel.h"

namespace coppice::cuda {

/// A support as a card reads it: in four loads of 16 bytes.
struct alignas(16) DeviceSupport {
    SegmentSupport capsule;
};
static_assert(sizeof(DeviceSupport) == 64);

/// The boxes of the regions.
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

/// Where segments have influence.
struct SupportSegments {
    ContactGeometry geometry;
    std::span<DeviceSupport> out;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        out[s].capsule = segment_support(geometry.segments[s].constants, geometry.reach);
    }
};

/// Where tubes have influence.
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

/// Where segments are rivals.
struct SupportRivals {
    ContactTables tables;
    ContactGeometry geometry;
    std::span<DeviceSupport> out;
    std::span<Box3> boxes;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t s) const {
        const SegmentLink link = tables.segments[s];
        const SegmentSupport capsule = rival_capsule(
            {geometry.nodes[link.start], geometry.nodes[s], geometry.radii[link.thick], geometry.radii[s]});
        out[s].capsule = capsule;
        boxes[s] = capsule.box;
    }
};

/// The box of a region, with what it is tested by.
struct RegionProbe {
    Box3 box;
    Vec3 center;  // not a number where the box is empty: nothing overlaps that
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

/// Finds what the CPU's find_contacts() finds for `own`: by the subtree that the region's tube is connected
/// in, which in depth-first order is a range with gaps.
struct OwnSearch {
    ContactTables tables;
    std::span<const Box3> boxes;              ///< of regions
    std::span<const DeviceSupport> segments;  ///< where they have influence
    std::span<const DeviceSupport> tubes;     ///< where they have influence
    std::span<std::uint32_t> cut;             ///< one number: 1 where the order of a flood decides

    /// Calls visit(segment), for at most kLongestList of them.
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
    COPPICE_HOST_DEVICE TubeKin kin(std::uint32_t t) const {
        return {t, tables.tubes[t].end, tables.tubes[t].parent};
    }
    /// Calls visit(tube), ascending, for the seed and all relatives of the region's tube that are connected
    /// with it through others that touch the box, until it returns false. Between relatives there are none
    /// but relatives.
    template <class Visit>
    COPPICE_HOST_DEVICE void visit_connected(std::uint32_t region, const RegionProbe& probe,
                                             const Visit& visit) const {
        const TubeKin own = kin(region);
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

/// counts[r] = length of the own list of region r, and 0 after the last.
struct CountOwn {
    OwnSearch search;
    std::span<std::uint32_t> counts;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t count = 0;
        if (r + 1 < counts.size()) search.run(r, [&](std::uint32_t) { ++count; });
        counts[r] = count;
    }
};

/// Ranks of the own segments of each region, ascending; nothing where there is no room.
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

/// Ranks of the rivals of each region, in a row of kMostRivals places, in any order. Of more the nearest.
struct FindRivals {
    ContactTables tables;
    std::span<const Box3> boxes;               ///< of regions
    std::span<const DeviceSupport> capsules;   ///< where segments are rivals
    DeviceBoxTree tree;                        ///< of their boxes
    std::span<const std::uint32_t> own_first;  ///< of regions
    std::span<const std::uint32_t> own;        ///< ranks
    std::span<std::uint32_t> rows;             ///< kMostRivals for each region
    std::span<std::uint32_t> counts;           ///< how many there are, and 0 after the last region

    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        std::uint32_t count = 0;
        if (r + 1 < counts.size()) count = find(r);
        counts[r] = count;
    }

  private:
    struct Farthest {
        std::uint32_t place = 0, segment = 0;
        float away = 0;
        COPPICE_HOST_DEVICE bool beyond(float other_away, std::uint32_t other) const {
            return other_away < away || (other_away == away && other < segment);
        }
    };

    COPPICE_HOST_DEVICE std::uint32_t find(std::uint32_t r) const {
        if (boxes[r].empty() || own_first[r + 1] > own.size()) return 0;
        const RegionProbe probe(boxes[r]);
        std::uint32_t* const row = rows.data() + std::size_t{r} * kMostRivals;
        std::uint32_t count = 0, looked = 0;
        Farthest farthest;
        tree.visit_overlapping(probe.box, places_of(r), [&](std::uint32_t s) {
            const SegmentLink link = tables.segments[s];
            if (!link.rival_of) return true;
            if (probe.touches(capsules[s]) && !is_own(r, link.rank)) {
                add(s, probe.center, row, count, farthest);
            }
            return ++looked < kMostNear;
        });
        return count;
    }
    /// Where the tree has the segments of the region's surface.
    COPPICE_HOST_DEVICE PlaceRange places_of(std::uint32_t r) const {
        const auto first = tables.first_segment;
        if (first.empty()) return {0, static_cast<std::uint32_t>(tree.items().size())};
        const std::uint32_t surface = row_of(first, tables.tubes[r].source);
        return {first[surface], first[surface + 1]};
    }
    COPPICE_HOST_DEVICE bool is_own(std::uint32_t r, std::uint32_t rank) const {
        std::uint32_t begin = own_first[r], end = own_first[r + 1];
        while (begin < end) {
            const std::uint32_t middle = (begin + end) / 2;
            if (own[middle] == rank) return true;
            if (own[middle] < rank) {
                begin = middle + 1;
            } else {
                end = middle;
            }
        }
        return false;
    }
    COPPICE_HOST_DEVICE void add(std::uint32_t s, Vec3 center, std::uint32_t* row, std::uint32_t& count,
                                 Farthest& farthest) const {
        if (count < kMostRivals) {
            row[count++] = tables.segments[s].rank;
            if (count == kMostRivals) farthest = farthest_of(row, center);
        } else if (farthest.beyond(clearance(capsules[s].capsule, center), s)) {
            row[farthest.place] = tables.segments[s].rank;
            farthest = farthest_of(row, center);
        }
    }
    // Distances are computed again rather than kept: this is for crowds alone.
    COPPICE_HOST_DEVICE Farthest farthest_of(const std::uint32_t* row, Vec3 center) const {
        Farthest out;
        for (std::uint32_t k = 0; k < kMostRivals; ++k) {
            const std::uint32_t s = tables.in_order[row[k]];
            const Farthest here{k, s, clearance(capsules[s].capsule, center)};
            if (k == 0 || here.beyond(out.away, out.segment)) out = here;
        }
        return out;
    }
};

/// Puts the rivals found one after the other, and names the segments of both lists by what they are rather
/// than by their ranks.
struct FillRivals {
    std::span<const std::uint32_t> in_order;  ///< segments by rank
    std::span<const std::uint32_t> rows;      ///< see FindRivals
    std::span<const std::uint32_t> first;     ///< of regions
    std::span<std::uint32_t> rivals;
    std::span<const std::uint32_t> own_first;  ///< of regions
    std::span<std::uint32_t> own;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        if (own_first[r + 1] <= own.size()) name(own.data() + own_first[r], own_first[r + 1] - own_first[r]);
        const std::uint32_t count = first[r + 1] - first[r];
        if (first[r + 1] > rivals.size() || count == 0) return;
        std::uint32_t* const list = rivals.data() + first[r];
        for (std::uint32_t k = 0; k < count; ++k) list[k] = rows[std::size_t{r} * kMostRivals + k];
        sort_ranks(list, count);
        name(list, count);
    }

  private:
    COPPICE_HOST_DEVICE void name(std::uint32_t* list, std::uint32_t count) const {
        for (std::uint32_t k = 0; k < count; ++k) list[k] = in_order[list[k]];
    }
};

/// What is known once all lists are counted, in one place.
struct SumUp {
    std::span<const std::uint32_t> own_first, rival_first;
    std::span<std::uint32_t> state;  ///< entries of own and of rivals; 1 where a list was cut
    COPPICE_HOST_DEVICE void operator()(std::uint32_t) const {
        state[0] = own_first[own_first.size() - 1];
        state[1] = rival_first[rival_first.size() - 1];
    }
};

/// Empties all lists where some had too little room, so that whoever reads them before that is known reads
/// nothing that was not written.
struct EmptyUnfit {
    std::span<const std::uint32_t> state;  ///< see SumUp
    std::size_t own_room, rival_room;
    std::span<std::uint32_t> own_first, rival_first;
    COPPICE_HOST_DEVICE void operator()(std::uint32_t r) const {
        if (state[0] <= own_room && state[1] <= rival_room) return;
        own_first[r] = rival_first[r] = 0;
    }
};

}  // namespace coppice::cuda
