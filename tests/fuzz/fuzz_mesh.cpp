// Feeds arbitrary bytes to every mesh reader: the first byte selects the format, the rest is the file. A
// reader returns a mesh with valid indices and finite coordinates, or throws coppice::Error.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "coppice/base/error.h"
#include "coppice/io_mesh/reader.h"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

void check(const coppice::MeshFile& file) {
    const coppice::PolygonMesh& mesh = file.mesh;
    for (const coppice::VertexAttribute& a : file.attributes)
        require(a.values.size() == mesh.positions.size());
    require(mesh.face_count() > 0 && mesh.first.back() == mesh.corners.size() && is_finite(mesh.origin));
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) require(mesh.face(f).size() >= 3);
    for (const std::uint32_t v : mesh.corners) require(v < mesh.positions.size());
    for (const coppice::Vec3 p : mesh.positions) require(is_finite(p));
    require(mesh.texture.empty() || mesh.texture.size() == mesh.corners.size());
    for (const coppice::TexturePoint t : mesh.texture) require(std::isfinite(t.u) && std::isfinite(t.v));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        const std::array<std::string, 2> attributes{"order", "radius"};
        check(coppice::parse_mesh_file(bytes, static_cast<coppice::MeshFormat>(data[0] % 6), "input",
                                       attributes));
    } catch (const coppice::Error&) {  // expected for an invalid file
    }
    return 0;
}
