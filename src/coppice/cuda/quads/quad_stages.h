#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "coppice/cuda/quads/quad_job.h"
#include "coppice/cuda/quads/unfold_kernels.h"
#include "coppice/subdivision/fold_clusters.h"

namespace coppice::cuda {

/// The stages from a cage to quads, in the memory of an executor: subdivision, projection, unfolding and
/// normals, each as often as it is asked for. What does not change between frames is copied once.
///
/// Topology is that of PatchRefinement, positions agree with project() and untangle() to 1e-4 of the local
/// radius. Memory: some 70 bytes per refined quad.
template <class Exec>
class QuadStages {
  public:
    /// The executor and the job must outlive it.
    QuadStages(Exec& exec, const QuadJob& job)
        : exec_(exec), job_(job), counts_(refined_counts(job.cage, job.levels)), flat_(flat_of(job)) {
        cage_.quads = exec.upload(job.cage.quads);
        cage_.side = exec.upload(job.cage.side);
        cage_.edge_half = exec.upload(job.cage.edge_half);
        cage_.fan_first = exec.upload(job.cage.fan_first);
        cage_.fan_half = exec.upload(job.cage.fan_half);
        cage_.on_boundary = exec.upload(job.cage.on_boundary);
        region_ = exec.upload(job.region);
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

    /// Gives the cage other points.
    void write_points(std::span<const Vec3> positions, std::span<const Vec3> anchors) {
        exec_.write(positions, points_[0].positions);
        exec_.write(anchors, points_[0].anchors);
    }

    /// The same for those who write them by kernels.
    PointPair cage_points() const { return points_.front(); }
    /// Gives the flat ends other planes; quads stay.
    void write_clips(std::span<const ClipPlane> clips) { exec_.write(clips, clips_); }

    /// Catmull-Clark steps from the cage on.
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
        exec_.clear(sums_);
        project_once(field, 0);
        for (int pass = 1; pass <= job_.project.relax_passes; ++pass) {
            exec_.each("relax", counts_.vertices,
                       RelaxVertices{stars(), job_.project.relax_weight, points().positions, relaxed_});
            std::swap(points().positions, relaxed_);
            project_once(field, static_cast<std::size_t>(pass));
        }
    }

    /// How projection went. Waits for it.
    ProjectReport projected() {
        ProjectReport out;
        if (job_.project.method == ProjectionMethod::none) return out;
        std::vector<ProjectionSums> sums(sums_.size());
        exec_.download(std::span<const ProjectionSums>(sums_), std::span(sums));
        for (const ProjectionSums& pass : sums) {
            out.evaluations += pass.evaluations;
            out.max_evaluations = std::max(out.max_evaluations, pass.most);
        }
        out.not_converged = sums.back().not_converged;
        out.anchors_outside = sums.back().anchors_outside;
        out.clipped = flat_.vertex.size();
        out.vertices = counts_.vertices - lone_vertices();
        return out;
    }

    /// Unfolds what projection has folded: see coppice::untangle. Waits for it.
    template <class Field>
    UntangleReport untangle(const Field& field) {
        UntangleReport report;
        if (job_.untangle.passes == 0 || job_.project.method == ProjectionMethod::none || job_.levels == 0)
            return report;
        const auto before = exec_.mark();
        const std::vector<std::uint32_t> bad = find_bad();
        report.bad_before = bad.size();
        if (!bad.empty()) {
            const FoldClusters clusters(bad, counts_.vertices, PatchStars(job_.cage, job_.levels));
            report.still_bad = clusters.fixed;
            if (clusters.size() > 0) unfold(field, clusters, report);
            std::sort(report.still_bad.begin(), report.still_bad.end());
            report.bad_after = report.still_bad.size();
        }
        exec_.rewind(before);
        return report;
    }

    /// Memory for what projection leaves, so that what is taken later on can be given back.
    void make_projection_room() {
        if (sums_.empty())
            sums_ =
                exec_.template array<ProjectionSums>(static_cast<std::size_t>(job_.project.relax_passes) + 1);
        if (relaxed_.empty() && job_.project.relax_passes > 0)
            relaxed_ = exec_.template array<Vec3>(counts_.vertices);
    }

    /// Memory for all that the stages leave, so that what is taken later on can be given back.
    void make_room() {
        if (normals_.empty()) normals_ = exec_.template array<Vec3>(counts_.vertices);
        if (quads_.empty()) quads_ = exec_.template array<Quad>(counts_.quads);
        make_projection_room();
    }

    /// The normals of the vertices as they are now.
    void make_normals() {
        if (normals_.empty()) normals_ = exec_.template array<Vec3>(counts_.vertices);
        make_normals(points().positions, normals_);
    }
    /// The same of other positions, into another array.
    void make_normals(std::span<const Vec3> positions, std::span<Vec3> normals) {
        exec_.each("normals", counts_.vertices, VertexNormals{stars(), positions, normals});
    }

    /// The refined quads.
    void make_quads() {
        if (quads_.empty()) quads_ = exec_.template array<Quad>(counts_.quads);
        exec_.each("quads", counts_.quads, WriteQuads{stars(), quads_});
    }

    /// From now on the refined points lie there: one place per refined vertex.
    void put_points(const PointPair& points) { points_.back() = points; }

