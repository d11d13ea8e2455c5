#pragma once

#include <filesystem>
#include <optional>

#include "coppice/base/context.h"
#include "coppice/mesh/solid_mesh.h"

namespace coppice {

/// File format of tetrahedra.
enum class SolidFormat {
    vtu,  ///< VTK unstructured grid as XML, binary; ParaView
    msh,  ///< Gmsh 2.2, binary
};

/// Returns the format by the extension of the name; nullopt for other extensions.
std::optional<SolidFormat> solid_format_of_name(const std::filesystem::path& path);

/// Writes tetrahedra in the format of the extension, with coordinates as doubles including the origin; the
/// file is written atomically (`AtomicFile`). VTU keeps the order of the vertices; Gmsh numbers vertices and
/// tetrahedra from 1, all in entity 1.
///
/// The result does not depend on the number of threads. Throws `IoError` if the file cannot be written;
/// `Unsupported` for an unknown extension; `InvalidInput` without tetrahedra; `Cancelled`.
void write_solid(const std::filesystem::path& path, const SolidMesh& solid, const Context& ctx = {});

}  // namespace coppice
