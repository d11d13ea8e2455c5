#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/cuda/quads/quad_job.h"
#include "coppice/cuda/quads/unfold_kernels_internal.h"
#include "coppice/cuda/quads/upload_cage_internal.h"

namespace coppice::cuda {

/// The stages from a cage to quads, in the memory of an executor: subdivision, projection, unfolding and
/// normals. Each stage may be repeated. Data that does not change between frames is copied once.
///
/// Topology is that of PatchRefinement, positions agree with project() and untangle() to 1e-4 of the local
/// radius. Memory: about 70 bytes per refined quad.
template <class Exec>
class QuadStages {
  public:
    /// The executor and the job must outlive this object.
    QuadStages(Exec& exec, const QuadJob& job)
        : exec_(exec),
          job_(job),
          counts_(refined_counts(job.cage, job.levels)),
          flat_(make_flat_vertices(job)) {
        cage_ = upload_cage(exec, job.cage);
        region_ = exec.upload(job.region);
        part_ = exec.upload(job.part);
        clips_ = exec.template array<ClipPlane>(job.clips.size());
        write_clips(job.clips);
        for (int level = 0; level <= job.levels; ++level) {
            const std::size_t count = refined_counts(job.cage, level).vertices;
            points_.push_back({exec.template array<Vec3>(count), exec.template array<Vec3>(count)});
        }
        status_ = exec.template array<ProjectionStatus>(counts_.vertices);
        upload_flat();
        write_points(job.positions, job.anchors);
    }

    /// Replaces the points of the cage.
    void write_points(std::span<const Vec3> positions, std::span<const Vec3> anchors) {
        exec_.write(positions, points_[0].positions);
        exec_.write(anchors, points_[0].anchors);
    }

    /// Returns the points of the cage, for kernels that write them.
    PointPair cage_points() const { return points_.front(); }
    /// Replaces the planes of the flat ends; their quads stay.
    void write_clips(std::span<const ClipPlane> clips) { exec_.write(clips, clips_); }

    /// Executes Catmull-Clark steps from the cage.
    void refine() {
        for (int level = 0; level < job_.levels; ++level) {
            with_grid_size(level, [&]<int N>() {
                if constexpr (N < 1 << PatchRefinement::kMaxLevels) {
                    const RefineLevel<N> kernel{cage_, points_[level], points_[level + 1]};
                    exec_.each("refine", kernel.size(), kernel);
                }
            });
        }
    }

    /// Moves the refined vertices onto a field: see coppice::project.
    template <class Field>
    void project(const Field& field) {
        if (job_.project.method == ProjectionMethod::none) return;
        make_projection_room();
        project_once(field);
        for (int pass = 1; pass <= job_.project.relax_passes; ++pass) {
            sum_up(pass - 1);
            exec_.each("relax", counts_.vertices,
                       RelaxVertices{stars(), job_.project.relax_weight, points().positions, relaxed_});
            std::swap(points().positions, relaxed_);
            project_once(field);
        }
    }

    /// Counts that are being copied from the executor.
    struct ProjectionCounts {
        std::span<const ProjectionSums> sums;  ///< by pass, then by report
    };
    /// Starts to count the results of projection.
    ProjectionCounts count_projected() {
        if (job_.project.method == ProjectionMethod::none) return {};
        sum_up(job_.project.relax_passes);
        return {exec_.fetch(std::span<const ProjectionSums>(sums_))};
    }
    /// Returns the projection reports, after waiting for the executor.
    std::vector<ProjectReport> make_reports(const ProjectionCounts& counts) const {
        std::vector<ProjectReport> out(job_.parts);
        if (counts.sums.empty()) return out;
        for (std::size_t i = 0; i < counts.sums.size(); ++i) {
            ProjectReport& report = out[i % job_.parts];
            const ProjectionSums& pass = counts.sums[i];
            report.evaluations += pass.evaluations;
            report.max_evaluations = std::max(report.max_evaluations, pass.most);
            report.vertices = pass.vertices;
            report.not_converged = pass.not_converged;
            report.anchors_outside = pass.anchors_outside;
        }
        const PatchStars stars(job_.cage, job_.levels);
        for (const std::uint32_t v : flat_.vertex) {
            const std::uint32_t part = job_.part.empty() ? 0 : job_.part[stars.owner(v)];
            if (part < job_.parts) ++out[part].clipped;
        }
        return out;
    }

