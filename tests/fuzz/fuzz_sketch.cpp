// Reads sketches from arbitrary bytes, and creates skeletons of valid ones: these are finite, or
// coppice::Error is thrown.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/io_sketch/sketch_file.h"
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
        constexpr std::size_t kMaxBranches = 20;  // each needs milliseconds with sanitizers
        if (sketch.branches.size() <= kMaxBranches) check(reconstruct(sketch, {}, "input", {.threads = 1}));
    } catch (const coppice::Error&) {  // expected for an invalid file
    }
    return 0;
}