    const CageView& cage() const { return cage_; }                                ///< of the executor
    QuadCounts counts() const { return counts_; }                                 ///< of what comes out
    std::span<const Vec3> positions() const { return points_.back().positions; }  ///< [m] of the executor
    std::span<const Vec3> anchors() const { return points_.back().anchors; }      ///< [m] of the executor
    std::span<const Vec3> normals() const { return normals_; }                    ///< after make_normals()
    std::span<const Quad> quads() const { return quads_; }                        ///< after make_quads()

  private:
    static FlatVertices flat_of(const QuadJob& job) {
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
    void project_once(const Field& field, std::size_t pass) {
        const Projector<Field> projector(field, rule());
        exec_.each("project", counts_.vertices, ProjectVertices<Field>{surface(), projector});
        if (!flat_.vertex.empty()) project_flat(field);
        constexpr std::size_t kEach = SumStatus::kPerThread;
        exec_.each("sum up", (counts_.vertices + kEach - 1) / kEach,
                   SumStatus{status_, sums_.subspan(pass, 1)});
    }

    template <class Field>
    void project_flat(const Field& field) {
        // The edge of a cut is found along rays whatever the method.
        ProjectionRule along_rays = rule();
        along_rays.along_rays = true;
        const std::size_t count = flat_.vertex.size();
        exec_.each("flat ends", count,
                   ProjectFlat<Field>{surface(), flat_view_, Projector<Field>(field, along_rays)});
        exec_.each("rims", job_.clips.size(), MeasureRim{surface(), flat_view_, rims_});
        exec_.each("flat insides", count, FollowRim{surface(), flat_view_, rims_});
    }

    std::uint32_t lone_vertices() const {
        std::uint32_t lone = 0;
        for (std::uint32_t v = 0; v < job_.cage.vertex_count(); ++v) lone += job_.cage.fan(v).empty();
        return lone;
    }

    std::vector<std::uint32_t> find_bad() {
        const std::uint32_t runs = (counts_.quads + FindBad::kRun - 1) / FindBad::kRun;
        const auto found = exec_.template array<std::uint32_t>(std::size_t{runs} * FindBad::kRun);
        const auto first = exec_.template array<std::uint32_t>(runs + 1);
        exec_.clear(first);
        exec_.groups("find folds", runs,
                     FindBad{stars(), FaceLimits(job_.untangle.quality), points().positions, points().anchors,
                             found, first});
        exec_.exclusive_scan(std::span<const std::uint32_t>(first), first);
        std::uint32_t count = 0;
        exec_.download(std::span<const std::uint32_t>(first.last(1)), std::span(&count, 1));
        std::vector<std::uint32_t> out(count);
        if (count == 0) return out;
        const auto bad = exec_.template array<std::uint32_t>(count);
        exec_.groups("gather folds", runs, GatherBad{found, first, bad});
        exec_.download(std::span<const std::uint32_t>(bad), std::span(out));
        return out;
    }

    RowsView upload_rows(const CompressedRows<std::uint32_t>& rows) {
        return {exec_.upload(std::span<const std::uint32_t>(rows.first)),
                exec_.upload(std::span<const std::uint32_t>(rows.items))};
    }

    template <class Field>
    void unfold(const Field& field, const FoldClusters& clusters, UntangleReport& report) {
        const std::size_t vertices = clusters.vertices.items.size(), faces = clusters.faces.items.size();
        const auto numbers = [&](std::size_t count) { return exec_.template array<std::uint32_t>(count); };
        const auto points = [&] { return exec_.template array<Vec3>(vertices); };
        const ClusterView view{upload_rows(clusters.vertices),
                               upload_rows(clusters.faces),
                               upload_rows(clusters.bad),
                               numbers(vertices),
                               numbers(vertices),
                               points(),
                               points(),
                               points(),
                               numbers(faces),
                               numbers(faces),
                               numbers(clusters.size()),
                               numbers(clusters.size()),
                               numbers(clusters.size())};
        exec_.groups("unfold", clusters.size(),
                     UnfoldCluster<Field>{surface(), view, field, FaceLimits(job_.untangle.quality),
                                          job_.untangle.passes, job_.untangle.projected_passes});
        const auto download = [&](std::span<const std::uint32_t> from) {
            std::vector<std::uint32_t> out(from.size());
            exec_.download(from, std::span(out));
            return out;
        };
        const auto still = download(view.least_bad), count = download(view.least_count);
        const auto passes = download(view.passes), moved = download(view.moved_count);
        for (std::uint32_t c = 0; c < clusters.size(); ++c) {
            report.passes = std::max(report.passes, passes[c]);
            report.moved += moved[c];
            for (std::uint32_t k = 0; k < count[c]; ++k)
                report.still_bad.push_back(clusters.faces[c][still[clusters.faces.first[c] + k]]);
        }
    }

    Exec& exec_;
    QuadJob job_;
    QuadCounts counts_;
    FlatVertices flat_;
    CageView cage_;  // of the executor, as all that follows
    std::span<const std::uint32_t> region_;
    std::span<ClipPlane> clips_;
    std::vector<PointPair> points_;  // by level
    std::span<Vec3> relaxed_;        // what the next relaxation is written to
    std::span<ProjectionStatus> status_;
    std::span<ProjectionSums> sums_;  // by pass
    FlatView flat_view_;
    std::span<RimChange> rims_;
    std::span<Vec3> normals_;
    std::span<Quad> quads_;
};

}  // namespace coppice::cuda