    /// Returns the result of projection. Waits.
    ProjectReport projected() {
        const auto before = exec_.mark();
        const ProjectionCounts counts = count_projected();
        exec_.wait();
        const ProjectReport report = make_reports(counts).front();
        exec_.rewind(before);
        return report;
    }

    /// Allocates memory for the results of projection, so that later allocations can be released.
    void make_projection_room() {
        if (sums_.empty())
            sums_ = exec_.template array<ProjectionSums>(
                (static_cast<std::size_t>(job_.project.relax_passes) + 1) * job_.parts);
        if (relaxed_.empty() && job_.project.relax_passes > 0)
            relaxed_ = exec_.template array<Vec3>(counts_.vertices);
    }

    /// A search for folds in progress.
    struct FoldSearch {
        bool is_needed = false;                       ///< otherwise there is no search
        typename Exec::Mark before{};                 ///< state of the memory at the start
        std::span<const std::uint32_t> found, first;  ///< see FindBad
        std::span<const std::uint32_t> there,
            bad;  ///< on the executor, and on the host after waiting: see GatherBad
    };
    /// Starts to search for folds. Memory allocated from here on is released by unfold().
    FoldSearch find_folds() {
        FoldSearch out;
        out.is_needed = job_.untangle.passes > 0 && job_.project.method != ProjectionMethod::none &&
                        job_.levels > 0 && counts_.quads > 0;
        if (!out.is_needed) return out;
        // Most surfaces have fewer, which are then on the host as soon as their count is.
        constexpr std::uint32_t kUsualShare = 64, kMinRoom = 1024;
        out.before = exec_.mark();
        const std::uint32_t runs = fold_runs();
        const auto bad = exec_.template array<std::uint32_t>(kMinRoom + counts_.quads / kUsualShare);
        const auto found = exec_.template array<std::uint32_t>(std::size_t{runs} * FindBad::kRun);
        const auto first = exec_.template array<std::uint32_t>(runs + 1);
        exec_.clear(bad);  // all of it is fetched
        exec_.clear(first);
        exec_.groups("find folds", runs,
                     FindBad{stars(), FaceLimits(job_.untangle.quality), points().positions, points().anchors,
                             found, first});
        exec_.exclusive_scan(std::span<const std::uint32_t>(first), first);
        exec_.groups("gather folds", runs, GatherBad{found, first, bad});
        out.found = found;
        out.first = first;
        out.there = bad;
        out.bad = exec_.fetch(out.there);
        return out;
    }
    /// Unfolds the folds of a search: see coppice::untangle; returns one report for each index. Waits, only
    /// once if there are no folds.
    template <class Field>
    std::vector<UntangleReport> unfold(FoldSearch search, const Field& field) {
        std::vector<UntangleReport> reports(job_.parts);
        if (!search.is_needed) return reports;
        exec_.wait();
        if (search.bad[0] > 0) {
            fetch_all(search);
            unfold_all(search, field, reports);
        }
        exec_.rewind(search.before);
        return reports;
    }

    /// Unfolds folds that projection created. Waits.
    template <class Field>
    UntangleReport untangle(const Field& field) {
        return unfold(find_folds(), field).front();
    }

    /// Allocates memory for all results of the stages, so that later allocations can be released.
    void make_room() {
        if (normals_.empty()) normals_ = exec_.template array<Vec3>(counts_.vertices);
        if (quads_.empty()) quads_ = exec_.template array<Quad>(counts_.quads);
        make_projection_room();
    }

