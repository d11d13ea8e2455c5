#include "coppice/pipeline/repair/tube_quads_internal.h"

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/mesh/face_view.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kTubeGrain = 256;

void extend(CageRun& run, std::uint32_t face) {
    if (run.count == 0) run.first = face;
    COPPICE_ASSERT(face == run.first + run.count);
    ++run.count;
}

}  // namespace

std::vector<TubeFaces> faces_of_tubes(const TubeRows& tube_rows) {
    const ControlMesh& cage = tube_rows.cage();
    std::vector<TubeFaces> out(tube_rows.tubes().size());
    const auto run = [&](TubeFace part, NodeId region) -> CageRun& {
        TubeFaces& tube = out[region.index()];
        switch (part) {
            case TubeFace::side:
                return tube.side;
            case TubeFace::start:
                return tube.cap[0];
            case TubeFace::end:
                return tube.cap[1];
            case TubeFace::fork:
                break;
        }
        const NodeId owner = tube_rows.fork_tube(region);
        return out[owner.index()].fork[owner == region ? 1 : 0];
    };
    for (std::uint32_t f = 0; f < cage.region.size(); ++f)
        extend(run(cage.part[f], NodeId(cage.region[f])), f);
    return out;
}

std::vector<std::uint32_t> quads_near(const TubeQuads& tubes, const BoxTree& tree, const Context& ctx) {
    const FaceView mesh(tubes.mesh);
    const std::size_t count = tubes.faces.size();
    const int shift = 2 * tubes.tube_rows.levels();
    std::vector<std::vector<std::uint32_t>> found((count + kTubeGrain - 1) / kTubeGrain);
    parallel_for_ranges(ctx, count, kTubeGrain, [&](IndexRange range) {
        auto& own = found[range.begin / kTubeGrain];
        for (std::size_t t = range.begin; t < range.end; ++t) {
            if (tubes.boxes[t].empty() || !tree.meets(tubes.boxes[t])) continue;
            const TubeFaces& faces = tubes.faces[t];
            for (const CageRun& run : {faces.beyond(0), faces.side, faces.beyond(1)}) {
                const std::uint32_t end = (run.first + run.count) << shift;
                for (std::uint32_t q = run.first << shift; q < end; ++q) {
                    if (tree.meets(mesh.box(q))) own.push_back(q);
                }
            }
        }
    });
    std::vector<std::uint32_t> quads;
    for (const auto& f : found) quads.insert(quads.end(), f.begin(), f.end());
    std::sort(quads.begin(), quads.end());
    return quads;
}

}  // namespace coppice::pipeline_internal
