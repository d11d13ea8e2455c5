#pragma once

#include <string>

#include "coppice/mesh/mesh.h"
#include "coppice/render/image.h"
#include "coppice/view/view_options.h"

namespace coppice {

/// The image of a surface.
struct ViewResult {
    Image picture;         ///< of the surface
    std::string renderer;  ///< name of the OpenGL renderer
    std::string opengl;    ///< version of OpenGL
};

/// Draws a surface with all of it in view. Throws InvalidInput if an option is out of range, and Unsupported
/// if OpenGL is not available.
ViewResult view_surface(const PolygonMesh& mesh, const ViewOptions& options);

}  // namespace coppice
