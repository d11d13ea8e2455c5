#include "coppice/view/view_surface.h"

#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/mesh/normals.h"
#include "coppice/render/frame_view.h"
#include "coppice/view/surface_view.h"

namespace coppice {

ViewResult view_surface(const PolygonMesh& mesh, const ViewOptions& options) {
    check_fields(options, "view");
    const TriMesh triangles = triangulate(mesh);
    const Buffer<Vec3> normals = smooth_normals(triangles);
    const std::vector<Vec3d> points(triangles.positions.begin(), triangles.positions.end());
    SurfaceView view({triangles.positions, normals, triangles.triangles}, frame_view(points, options.camera),
                     options);
    view.draw();
    return {view.picture(), view.context().renderer(), view.context().version()};
}

}  // namespace coppice
