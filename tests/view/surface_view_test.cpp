#include "coppice/view/surface_view.h"

#include <algorithm>

#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/render.h"
#include "coppice/render/silhouette.h"
#include "view_scenes.h"

namespace coppice {
namespace {

using test::camera_for;
using test::small_picture;

/// A tree prepared for drawing.
struct Tree {
    QuadMesh mesh = mesh_skeleton(test::small_tree(), {.levels = 1}).quads().mesh;
    Buffer<Vec3> normals = smooth_normals(mesh.positions, mesh.quads);
    TriMesh triangles = triangulate(mesh);

    DrawnSurface drawn() const { return {mesh.positions, normals, triangles.triangles}; }
};

/// Counts the pixels that both images show, and those that only one shows.
struct Overlap {
    int both = 0, one = 0;

    Overlap(const Mask& a, const Mask& b) {
        for (std::size_t i = 0; i < a.inside.size(); ++i) {
            both += a.inside[i] != 0 && b.inside[i] != 0 ? 1 : 0;
            one += a.inside[i] != b.inside[i] ? 1 : 0;
        }
    }
};

class SurfaceViewTest : public test::ViewTest {};

TEST_F(SurfaceViewTest, MatchesRenderWithTheSameCamera) {
    const Tree tree;
    const ViewOptions options = small_picture();
    const SketchView camera = camera_for(tree.mesh.positions, options);
    SurfaceView view(tree.drawn(), camera, options);
    view.draw();
    const Mask by_gl = compute_silhouette(view.picture());
    const PolygonMesh polygons = to_polygons(tree.mesh);
    const RenderOptions traced{.camera = options.camera, .ground = false, .transparent = true};
    const Mask by_rays = compute_silhouette(render({.mesh = &polygons, .view = &camera}, traced));
    const auto area = static_cast<double>(std::ranges::count(by_rays.inside, std::uint8_t{1}));
    EXPECT_GT(area, 2000);
    EXPECT_NEAR(static_cast<double>(std::ranges::count(by_gl.inside, std::uint8_t{1})), area, 0.03 * area);
    const Overlap overlap(by_gl, by_rays);
    EXPECT_LT(overlap.one, 0.05 * overlap.both);
}

TEST_F(SurfaceViewTest, IsBitIdenticalInASecondRun) {
    const Tree tree;
    const auto drawn = [&] {
        SurfaceView view(tree.drawn(), camera_for(tree.mesh.positions, small_picture()), small_picture());
        view.draw();
        return view.picture();
    };
    const Image once = drawn();
    EXPECT_EQ(once, drawn());
    EXPECT_EQ(once.at(0, 0)[3], 255);
}

TEST_F(SurfaceViewTest, LightIsFromAbove) {
    // A square on the ground, seen from above and from below.
    const std::vector<Vec3> positions{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const std::vector<Vec3> up(4, Vec3{0, 0, 1});
    const std::vector<Triangle> triangles{{0, 1, 2}, {0, 2, 3}};
    const auto brightness_from = [&](float elevation) {
        const std::vector<Vec3d> points(positions.begin(), positions.end());
        const SketchView camera = frame_view(points, {.width = 64, .height = 64, .elevation = elevation});
        SurfaceView view({positions, up, triangles}, camera, {.camera = {.width = 64, .height = 64}});
        view.draw();
        const Image::Pixel p = view.picture().at(32, 32);
        return p[0] + p[1] + p[2];
    };
    EXPECT_GT(brightness_from(1.2f), 1.5 * brightness_from(-1.2f));
}

TEST_F(SurfaceViewTest, DrawsWrittenVertices) {
    const Tree tree;
    const SketchView camera = camera_for(tree.mesh.positions, small_picture());
    SurfaceView view(tree.drawn(), camera, small_picture());
    view.draw();
    const Image before = view.picture();
    // The first half of the vertices is moved into the root.
    const std::size_t half = tree.mesh.positions.size() / 2;
    const std::vector<Vec3> sunk(half);
    write_vertices(view.buffers(), sunk, std::span(tree.normals).first(half));
    view.draw();
    EXPECT_NE(view.picture(), before);
    write_vertices(view.buffers(), std::span(tree.mesh.positions).first(half),
                   std::span(tree.normals).first(half));
    view.draw();
    EXPECT_EQ(view.picture(), before);
}

TEST_F(SurfaceViewTest, WithoutSmoothingHasFewerShades) {
    const Tree tree;
    const auto shades = [&](int smoothing) {
        const ViewOptions options{.camera = {.width = 160, .height = 120}, .smoothing = smoothing};
        SurfaceView view(tree.drawn(), camera_for(tree.mesh.positions, options), options);
        view.draw();
        auto pixels = view.picture().pixels;
        std::ranges::sort(pixels);
        return std::unique(pixels.begin(), pixels.end()) - pixels.begin();
    };
    EXPECT_LT(shades(1), shades(4));
}

TEST(OffscreenContextTest, ReportsWhyOpenGlIsMissing) {
    const std::string missing = test::missing_gl();
    if (missing.empty()) {
        const OffscreenContext context;
        EXPECT_FALSE(context.renderer().empty());
        EXPECT_FALSE(context.version().empty());
    } else {
        EXPECT_TRUE(missing.starts_with("OpenGL is not available: ")) << missing;
    }
}

}  // namespace
}  // namespace coppice
