#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/box.h"
#include "coppice/base/context.h"
#include "coppice/cuda/batch/tetra_piece.h"
#include "coppice/cuda/tetra/extract_stages.h"
#include "coppice/cuda/tetra/march_input.h"
#include "coppice/cuda/tetra/march_stages.h"

// march() in tetrahedra that are too many for a card: a piece after the other, whose surfaces are joined.

namespace coppice::cuda {

/// What a piece adds to a surface, on the host. Tetrahedra are numbered as in the piece.
struct PieceMarch {
    MarchResult made;                    ///< in its own tetrahedra
    std::vector<SurfacePlace> vertices;  ///< where those of the mesh lie
    std::uint32_t moved = 0;             ///< so many of them lie in fine vertices, and the others in edges
    std::vector<Vec3> places;            ///< see DeviceMarch
    int rounds = 0;                      ///< see DeviceMarch
};

/// Cuts tetrahedra into pieces, and joins what was made in each of them to what march() makes in all.
class MarchPieces {
  public:
    /// About so many pieces, of a region at least; the mesh has to outlive this. Throws what TetraRefinement
    /// throws.
    MarchPieces(const TetraMesh& mesh, int levels, std::uint64_t count, const Context& ctx = {});

    /// A piece that has to be marched now, until the next call; null when all are done. Some come twice,
    /// where vertices were put back in more rounds than was thought.
    const TetraPiece* next();
    /// Takes the last piece for too large; false where smaller ones would be little but what lies around
    /// them.
    bool split();
    /// Takes what the last piece adds.
    void put(PieceMarch march);
    /// All of it. Parts without an axis are dropped if there are axes. O(n log n).
    MarchResult join(bool about_axes, const Context& ctx = {});

  private:
    struct Piece {
        IndexRange regions;
        int rings = -1;                        // it was marched with; none at first
        bool is_closed = false;                // see TetraPiece
        std::vector<std::uint64_t> keys = {};  // of its vertices: see key_of()
        PieceMarch march = {};
    };

    int rings() const { return TetraPiece::rings_for(rounds_, whole_.levels()); }
    bool is_done(const Piece& piece) const;
    std::size_t middle_of(IndexRange regions) const;
    std::uint64_t key_of(const SurfacePlace& place, bool is_cut) const;
    TriMesh join_meshes(const Context& ctx);

    TetraRefinement whole_;
    std::vector<Piece> pieces_;  // by region
    int rounds_;                 // the most of all pieces, or what is usual
    std::size_t at_ = 0;         // the last piece
    std::optional<TetraPiece> piece_;
};

/// What marching a piece made, copied to the host. Waits.
template <class Exec>
PieceMarch downloaded_piece(Exec& exec, const DeviceRefinement& refinement, const DeviceMarch& made) {
    return {downloaded(exec, made), name_vertices(exec, refinement, made.vertices), made.vertices.moved.count,
            made.places, made.rounds};
}

/// Marches in one piece; `boxes` are those of the whole's regions. Takes all of the executor. Waits.
template <class Exec>
PieceMarch march_piece(Exec& exec, const TetraPiece& piece, const MarchInput& in, std::span<const Box3> boxes,
                       const Context& ctx) {
    const CompressedRows<std::uint32_t> passing = piece.rows(in.axes.passing);
    const EndCuts ends{in.field.ends.cuts, piece.rows(in.field.ends.of_region)};
    std::vector<Box3> own_boxes;
    for (const std::uint32_t r : piece.regions()) own_boxes.push_back(boxes[r]);
    exec.reset();
    MarchJob job = upload_march(
        exec, {piece.mesh(), {in.field.field, ends}, {in.axes.segments, passing}, in.options}, ctx);
    job.boxes = exec.upload(std::span<const Box3>(own_boxes));
    job.longest = longest_list(in.mesh.region_count());
    job.coarse.own_begin = static_cast<std::uint32_t>(piece.own().begin);
    job.coarse.own_end = static_cast<std::uint32_t>(piece.own().end);
    PieceMarch out;
    const bool done = with_march_field(exec, job, [&](const DeviceRefinement& refinement, const auto& at) {
        out = downloaded_piece(exec, refinement,
                               march_own(exec, refinement, job.axes, at, in.options.refinements));
    });
    if (!done) refuse_mesh(piece.mesh(), in.options.levels, ctx);
    return out;
}

/// march() in pieces as large as the executor has room for: the same bits as in one. Throws DeviceFull where
/// that would be slower than the CPU. Takes all of the executor. Waits.
template <class Exec>
MarchResult march_in_pieces(Exec& exec, const MarchInput& in, const Context& ctx = {}) {
    check(in.options);
    exec.reset();
    const std::uint64_t bytes = bytes_of_march(in.mesh.tetra.size(), in.options.levels);
    const std::uint64_t count = 2 + 2 * bytes / std::max<std::uint64_t>(1, exec.room());
    MarchPieces pieces(in.mesh, in.options.levels, count, ctx);
    const std::vector<Box3> boxes = region_boxes(in.mesh, ctx);
    while (const TetraPiece* piece = pieces.next()) {
        ctx.throw_if_cancelled();
        try {
            pieces.put(march_piece(exec, *piece, in, boxes, ctx));
        } catch (const DeviceFull&) {
            if (!pieces.split()) throw;
        }
    }
    return pieces.join(!in.axes.segments.empty(), ctx);
}

}  // namespace coppice::cuda
