#include "drag/drag_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/mesh/normals.h"
#include "coppice/render/frame_view.h"

namespace coppice::bench {
namespace {

constexpr int kPictures = 4;
constexpr double kSwings = 1.25;  // to one side, to the other, and again to the first

class Stopwatch {
  public:
    // Returns the seconds since the previous call.
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const std::chrono::duration<double> took = now - std::exchange(last_, now);
        return took.count();
    }

  private:
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// Seconds of the steps of all frames.
struct Laps {
    std::vector<double> edit, surface, upload, draw;

    FrameTimes summary(double& whole) const {
        std::vector<double> frame;
        for (std::size_t k = 0; k < edit.size(); ++k) {
            frame.push_back(edit[k] + surface[k] + upload[k] + draw[k]);
            whole += frame.back();
        }
        return {statistics(edit), statistics(surface), statistics(upload), statistics(draw),
                statistics(std::move(frame))};
    }
};

SketchView make_camera(std::span<const Vec3> positions, std::span<const Vec3> reached,
                       const ViewOptions& options) {
    std::vector<Vec3d> points;
    for (const Vec3 p : positions) points.emplace_back(p);
    for (const Vec3 p : reached) points.emplace_back(p);
    return frame_view(points, options.camera);
}

// Returns the direction from the object to the camera.
Vec3d viewing_axis(const ViewOptions& options) {
    const double azimuth = options.camera.azimuth, elevation = options.camera.elevation;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// Returns the positions that the nodes of the branch reach, on both sides of rest, with their radii.
std::vector<Vec3> reached_places(const QuadBuild& build, const BranchDrag& drag, double swing) {
    constexpr int kSteps = 8;
    std::vector<Vec3> out;
    DragPose pose = drag.rest();
    for (int k = -kSteps; k <= kSteps; ++k) {
        drag.turn(swing * k / kSteps, pose);
        for (const std::uint32_t n : drag.nodes()) {
            const float r = build.skeleton.radius(NodeId(n));
            const Vec3 p = pose.nodes[n];
            for (const Vec3 way : {Vec3{r, 0, 0}, Vec3{0, r, 0}, Vec3{0, 0, r}})
                out.insert(out.end(), {p - way, p + way});
        }
    }
    return out;
}

// Returns whether an image of this frame is stored.
bool is_shown(int frame, int frames) {
    if (frames <= kPictures) return true;
    for (int i = 0; i < kPictures; ++i)
        if (frame == i * (frames - 1) / (kPictures - 1)) return true;
    return false;
}

double compute_angle(int frame, const DragOptions& dragging) {
    if (frame == 0) return 0;
    const double way = static_cast<double>(frame) / (dragging.frames - 1);
    return dragging.swing * std::sin(2 * std::numbers::pi * kSwings * way);
}

NodeId checked_branch(const QuadBuild& build, const DragOptions& dragging) {
    const NodeId top = branch_of_about(build.skeleton, static_cast<std::uint32_t>(dragging.segments));
    if (!top) throw InvalidInput("a tree without segments has no branch to drag");
    return top;
}

// Returns for each drawn vertex 1 if it belongs to the branch, else 0.
std::vector<float> collect_vertices(const QuadBuild& build, const BranchDrag& drag, const DragPart& part) {
    std::vector<float> out(part.vertex.size());
    std::vector<std::uint8_t> turns(build.cage.region_node.size());
    for (const std::uint32_t tube : drag.tube_nodes()) turns[tube] = 1;
    const std::size_t each = part.quads.size() / build.cage.region.size();
    for (std::size_t q = 0; q < part.quads.size(); ++q) {
        if (turns[build.cage.region[q / each]] == 0) continue;
        for (const std::uint32_t v : part.quads[q]) out[v] = 1;
    }
    return out;
}

// All data before the first frame.
struct Prepared {
    BranchDrag drag;
    DragPart part;
    SurfaceView view;

    static SurfaceView make_view(const QuadBuild& build, const BranchDrag& drag, const DragPart& part,
                                 const DragOptions& dragging, const ViewOptions& options) {
        QuadMesh drawn{{}, part.quads, {}};
        for (const std::uint32_t v : part.vertex) drawn.positions.push_back(build.refined[v]);
        const Buffer<Vec3> normals = smooth_normals(drawn.positions, drawn.quads);
        const TriMesh triangles = triangulate(drawn);
        const std::vector<Vec3> reached = reached_places(build, drag, dragging.swing);
        const std::vector<float> marked = collect_vertices(build, drag, part);
        return {{drawn.positions, normals, triangles.triangles, marked},
                make_camera(drawn.positions, reached, options),
                options,
                reached};
    }

    Prepared(const QuadBuild& build, const DragOptions& dragging, const ViewOptions& options,
             const Context& ctx)
        : drag(build, checked_branch(build, dragging), viewing_axis(options)),
          part(drag_part(build, drag, dragging.swing, ctx)),
          view(make_view(build, drag, part, dragging, options)) {}
};

// Calls begin() and end() of a backend.
class Running {
  public:
    Running(SurfaceBackend& backend, const Prepared& prepared, const QuadBuild& build, const Context& ctx)
        : backend_(backend), scene_{build, prepared.drag, prepared.part} {
        try {
            backend.begin(scene_, prepared.view.buffers(), ctx);
        } catch (...) {
            backend.end();
            throw;
        }
    }
    ~Running() { backend_.end(); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

  private:
    SurfaceBackend& backend_;
    DragScene scene_;
};

}  // namespace

DragFigures measure_drag(const QuadBuild& build, const DragOptions& dragging, const ViewOptions& options,
                         SurfaceBackend& backend, const Context& ctx) {
    check_fields(options, "view");
    Prepared prepared(build, dragging, options, ctx);
    const auto& [drag, part, view] = prepared;
    const Context each{.threads = ctx.threads, .stop = ctx.stop};
    const Running running(backend, prepared, build, each);
    DragFigures out{.renderer = view.context().renderer(),
                    .opengl = view.context().version(),
                    .branch = build.skeleton.stable_id(drag.top()).index(),
                    .segments = static_cast<std::uint32_t>(drag.nodes().size()),
                    .quads = static_cast<std::uint32_t>(part.quads.size()),
                    .vertices = static_cast<std::uint32_t>(part.vertex.size()),
                    .written = part.written,
                    .frames = static_cast<std::uint32_t>(dragging.frames)};
    Laps laps;
    DragPose pose = drag.rest();
    for (int k = 0; k < dragging.frames; ++k) {
        ctx.throw_if_cancelled();
        Stopwatch watch;
        drag.turn(compute_angle(k, dragging), pose);
        laps.edit.push_back(watch.lap());
        backend.make(pose, each);
        laps.surface.push_back(watch.lap());
        backend.deliver();
        laps.upload.push_back(watch.lap());
        prepared.view.draw();
        laps.draw.push_back(watch.lap());
        if (is_shown(k, dragging.frames)) out.pictures.push_back(view.picture());
        ctx.report(static_cast<float>(k + 1) / static_cast<float>(dragging.frames));
    }
    out.backend = backend.name();
    out.note = backend.note();
    double whole = 0;
    out.seconds = laps.summary(whole);
    out.frames_per_second = dragging.frames / whole;
    return out;
}

}  // namespace coppice::bench
