#include "coppice/cuda/batch/joined_jobs_internal.h"

#include <algorithm>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/cuda/device.h"

namespace coppice::cuda {
namespace {

std::uint32_t shifted(std::uint32_t index, std::uint32_t by) {
    return index == kNoIndex ? index : index + by;
}

template <class T>
void append(std::vector<T>& to, std::span<const T> values) {
    to.insert(to.end(), values.begin(), values.end());
}

// Throws before arrays of that size are allocated.
void check_size(std::span<const QuadJob> jobs) {
    constexpr std::uint64_t kMax = std::uint64_t{1} << 31;
    std::uint64_t vertices = 0, quads = 0;
    for (const QuadJob& job : jobs) {
        const QuadCounts counts = refined_counts(job.cage, job.levels);
        vertices += counts.vertices;
        quads += counts.quads;
    }
    if (vertices > kMax || quads > kMax)
        throw DeviceError("the surfaces have too many vertices for one batch");
}

}  // namespace

JoinedJobs::JoinedJobs(std::span<const QuadJob> jobs, std::span<const std::uint32_t> regions)
    : job_(jobs.front()) {
    COPPICE_ASSERT(jobs.size() == regions.size());
    check_size(jobs);
    JobOffsets at;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        COPPICE_ASSERT(jobs[i].levels == job_.levels);
        offsets_.push_back(at);
        if (jobs.size() > 1) add(jobs[i], at);
        at.vertices += jobs[i].cage.vertex_count();
        at.edges += jobs[i].cage.edge_count();
        at.faces += jobs[i].cage.face_count();
        at.regions += regions[i];
    }
    offsets_.push_back(at);
    if (jobs.size() > 1) refer();
}

void JoinedJobs::add(const QuadJob& job, const JobOffsets& at) {
    const CageView& cage = job.cage;
    const auto half = [&](std::uint32_t h) { return shifted(h, 4 * at.faces); };
    for (const Quad& q : cage.quads)
        arrays_.quads.push_back(
            {q[0] + at.vertices, q[1] + at.vertices, q[2] + at.vertices, q[3] + at.vertices});
    for (const std::uint32_t s : cage.side) arrays_.side.push_back(s + 2 * at.edges);
    for (const auto& pair : cage.edge_half) arrays_.edge_half.push_back({half(pair[0]), half(pair[1])});
    const auto halves = static_cast<std::uint32_t>(arrays_.fan_half.size());
    for (std::uint32_t v = 0; v < cage.vertex_count(); ++v)
        arrays_.fan_first.push_back(halves + cage.fan_first[v]);
    for (const std::uint32_t h : cage.fan_half) arrays_.fan_half.push_back(half(h));
    if (!cage.closed()) {
        arrays_.on_boundary.resize(at.vertices, 0);
        append(arrays_.on_boundary, cage.on_boundary);
    }
    append(arrays_.positions, job.positions);
    append(arrays_.anchors, job.anchors);
    for (const std::uint32_t r : job.region) arrays_.region.push_back(r + at.regions);
    arrays_.part.insert(arrays_.part.end(), cage.face_count(),
                        static_cast<std::uint32_t>(offsets_.size() - 1));
    for (ClipPlane clip : job.clips) {
        clip.first_quad += at.faces;
        arrays_.clips.push_back(clip);
    }
}

void JoinedJobs::refer() {
    arrays_.fan_first.push_back(static_cast<std::uint32_t>(arrays_.fan_half.size()));
    if (!arrays_.on_boundary.empty()) arrays_.on_boundary.resize(arrays_.positions.size(), 0);
    arrays_.lend(job_);
    job_.parts = static_cast<std::uint32_t>(size());
}

std::uint32_t JoinedJobs::vertex_count(std::size_t job) const {
    const JobOffsets &from = offsets_[job], &to = offsets_[job + 1];
    return refined_counts(to.vertices - from.vertices, to.edges - from.edges, to.faces - from.faces,
                          job_.levels)
        .vertices;
}

void JoinedJobs::copy_part(std::size_t job, std::span<const Vec3> all, std::span<Vec3> out) const {
    const JobOffsets &from = offsets_[job], &to = offsets_[job + 1], &end = offsets_.back();
    const std::size_t inside = (std::size_t{1} << job_.levels) - 1;
    const auto rest = [&](std::span<const Vec3> part, std::span<Vec3> places) {
        std::copy(part.begin(), part.end(), places.begin());
        return places.subspan(part.size());
    };
    // Vertices of the cage come first, then those inside edges, then those inside quads.
    out = rest(all.subspan(from.vertices, to.vertices - from.vertices), out);
    all = all.subspan(end.vertices);
    out = rest(all.subspan(inside * from.edges, inside * (to.edges - from.edges)), out);
    all = all.subspan(inside * end.edges);
    rest(all.subspan(inside * inside * from.faces, inside * inside * (to.faces - from.faces)), out);
}

}  // namespace coppice::cuda
