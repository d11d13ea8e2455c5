#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "coppice/implicit/solid/solid.h"
#include "coppice/implicit/solid/solid_field.h"

namespace coppice {

enum class StepKind : std::uint8_t {
    point,
    segment,
    circle,
    cylinder,
    box,
    cone,
    polyline,
    polygon,
    shape,
    max,
    min,
    difference,
    sum,
    ricci,
    twist,
    taper,
    bend
};

/// One node of a solid in prefix order: its descendants follow it, up to `end`.
struct SolidStep {
    StepKind kind = StepKind::point;
    std::uint32_t end = 0;
    std::uint32_t data = 0;  ///< of primitives and warps: index
    float exponent = 1;      ///< ricci
    Box3 support;            ///< in the coordinates of the nearest enclosing warp, otherwise of space
};

/// Row-major 3 x 4 matrix.
using Rows = std::array<float, 12>;

/// A skeleton in coordinates in which its influence ends at distance 1 (shapes keep their own coordinates).
struct PrimitiveStep {
    Rows rows;  ///< from the coordinates of the nearest enclosing warp
    float weight;
    float share = 0;                     ///< parameter of the law, see law_share
    float a = 0, b = 0, c = 0;           ///< as SolidNode::size, scaled
    std::uint32_t first = 0, count = 0;  ///< of `edges`
    const Shape* shape = nullptr;
    float influence = 1;  ///< shapes [m]
};

/// The map from the outer coordinates to the warp's frame, and the warp's parameters.
struct WarpStep {
    Rows rows;
    float height = 0,
          rate = 0;  ///< twist: rate; taper: 1 / height and factor - 1; bend: height and angle / height
    float angle = 0, cosine = 1, sine = 0;   ///< bend
    float end_shift_x = 0, end_shift_z = 0;  ///< bend: (1 - cos) / curvature and sin / curvature
};

/// An edge of a polyline or polygon, from a by d.
struct EdgeStep {
    float ax, ay, az, dx, dy, dz, inverse_length_squared;
};

struct SolidProgram {
    std::vector<SolidStep> steps;  ///< empty if the field is 0 everywhere
    std::vector<PrimitiveStep> primitives;
    std::vector<WarpStep> warps;
    std::vector<EdgeStep> edges;
    std::vector<Box3> edge_boxes;  ///< of every kEdgeGroup edges of a polyline, enlarged by the influence; by
                                   ///< first / kEdgeGroup
    std::vector<std::shared_ptr<const Shape>> shapes;  ///< keeps the shapes alive
    std::size_t scratch = 0;  ///< [rows of kBlock floats] required by the deepest path
};

constexpr std::size_t kSolidBlock = 64;  ///< number of points that are evaluated together
constexpr std::uint32_t kEdgeGroup = 16;

/// Rows of scratch memory that a step uses while its descendants run.
constexpr std::size_t kCombineRows = 4;
constexpr std::size_t kWarpRows = 6;
constexpr std::size_t kShapeRows = 7;

void run_samples(const SolidProgram& program, std::span<const Vec3> points, std::span<FieldSample> out);
void run_values(const SolidProgram& program, std::span<const Vec3> points, std::span<float> out);
void run_ranges(const SolidProgram& program, std::span<const Box3> boxes, std::span<ValueRange> out);

}  // namespace coppice
