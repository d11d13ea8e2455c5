// Sketches from arbitrary bytes, and skeletons of those that can be read: finite, or coppice::Error.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/io/sketch/sketch_file.h"
#include "coppice/sketch/reconstruct.h"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

void check(const coppice::SketchResult& made) {
    for (const coppice::NodeId n : nodes(made.skeleton)) {
        require(is_finite(made.skeleton.position(n)) && made.skeleton.radius(n) > 0);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const coppice::Sketch sketch =
            coppice::parse_sketch({reinterpret_cast<const char*>(data), size}, "input");
        coppice::parse_sketch(coppice::encode_sketch(sketch), "back");
        constexpr std::size_t kMostBranches = 20;  // each takes milliseconds under sanitizers
        if (sketch.branches.size() <= kMostBranches) check(reconstruct(sketch, {}, "input", {.threads = 1}));
    } catch (const coppice::Error&) {  // the proper answer to a bad file
    }
    return 0;
}
