#include "coppice/mesh/face_view.h"

#include "coppice/base/number_set.h"

namespace coppice {

PolygonMesh some_faces(const FaceView& mesh, std::span<const std::uint32_t> faces) {
    NumberSet used(mesh.positions().size());
    for (const std::uint32_t f : faces) {
        for (const std::uint32_t v : mesh.face(f)) used.add(v);
    }
    used.count();
    PolygonMesh part;
    for (const std::uint32_t v : used.ascending()) part.positions.push_back(mesh.positions()[v]);
    for (const std::uint32_t f : faces) {
        for (const std::uint32_t v : mesh.face(f)) part.corners.push_back(used.rank(v));
        part.first.push_back(static_cast<std::uint32_t>(part.corners.size()));
    }
    return part;
}

}  // namespace coppice
