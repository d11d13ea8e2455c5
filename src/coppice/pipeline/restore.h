#pragma once

#include <cstdint>

#include "coppice/base/column.h"
#include "coppice/base/context.h"
#include "coppice/base/fields.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/statistics.h"
#include "coppice/skeleton/skeleton.h"

namespace coppice {

/// Where the original surface is looked for.
struct RestoreOptions {
    float reach = 0.5f;    ///< [radii] how far from a vertex the original is looked for, both ways
    int fade_passes = 20;  ///< rings of vertices, about, over which offsets fade where there is no original
};

template <class Self, class Visitor>
requires SameOptions<Self, RestoreOptions>
constexpr void visit_fields(Self& o, Visitor&& visit) {
    visit(Field{"reach", "how far from a vertex the original surface is looked for, both ways", Unit::radius,
                0.001, 10},
          o.reach);
    visit(Field{"fade_passes", "rings over which offsets fade where there is no original, about", Unit::none,
                0, 1000},
          o.fade_passes);
}

/// What `restore_offsets` found and did, counted.
struct RestoreReport {
    std::uint64_t found = 0;        ///< vertices with the original within reach
    std::uint64_t faded = 0;        ///< vertices without, that move with their neighbours
    std::uint64_t pulled_back = 0;  ///< vertices that moved less, so that no face folds or crosses another
    std::uint32_t rounds = 0;       ///< of pulling back
    bool turned = false;            ///< faces of the original that looked inward were turned
    Statistics offset;              ///< [radii] of all vertices; outward is positive
    Statistics distance_before;     ///< [radii] from vertices to the original; empty without any found
    Statistics distance_after;      ///< [radii] of the same vertices
    friend bool operator==(const RestoreReport&, const RestoreReport&) = default;  ///< member by member
};

/// How far each vertex moved, and the report.
struct RestoreResult {
    Buffer<float> offsets;  ///< [m] per vertex, along its normal before: the mean of its faces' by area
    RestoreReport report;   ///< what was found and done
};

/// Moves the vertices of a surface along their normals onto the original that its skeleton was taken from, so
/// that what a skeleton cannot hold comes back: bark, burls, trunks that are not round [Zhu2015],
/// section 4.4.
///
/// A vertex takes the nearest place where its normal meets a face of the original that looks the same way,
/// within `reach` local radii (those of `skeleton` nearby; a tree of one node has none and stays). Where
/// there is none, as over holes, offsets are averaged over neighbours from those found, and fade. Faces that
/// would fold, and pairs that would cross and did not before, take the offsets of their vertices back by
/// halves, then wholly: the surface has no more folds and crossings than before. Only positions change.
///
/// Where more vertices find the original with its pieces turned outward, as `clean_mesh` does, than as it is,
/// it is turned. It may be open, in pieces or empty, and have an origin of its own. O(n log m) for n vertices
/// and m faces of the original; about 300 bytes per vertex meanwhile. The same bits for any number of
/// threads. Throws InvalidInput naming an option out of range, what is wrong with either mesh, or that the
/// surface crosses itself too often to tell new crossings from old ones.
RestoreResult restore_offsets(QuadMesh& mesh, const PolygonMesh& original, const Skeleton& skeleton,
                              const RestoreOptions& options = {}, const Context& ctx = {});

/// Calls visit(name, value) for every figure; statistics have figures of their own.
template <class Visitor>
void visit_figures(const RestoreReport& r, Visitor&& visit) {
    visit("found", r.found);
    visit("faded", r.faded);
    visit("pulled_back", r.pulled_back);
    visit("rounds", r.rounds);
    visit("turned", r.turned);
    visit("offset", r.offset);
    visit("distance_before", r.distance_before);
    visit("distance_after", r.distance_after);
}

}  // namespace coppice
