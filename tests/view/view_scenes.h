#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/mesh/normals.h"
#include "coppice/render/frame_view.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/view/offscreen_context.h"
#include "coppice/view/surface_view.h"

namespace coppice::test {

/// Returns the reason why OpenGL is not available; empty if it is.
inline std::string missing_gl() {
    try {
        const OffscreenContext context;
        return {};
    } catch (const Unsupported& error) {
        return error.what();
    }
}

/// Skips tests that draw if OpenGL is not available.
class ViewTest : public ::testing::Test {
  protected:
    void SetUp() override {
        if (const std::string missing = missing_gl(); !missing.empty()) GTEST_SKIP() << missing;
    }
};

inline Skeleton small_tree() { return random_tree(150, 5); }

inline ViewOptions small_picture() { return {.camera = {.width = 320, .height = 240}}; }

/// Returns a camera that sees all of these points.
inline SketchView camera_for(std::span<const Vec3> positions, const ViewOptions& options) {
    std::vector<Vec3d> points;
    for (const Vec3 p : positions) points.emplace_back(p);
    return frame_view(points, options.camera);
}

}  // namespace coppice::test
