#include "coppice/cuda/batch/batch_plan_internal.h"

#include <algorithm>

#include "coppice/cuda/batch/quad_tile_internal.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {
namespace {

// Adds tiles of one job, each with at most `most` quads.
void add_tiles(std::vector<BatchRound>& out, IndexRange job, const QuadJob& of, std::size_t most) {
    const std::size_t all = of.cage.face_count();
    for (std::size_t begin = 0; begin < all;) {
        const std::size_t end = QuadTile::cut(of.clips, {begin, all}, begin + most);
        out.push_back({job, true, {begin, end}});
        begin = end;
    }
}

}  // namespace

std::vector<BatchRound> plan_batch(std::span<const QuadJob> jobs, std::span<const JobBytes> bytes,
                                   std::uint64_t room) {
    // Vertices are numbered with 31 bits; those of one quad are a hundredth of the total.
    constexpr std::uint64_t kMaxVertices = std::uint64_t{1} << 31;
    std::vector<BatchRound> out;
    const std::uint64_t free = room > kSlackBytes ? room - kSlackBytes : 0;
    std::uint64_t taken = 0, vertices = 0;
    bool may_join = false;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        const std::uint64_t here = refined_counts(jobs[i].cage, jobs[i].levels).vertices;
        if (bytes[i].sum() > free) {
            // The quads around the tiles require more memory: about a fifth, unless tiles are small.
            require_room(room, kSlackBytes + bytes[i].field);
            constexpr std::size_t kMin = 16;
            const double share =
                static_cast<double>(free - bytes[i].field) / (1.2 * static_cast<double>(bytes[i].job));
            const auto most = static_cast<std::size_t>(share * jobs[i].cage.face_count());
            add_tiles(out, {i, i + 1}, jobs[i], std::max(most, kMin));
            may_join = false;
        } else if (may_join && taken + bytes[i].sum() <= free && vertices + here < kMaxVertices) {
            out.back().jobs.end = i + 1;
            taken += bytes[i].sum();
            vertices += here;
        } else {
            out.push_back({{i, i + 1}});
            taken = bytes[i].sum();
            vertices = here;
            may_join = true;
        }
    }
    return out;
}

std::array<BatchRound, 2> split(const BatchRound& tile, const QuadJob& job, std::uint64_t needed,
                                std::uint64_t room) {
    const IndexRange quads = tile.quads;
    const std::size_t middle = QuadTile::cut(job.clips, quads, quads.begin + quads.size() / 2);
    if (middle == quads.end) require_room(room, needed);
    return {BatchRound{tile.jobs, true, {quads.begin, middle}},
            BatchRound{tile.jobs, true, {middle, quads.end}}};
}

}  // namespace coppice::cuda
