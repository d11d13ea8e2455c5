#pragma once

#include <filesystem>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/mesh/solid_mesh.h"

namespace coppice {

/// What kind of file tetrahedra are written to.
enum class SolidFormat {
    vtu,  ///< VTK's unstructured grid as XML, binary; ParaView
    msh,  ///< Gmsh 2.2, binary
};

/// The format of a name; none for another extension.
std::optional<SolidFormat> solid_format_of_name(const std::filesystem::path& path);

/// Writes tetrahedra as the extension of the name says, coordinates as doubles with the origin added; the
/// file appears whole or not at all (`AtomicFile`). VTU keeps the vertices' order; Gmsh numbers vertices and
/// tetrahedra from 1, all in entity 1.
///
/// Same bytes for any number of threads. Throws `IoError` for trouble with the file; `Unsupported` for a name
/// of no known kind; `InvalidInput` without tetrahedra; `Cancelled`.
void write_solid(const std::filesystem::path& path, const SolidMesh& solid, const Context& ctx = {});

}  // namespace coppice
