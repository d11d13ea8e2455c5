#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "coppice/base/error.h"
#include "coppice/cuda/device.h"
#include "coppice/cuda/quads/quad_job.h"
#include "coppice/cuda/quads/upload_cage_internal.h"
#include "printed_quad_kernels.h"

namespace coppice::bench {

/// The stages from a closed cage to quads as published in [Zhu2015], in the memory of an executor, for
/// comparison with QuadStages. Each stage may be repeated. There are two copies of vertices, edges and faces,
/// which are alternately read and written; as counts are known in advance (V' = V + E + F, E' = 2 E + 4 F, F'
/// = 4 F), all memory is allocated once. Quads are not unfolded, and flat ends become round.
///
/// Memory: about 75 bytes per quad of the last level, and a quarter of that for the previous level.
template <class Exec>
class PrintedQuadStages {
  public:
    /// Uses only the cage, its levels, positions and regions of the job. The executor must outlive this
    /// object. Throws InvalidInput for a cage with a boundary, and DeviceError if there are more quads than
    /// can be numbered.
    PrintedQuadStages(Exec& exec, const cuda::QuadJob& job) : exec_(exec), levels_(job.levels) {
        if (!job.cage.closed()) throw InvalidInput("cage: it must be closed for the published subdivision");
        // Half-edges of the last level have numbers of 32 bits.
        const std::uint64_t quads = std::uint64_t{job.cage.face_count()} << (2 * levels_);
        if (quads > std::numeric_limits<std::uint32_t>::max() / 4)
            throw DeviceError("there are too many quads for a device");
        cage_ = cuda::upload_cage(exec, job.cage);
        region_ = exec.upload(job.region);
        positions_ = exec.upload(job.positions);
        mesh_ = cage_;
        for (int level = levels_; level > 0 && level > levels_ - 2; --level)
            copies_[level & 1] = make_copy(size_at(level));
        evolved_ = exec.template array<Vec3>(size_at(levels_).vertices);
    }

    /// Executes Catmull-Clark steps from the cage.
    void refine() {
        mesh_ = cage_;
        refined_ = positions_;
        for (int level = 1; level <= levels_; ++level) {
            const ExplicitQuads fine = get_part(copies_[level & 1], size_at(level));
            const QuadStep step{mesh_, refined_, fine};
            exec_.each("face points", mesh_.face_count(), FacePoints{step});
            exec_.each("edge points", mesh_.edge_count(), EdgePoints{step});
            exec_.each("vertex points", mesh_.vertex_count(), VertexPoints{step});
            mesh_ = make_view(fine);
            refined_ = fine.positions;
        }
    }

    /// Moves the refined vertices towards iso value 1 of a field.
    template <class Field>
    void evolve(const Field& field, const Evolution& how = {}) {
        exec_.each("evolve", refined_.size(),
                   EvolveVertices<Field>{mesh_, levels_, region_, field, how, refined_, evolved_});
    }

    const CageView& mesh() const { return mesh_; }                ///< after refine()
    std::span<const Vec3> refined() const { return refined_; }    ///< [m] after refine()
    std::span<const Vec3> positions() const { return evolved_; }  ///< [m] after evolve()

  private:
    struct Size {
        std::size_t vertices, edges, faces;
    };
    Size size_at(int level) const {
        Size size{cage_.vertex_count(), cage_.edge_count(), cage_.face_count()};
        for (int l = 0; l < level; ++l) {
            size = {size.vertices + size.edges + size.faces, 2 * size.edges + 4 * size.faces, 4 * size.faces};
        }
        return size;
    }

    ExplicitQuads make_copy(const Size& size) {
        const ExplicitQuads out{exec_.template array<Vec3>(size.vertices),
                                exec_.template array<Quad>(size.faces),
                                exec_.template array<std::uint32_t>(4 * size.faces),
                                exec_.template array<std::array<std::uint32_t, 2>>(size.edges),
                                exec_.template array<std::uint32_t>(size.vertices + 1),
                                exec_.template array<std::uint32_t>(4 * size.faces)};
        exec_.clear(out.fan_first.first(1));  // kernels write the ends of fans
        return out;
    }
    /// Returns the part of a copy that a level of that size requires.
    static ExplicitQuads get_part(const ExplicitQuads& copy, const Size& size) {
        return {copy.positions.first(size.vertices),     copy.quads.first(size.faces),
                copy.side.first(4 * size.faces),         copy.edge_half.first(size.edges),
                copy.fan_first.first(size.vertices + 1), copy.fan_half.first(4 * size.faces)};
    }
    static CageView make_view(const ExplicitQuads& mesh) {
        CageView view;
        view.quads = mesh.quads;
        view.side = mesh.side;
        view.edge_half = mesh.edge_half;
        view.fan_first = mesh.fan_first;
        view.fan_half = mesh.fan_half;
        return view;
    }

    Exec& exec_;
    int levels_;
    CageView cage_, mesh_;  // all members from here on are in the executor
    std::span<const std::uint32_t> region_;
    std::span<const Vec3> positions_, refined_;
    std::array<ExplicitQuads, 2> copies_;
    std::span<Vec3> evolved_;
};

}  // namespace coppice::bench
