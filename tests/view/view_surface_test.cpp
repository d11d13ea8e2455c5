#include "coppice/view/view_surface.h"

#include "coppice/pipeline/mesh_skeleton.h"
#include "errors.h"
#include "view_scenes.h"

namespace coppice {
namespace {

using test::small_picture;

class ViewSurfaceTest : public test::ViewTest {};

TEST_F(ViewSurfaceTest, DrawsASurface) {
    const PolygonMesh mesh = to_polygons(mesh_skeleton(test::small_tree(), {.levels = 1}).quads().mesh);
    const ViewResult result = view_surface(mesh, small_picture());
    EXPECT_EQ(result.picture.width, 320);
    EXPECT_EQ(result.picture.height, 240);
    EXPECT_NE(result.picture.at(160, 120), result.picture.at(0, 0));
    EXPECT_FALSE(result.renderer.empty());
}

TEST_F(ViewSurfaceTest, RejectsAnOptionOutOfRange) {
    ViewOptions options = small_picture();
    options.smoothing = 0;
    EXPECT_EQ(test::error_of([&] { view_surface({}, options); }),
              "view: smoothing must be between 1 and 16, but is 0");
}

}  // namespace
}  // namespace coppice
