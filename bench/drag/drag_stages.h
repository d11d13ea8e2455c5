#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "coppice/cuda/device.h"
#include "coppice/cuda/lists/lists_stages_internal.h"
#include "coppice/cuda/quads/quad_stages_internal.h"
#include "drag/drag_job.h"
#include "drag/drag_kernels.h"

namespace coppice::bench {

/// The stages of a frame that recomputes a portion of a surface, in the memory of an executor: writes moved
/// elements, finds the lists of the field, refines the cage of the portion, moves it onto the field, copies
/// it to the drawn vertices, and shades it. Constant data is copied once.
///
/// Topology is that of PatchRefinement, positions agree with project() to 1e-4 of the local radius.
template <class Exec>
class DragStages {
  public:
    /// Starts at rest. The executor must outlive this object and must not be used otherwise; the data of the
    /// job must outlive it as well. `room` is the initial room for the lists of the field, by default the
    /// usual one; it grows as required.
    DragStages(Exec& exec, const DragJob& job, const std::optional<cuda::ListRoom>& room = {})
        : exec_(exec),
          counts_{job.quads.clips.size(), job.written(), job.shaded()},
          quads_(exec, job.quads),
          tables_(cuda::upload_contacts(exec, cuda::contact_topology(job.contacts))),
          segments_(copied<cuda::DeviceSegment>(cuda::device_segments(job.contacts.field))),
          nodes_(copied<Vec3>(job.contacts.skeleton.positions())),
          tube_nodes_(copied<Vec3>(job.contacts.tubes.tree.positions())),
          geometry_(compute_geometry(job.contacts)),
          order_(cuda::competitor_order(exec, tables_, geometry_)),
          room_(room.value_or(cuda::usual_room(tables_.tubes.size()))),
          blend_(job.contacts.field.blend()),
          contact_(job.contacts.field.contact()),
          which_{exec.upload(job.nodes), exec.upload(job.tube_nodes), exec.upload(job.vertices)},
          from_(exec.upload(job.from)),
          shade_{exec.upload(job.fan_first), exec.upload(job.fan_quads), exec.upload(job.quads_about), {}} {
        quads_.make_projection_room();
        before_ = exec.mark();
    }

    /// Begins a frame, and does not wait for it. `project(quads, field)` moves refined vertices onto a field:
    /// see QuadStages::project. The result is valid if has_room() returns true.
    template <class Project>
    void begin(const DragMoves& moves, const DrawnVertices& drawn, const Project& project) {
        exec_.rewind(before_);
        place(moves);
        if (!use_same_buffers(drawn, shade_.drawn)) launches_.clear();
        shade_.drawn = drawn;
        exec_.replay(launches_, [&] {
            lists_ = cuda::begin_contacts(exec_, tables_, geometry_, order_, room_);
            quads_.refine();
            project(quads_, cuda::FieldArrays{segments_, lists_.own, lists_.competitors, blend_, contact_});
            exec_.each("write drawn", counts_.written,
                       WriteDrawn{from_, quads_.positions(), shade_.drawn.positions});
            exec_.each("shade drawn", counts_.shaded, shade_);
        });
    }

    /// Waits for the frame. Returns false if the lists of the field had too little room: the room is then
    /// increased, and the frame must be started again. Throws DeviceError if the CPU has to compute the
    /// lists.
    bool has_room() {
        const cuda::ListState state = cuda::read_state(exec_, lists_);
        if (state.is_cut)
            throw DeviceError("more branches meet at one place than the lists on the device can store");
        if (state.fits(room_)) return true;
        // Slightly more than currently required, because branches continue to move.
        constexpr std::uint32_t kShare = 8;
        room_ = cuda::grown(room_, state);
        room_ = {room_.own + room_.own / kShare, room_.competitors + room_.competitors / kShare};
        launches_.clear();
        return false;
    }

  private:
    static bool use_same_buffers(const DrawnVertices& a, const DrawnVertices& b) {
        return a.positions.data() == b.positions.data() && a.normals.data() == b.normals.data();
    }

    struct Counts {
        std::size_t clips, written, shaded;
    };
    struct Moving {
        std::span<const std::uint32_t> nodes, tube_nodes, vertices;
    };

    template <class T>
    std::span<T> copied(std::span<const T> values) {
        const std::span<T> out = exec_.template array<T>(values.size());
        exec_.write(values, out);
        return out;
    }
    cuda::ContactGeometry compute_geometry(const cuda::ContactInput& input) {
        const cuda::PointPair cage = quads_.cage_points();
        return {segments_,
                input.field.reach(),
                nodes_,
                exec_.upload(input.skeleton.radii()),
                tube_nodes_,
                exec_.upload(input.tubes.tree.radii()),
                quads_.cage().quads,
                cage.positions,
                cage.anchors};
    }

    void place(const DragMoves& moves) {
        exec_.each("place nodes", moves.nodes.size(),
                   PlaceNodes{which_.nodes, exec_.upload(moves.nodes), nodes_, segments_});
        exec_.each("place tubes", moves.tube_nodes.size(),
                   PlaceTubes{which_.tube_nodes, exec_.upload(moves.tube_nodes), tube_nodes_});
        exec_.each("place vertices", moves.vertices.size(),
                   PlaceVertices{which_.vertices, exec_.upload(moves.vertices), quads_.cage_points()});
        if (counts_.clips > 0) quads_.write_clips(moves.clips);
    }

    Exec& exec_;
    Counts counts_;
    cuda::QuadStages<Exec> quads_;
    cuda::ContactTables tables_;
    std::span<cuda::DeviceSegment> segments_;
    std::span<Vec3> nodes_, tube_nodes_;
    cuda::ContactGeometry geometry_;
    std::span<const std::uint32_t> order_;
    cuda::ListRoom room_;
    int blend_;
    float contact_;
    Moving which_;
    std::span<const std::uint32_t> from_;
    ShadeDrawn shade_;
    typename Exec::Mark before_{};
    typename Exec::Recording launches_;  // of all frames with equal buffers
    cuda::DeviceLists lists_;
};

}  // namespace coppice::bench
