// Threads, progress and cancellation: execution settings, separate from the options.

#include <cstdio>
#include <stop_token>

#include "coppice/base/context.h"
#include "coppice/base/hash.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/skeleton/random_tree.h"

int main() {
    const coppice::Skeleton tree = coppice::random_tree(3000, /*seed=*/1);

    // The result does not depend on the number of threads.
    std::uint64_t first = 0;
    for (const unsigned threads : {1u, 2u, 7u}) {
        const coppice::Context ctx{.threads = threads};
        const coppice::QuadMesh mesh = coppice::mesh_skeleton(tree, {}, ctx).quads().mesh;
        coppice::Hash hash;
        for (const coppice::Vec3 p : mesh.positions) hash.add(p);
        if (threads == 1) first = hash.value();
        std::printf("%u threads: %s\n", threads, hash.value() == first ? "the same" : "DIFFERENT");
    }

    // Progress is reported on the calling thread: from 0 to 1, never decreasing.
    float last = 0;
    bool rising = true;
    const auto progress = [&](float fraction) {
        rising = rising && fraction >= last && fraction <= 1;
        last = fraction;
    };
    coppice::mesh_skeleton(tree, {}, {.progress = progress});
    std::printf("progress ended at %.0f %%, rising: %s\n", 100 * last, rising ? "yes" : "no");

    // A stop request, here after the first progress report, ends the work with an exception.
    std::stop_source stop;
    try {
        coppice::mesh_skeleton(tree, {},
                               {.stop = stop.get_token(), .progress = [&](float) { stop.request_stop(); }});
    } catch (const coppice::Cancelled& cancelled) {
        std::printf("cancelled: %s\n", cancelled.what());
    }
}
