// A custom field: any type with an iso value and samples can be polygonized as a closed surface.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <span>

#include "coppice/implicit/field_ref.h"
#include "coppice/implicit/polygonize/polygonize.h"
#include "coppice/mesh/topology.h"

/// A torus about the Z axis: inside, the value is greater than the iso value.
struct Torus {
    float ring = 1, tube = 0.4f;  // [m]

    float level() const { return 0; }

    /// Called from several threads, with many points at a time. This field has no lists, so `region` is
    /// ignored.
    void sample(std::uint32_t, std::span<const coppice::Vec3> points,
                std::span<coppice::FieldSample> out) const {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const coppice::Vec3 p = points[i];
            const float around = std::hypot(p.x, p.y);
            const coppice::Vec3 middle = around > 0
                                             ? coppice::Vec3{p.x * ring / around, p.y * ring / around, 0}
                                             : coppice::Vec3{ring, 0, 0};
            const coppice::Vec3 away = coppice::normalized(p - middle);
            out[i] = {tube - coppice::distance(p, middle), -away};
        }
    }
};

int main() {
    const Torus torus;
    const coppice::Box3 box{{-1.5f, -1.5f, -0.5f}, {1.5f, 1.5f, 0.5f}};
    const coppice::TriMesh mesh = coppice::polygonize(coppice::FieldRef(torus), box, {.cell = 0.05f});

    const coppice::TopologyReport topology = coppice::topology(coppice::to_polygons(mesh));
    std::printf("%zu triangles, closed and manifold: %s\n", mesh.triangles.size(),
                topology.watertight() ? "yes" : "no");
    std::printf("handles: %lld\n", (long long)(1 - topology.euler / 2));
}
