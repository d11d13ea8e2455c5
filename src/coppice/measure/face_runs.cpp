#include "coppice/measure/face_runs_internal.h"

#include <cmath>
#include <limits>
#include <utility>

#include "coppice/base/parallel.h"

namespace coppice::measure_internal {

/// The properties of runs of faces.
struct FaceRuns::Runs {
    std::uint32_t length;
    std::vector<Box3> box;
    std::vector<Slab> slab;
    std::vector<double> width;  ///< [m] sum of the diagonals of the faces

    Runs(const FaceView& mesh, std::uint32_t run_length, const Context& ctx)
        : length(run_length),
          box((mesh.size() + run_length - 1) / run_length),
          slab(box.size()),
          width(box.size(), 0.0) {
        constexpr std::size_t kGrain = 1 << 12;
        parallel_for(ctx, box.size(), kGrain, [&](std::size_t run) {
            const auto first = static_cast<std::uint32_t>(run) * length;
            add(mesh, run, first, std::min(first + length, mesh.size()));
        });
    }

    void add(const FaceView& mesh, std::size_t run, std::uint32_t first, std::uint32_t end) {
        const auto at = [&](std::uint32_t v) { return Vec3d(mesh.positions()[v]); };
        Slab& s = slab[run];
        s.longest = 0;
        Vec3d normal;
        for (std::uint32_t f = first; f < end; ++f) {
            const Box3 b = mesh.box(f);
            box[run].extend(b);
            const float diagonal = b.diagonal();
            width[run] += diagonal;
            s.longest = std::max(s.longest, diagonal);
            const auto face = mesh.face(f);
            normal += cross(at(face[1]) - at(face[0]), at(face[2]) - at(face[0]));
        }
        s.normal = Vec3(normalized(normal));
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::uint32_t f = first; f < end; ++f) {
            for (const std::uint32_t v : mesh.face(f)) {
                const double along = dot(at(v), Vec3d(s.normal));
                low = std::min(low, along);
                high = std::max(high, along);
            }
        }
        constexpr float kInfinity = std::numeric_limits<float>::infinity();
        s.low = std::nextafter(static_cast<float>(low), -kInfinity);
        s.high = std::nextafter(static_cast<float>(high), kInfinity);
    }

    /// Returns whether the faces of a run are mostly adjacent: then the diagonal of its box is at most the
    /// sum of theirs.
    bool hold_neighbours() const {
        double of_boxes = 0, of_faces = 0;
        for (const Box3& b : box) of_boxes += b.diagonal();
        for (const double w : width) of_faces += w;
        return of_boxes <= of_faces;
    }

    static Runs of(const FaceView& mesh, const Context& ctx) {
        constexpr std::uint32_t kLength = 16;
        Runs runs(mesh, kLength, ctx);
        return runs.hold_neighbours() ? runs : Runs(mesh, 1, ctx);
    }
};

FaceRuns::FaceRuns(const FaceView& mesh, const Context& ctx) : FaceRuns(mesh, Runs::of(mesh, ctx), ctx) {}

FaceRuns::FaceRuns(const FaceView& mesh, Runs&& runs, const Context& ctx)
    : mesh_(mesh), run_length_(runs.length), slab_(std::move(runs.slab)), boxes_(runs.box, ctx) {}

}  // namespace coppice::measure_internal
