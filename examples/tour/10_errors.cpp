// Errors: invalid data throws an exception of one sentence; repairs are returned in a report.

#include <cstdio>

#include "coppice/base/error.h"
#include "coppice/io_skeleton/reader.h"
#include "coppice/pipeline/mesh_skeleton.h"

/// Runs a function and prints its result.
template <class Work>
void attempt(const char* what, const Work& work) {
    try {
        work();
        std::printf("%s: fine\n", what);
    } catch (const coppice::InvalidInput& error) {  // the data or an option is invalid
        std::printf("%s: invalid: %s\n", what, error.what());
    } catch (const coppice::IoError& error) {  // a file cannot be read or written
        std::printf("%s: io: %s\n", what, error.what());
    } catch (const coppice::Error& error) {  // others: Unsupported, Cancelled
        std::printf("%s: %s\n", what, error.what());
    }
}

int main() {
    using coppice::NodeId;
    using coppice::Vec3;

    attempt("a child before its parent", [] {
        coppice::Skeleton({NodeId(1), NodeId::none()}, {Vec3{0, 0, 1}, Vec3{0, 0, 0}}, {1.0f, 1.0f});
    });
    attempt("an option out of range", [] {
        const coppice::Skeleton ball({NodeId::none()}, {Vec3{}}, {1.0f});
        coppice::mesh_skeleton(ball, {.levels = 12});
    });
    attempt("a missing file", [] { coppice::read_skeleton("nowhere.swc"); });
    attempt("a cycle", [] { coppice::parse_skeleton("1 0 0 0 0 1 2\n2 0 0 0 1 1 1\n", "cycle.swc"); });

    // Here the parent is last, and a radius is missing: both are repaired, and counted.
    const coppice::SkeletonFile file =
        coppice::parse_skeleton("2 0 0 0 1 0 1\n3 0 0 0 2 0.1 2\n1 0 0 0 0 0.3 -1\n", "repaired.swc");
    std::printf("reordered %u, missing radii %u: node 1 now has %.2f\n", file.report.reordered,
                file.report.missing_radii, file.skeleton.radius(NodeId(1)));
}