    /// Computes the normals of the vertices at their current positions.
    void make_normals() {
        if (normals_.empty()) normals_ = exec_.template array<Vec3>(counts_.vertices);
        make_normals(points().positions, normals_);
    }
    /// Computes the normals of other positions into another array.
    void make_normals(std::span<const Vec3> positions, std::span<Vec3> normals) {
        exec_.each("normals", counts_.vertices, VertexNormals{stars(), positions, normals});
    }

    /// Writes the refined quads.
    void make_quads() {
        if (quads_.empty()) quads_ = exec_.template array<Quad>(counts_.quads);
        exec_.each("quads", counts_.quads, WriteQuads{stars(), quads_});
    }

    /// Replaces the arrays of the refined points: one element per refined vertex.
    void put_points(const PointPair& points) { points_.back() = points; }

    const CageView& cage() const { return cage_; }                                ///< in the executor
    QuadCounts counts() const { return counts_; }                                 ///< of the output
    std::span<const Vec3> positions() const { return points_.back().positions; }  ///< [m] in the executor
    std::span<const Vec3> anchors() const { return points_.back().anchors; }      ///< [m] in the executor
    std::span<const Vec3> normals() const { return normals_; }                    ///< after make_normals()
    std::span<const Quad> quads() const { return quads_; }                        ///< after make_quads()

  private:
    static FlatVertices make_flat_vertices(const QuadJob& job) {
        return FlatVertices(PatchStars(job.cage, job.levels), job.levels, job.clips);
    }

    PatchStars stars() const { return PatchStars(cage_, job_.levels); }
    PointPair& points() { return points_.back(); }
    SurfaceView surface() { return {stars(), job_.levels, region_, clips_, points(), status_}; }

    void upload_flat() {
        if (flat_.vertex.empty()) return;
        std::vector<std::uint32_t> end(flat_.vertex.size());
        for (std::uint32_t e = 0; e + 1 < flat_.first.size(); ++e)
            std::fill(end.begin() + flat_.first[e], end.begin() + flat_.first[e + 1], e);
        flat_view_ = {exec_.upload(std::span<const std::uint32_t>(flat_.first)),
                      exec_.upload(std::span<const std::uint32_t>(flat_.vertex)),
                      exec_.upload(std::span<const std::uint32_t>(end)),
                      exec_.upload(std::span<const std::uint8_t>(flat_.on_rim)),
                      exec_.template array<float>(end.size())};
        rims_ = exec_.template array<RimChange>(job_.clips.size());
    }

    ProjectionRule rule() const {
        const ProjectOptions& o = job_.project;
        return {{o.tolerance, o.max_stretch, false},
                {o.damping, o.tolerance, o.max_stretch, o.method == ProjectionMethod::newton},
                o.max_evaluations,
                o.method == ProjectionMethod::rays};
    }

    template <class Field>
    void project_once(const Field& field) {
        const Projector<Field> projector(field, rule());
        exec_.each("project", counts_.vertices, ProjectVertices<Field>{surface(), projector});
        if (!flat_.vertex.empty()) project_flat(field);
    }

    void sum_up(int pass) {
        const auto sums = sums_.subspan(static_cast<std::size_t>(pass) * job_.parts, job_.parts);
        exec_.clear(sums);
        exec_.each("sum up", SumStatus::thread_count(counts_.vertices),
                   SumStatus{stars(), part_, status_, sums});
    }

    template <class Field>
    void project_flat(const Field& field) {
        // The edge of a cut is found along rays for any method.
        ProjectionRule along_rays = rule();
        along_rays.along_rays = true;
        const std::size_t count = flat_.vertex.size();
        exec_.each("flat ends", count,
                   ProjectFlat<Field>{surface(), flat_view_, Projector<Field>(field, along_rays)});
        exec_.each("rims", job_.clips.size(), MeasureRim{surface(), flat_view_, rims_});
        exec_.each("flat insides", count, FollowRim{surface(), flat_view_, rims_});
    }

