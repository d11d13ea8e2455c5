#include "coppice/tetra/lattice/lattice.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/id.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/tetra/lattice/select_internal.h"

namespace coppice {
namespace {

constexpr std::size_t kLatticeGrain = 1 << 12;

Buffer<RoundCone> compute_cones(std::span<const Segment> segments, Vec3d corner, const Context& ctx) {
    Buffer<RoundCone> cones(segments.size());
    parallel_for(ctx, segments.size(), kLatticeGrain,
                 [&](std::size_t i) { cones[i] = growing_cone(segments[i], corner); });
    return cones;
}

/// Returns the slot of the set bit number `rank`.
unsigned find_slot(std::uint64_t mask, std::uint32_t rank) {
    for (; rank > 0; --rank) mask &= mask - 1;
    return static_cast<unsigned>(std::countr_zero(mask));
}

}  // namespace

struct Lattice::State {
    LatticeCube cube;
    Buffer<RoundCone> cones;
    LatticeCells cells;
    LeafSegments segments;
    SlotMasks masks;
    LatticeMesh out;
    CompressedRows<std::uint32_t> passing;

    void gather(const Context& ctx) {
        out = gather_tetra(cells, masks, cube, ctx);
        passing = passing_axes(cells, segments, cones, cube, out.region_leaf, ctx);
    }

    LatticeCells::Name name(std::uint32_t tetra) const {
        const auto& first = out.mesh.first;
        const auto region =
            static_cast<std::size_t>(std::ranges::upper_bound(first, tetra) - first.begin()) - 1;
        const std::uint32_t leaf = out.region_leaf[region];
        return {leaf, find_slot(masks[leaf], tetra - first[region])};
    }
};

Lattice::Lattice(std::span<const Segment> segments, const LatticeOptions& options, const Context& ctx) {
    check_fields(options, "lattice");
    const LatticeCube cube = lattice_cube(segments, options);
    Buffer<RoundCone> cones = compute_cones(segments, cube.low, ctx);
    LatticeSizing sizing = size_cells(cones, cube, options, ctx);
    LatticeCells cells(Octree(std::move(sizing.split), ctx), ctx);
    LeafSegments of_leaf(cells.octree(), std::move(sizing));
    SlotMasks masks = select_tetra(cells, of_leaf, cones, cube, options, ctx);
    state_ = std::make_unique<State>(
        State{cube, std::move(cones), std::move(cells), std::move(of_leaf), std::move(masks), {}, {}});
    state_->gather(ctx);
}

Lattice::~Lattice() = default;
Lattice::Lattice(Lattice&&) noexcept = default;
Lattice& Lattice::operator=(Lattice&&) noexcept = default;

const TetraMesh& Lattice::mesh() const { return state_->out.mesh; }

const CompressedRows<std::uint32_t>& Lattice::passing() const { return state_->passing; }

bool Lattice::grow(std::span<const TetraFace> faces, const Context& ctx) {
    State& s = *state_;
    std::vector<LatticeCells::Name> found;
    for (const TetraFace& f : faces) {
        COPPICE_ASSERT(f.tetra < s.out.mesh.tetra.size() && f.opposite < 4);
        const LatticeCells::Name name = s.cells.across(s.name(f.tetra), f.opposite);
        if (name.leaf != kNoIndex) found.push_back(name);
    }
    bool grown = false;
    for (const LatticeCells::Name& name : found) {
        const std::uint64_t bit = std::uint64_t{1} << name.slot;
        grown |= (s.masks[name.leaf] & bit) == 0;
        s.masks[name.leaf] |= bit;
    }
    if (grown) s.gather(ctx);
    return grown;
}

void list_fields(LatticeOptions& o, FieldList& list) {
    list.add(Field{"cell", "Maximum size of a cell that the surface may cross.", Unit::radius, 0.1, 200},
             o.cell);
    list.add(Field{"inside", "Distance from an axis within which all points count as inside.", Unit::radius,
                   0, 0.99},
             o.inside);
    list.add(Field{"outside", "Distance from every axis beyond which all points count as outside.",
                   Unit::radius, 1.01, 4},
             o.outside);
}

}  // namespace coppice