    std::uint32_t fold_runs() const { return (counts_.quads + FindBad::kRun - 1) / FindBad::kRun; }

    /// Fetches the bad quads that did not fit into the room of the search. May wait.
    void fetch_all(FoldSearch& search) {
        const std::size_t count = std::size_t{1} + search.bad[0];
        if (count > search.bad.size()) {
            const auto bad = exec_.template array<std::uint32_t>(count);
            exec_.groups("gather folds", fold_runs(), GatherBad{search.found, search.first, bad});
            search.there = bad;
            search.bad = exec_.fetch(search.there);
            exec_.wait();
        }
        search.there = search.there.subspan(1, count - 1);
        search.bad = search.bad.subspan(1, count - 1);
    }

    template <class Field>
    void unfold_all(const FoldSearch& search, const Field& field, std::vector<UntangleReport>& reports) {
        const PatchStars on_host(job_.cage, job_.levels);
        const auto may_not_move = [&](std::uint32_t q) {
            return std::ranges::all_of(on_host.quad(q),
                                       [&](std::uint32_t v) { return on_host.on_boundary(v); });
        };
        for (const std::uint32_t q : search.bad) {
            UntangleReport& report = reports[job_.part_of_quad(q)];
            ++report.bad_before;
            if (may_not_move(q)) report.still_bad.push_back(q);
        }
        unfold_clusters(search.there, field, reports);
        for (UntangleReport& report : reports) {
            std::sort(report.still_bad.begin(), report.still_bad.end());
            report.bad_after = report.still_bad.size();
        }
    }

    template <class Field>
    void unfold_clusters(std::span<const std::uint32_t> bad, const Field& field,
                         std::vector<UntangleReport>& reports) {
        const auto numbers = [&](std::size_t n) { return exec_.template array<std::uint32_t>(n); };
        // All numbers that the host reads are contiguous.
        const std::size_t parts = reports.size();
        const auto results = numbers(1 + 2 * parts + bad.size());
        exec_.clear(results);
        const UnfoldOutcome outcome{results.first(1), results.last(bad.size()), results.subspan(1, parts),
                                    results.subspan(1 + parts, parts)};
        const DeviceClusters clusters = fold_clusters(exec_, stars(), bad);
        const std::size_t vertices = clusters.vertices.size(), faces = clusters.faces.size();
        const auto points = [&] { return exec_.template array<Vec3>(vertices); };
        const ClusterRoom room{numbers(vertices), numbers(vertices), points(),      points(),
                               points(),          numbers(faces),    numbers(faces)};
        exec_.groups("unfold", bad.size(),
                     UnfoldCluster<Field>{surface(), clusters, room, outcome, part_, field,
                                          FaceLimits(job_.untangle.quality), job_.untangle.passes,
                                          job_.untangle.projected_passes});
        const std::span<const std::uint32_t> values = exec_.fetch(std::span<const std::uint32_t>(results));
        exec_.wait();
        for (std::size_t p = 0; p < parts; ++p) {
            reports[p].passes = values[1 + p];
            reports[p].moved = values[1 + parts + p];
        }
        for (const std::uint32_t q : values.subspan(1 + 2 * parts, values[0]))
            reports[job_.part_of_quad(q)].still_bad.push_back(q);
    }

    Exec& exec_;
    QuadJob job_;
    QuadCounts counts_;
    FlatVertices flat_;
    CageView cage_;  // all members from here on are in the executor
    std::span<const std::uint32_t> region_, part_;
    std::span<ClipPlane> clips_;
    std::vector<PointPair> points_;  // by level
    std::span<Vec3> relaxed_;        // output of the next relaxation
    std::span<ProjectionStatus> status_;
    std::span<ProjectionSums> sums_;  // by pass, then by report
    FlatView flat_view_;
    std::span<RimChange> rims_;
    std::span<Vec3> normals_;
    std::span<Quad> quads_;
};

}  // namespace coppice::cuda
