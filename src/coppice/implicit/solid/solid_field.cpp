#include "coppice/implicit/solid/solid_field.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/implicit/solid/solid_internal.h"
#include "coppice/implicit/solid/solid_program_internal.h"
#include "coppice/spatial/box_tree.h"

namespace coppice {
namespace {

/// Parts of a union or sum beyond this number are grouped by position, so that whole groups can be skipped.
constexpr std::size_t kGroup = 8;

Rows to_rows(const Affine& m, double scale = 1) {
    const auto f = [&](double v) { return static_cast<float>(v * scale); };
    return {f(m.x.x), f(m.y.x),      f(m.z.x), f(m.origin.x), f(m.x.y), f(m.y.y),
            f(m.z.y), f(m.origin.y), f(m.x.z), f(m.y.z),      f(m.z.z), f(m.origin.z)};
}

StepKind combination(SolidKind kind) {
    switch (kind) {
        case SolidKind::unite:
            return StepKind::max;
        case SolidKind::intersect:
            return StepKind::min;
        case SolidKind::blend:
            return StepKind::sum;
        default:
            return StepKind::ricci;
    }
}

StepKind primitive_kind(SolidKind kind) {
    switch (kind) {
        case SolidKind::sphere:
            return StepKind::point;
        case SolidKind::line:
            return StepKind::segment;
        case SolidKind::circle:
            return StepKind::circle;
        case SolidKind::box:
            return StepKind::box;
        case SolidKind::cone:
            return StepKind::cone;
        case SolidKind::polyline:
            return StepKind::polyline;
        case SolidKind::polygon:
            return StepKind::polygon;
        case SolidKind::shape:
            return StepKind::shape;
        default:
            return StepKind::cylinder;  // a disc is a cylinder of height 0
    }
}

class Compiler {
  public:
    explicit Compiler(SolidProgram& program) : program_(program) {}

    /// Appends the solid, transformed by `map` to the coordinates of the nearest enclosing warp, unless its
    /// support is empty.
    void add(const Solid& solid, const Affine& map) {
        const SolidNode& node = solid.node();
        if (node.kind == SolidKind::transform) return add(node.parts.front(), map * node.map);
        const Box3 support = compute_box(solid, map, 0);
        if (support.empty()) return;
        switch (node.kind) {
            case SolidKind::unite:
            case SolidKind::blend:
            case SolidKind::ricci:
                return add_grouped(node, map);
            case SolidKind::intersect:
            case SolidKind::subtract:
                return add_ordered(node, map, support);
            case SolidKind::twist:
            case SolidKind::taper:
            case SolidKind::bend:
                return add_warp(node, map, support);
            default:
                add_primitive(node, map, support);
        }
    }

  private:
    struct Placed {
        const Solid* solid;
        Box3 support;
    };

    SolidStep& open(StepKind kind, const Box3& support, std::size_t rows) {
        rows_ += rows;
        program_.scratch = std::max(program_.scratch, rows_);
        SolidStep& step = program_.steps.emplace_back();
        step.kind = kind;
        step.support = support;
        return step;
    }
    void close(std::size_t step, std::size_t rows) {
        rows_ -= rows;
        program_.steps[step].end = static_cast<std::uint32_t>(program_.steps.size());
    }

    void add_ordered(const SolidNode& node, const Affine& map, const Box3& support) {
        const std::size_t step = program_.steps.size();
        open(node.kind == SolidKind::intersect ? StepKind::min : StepKind::difference, support, kCombineRows);
        for (const Solid& part : node.parts) add(part, map);
        close(step, kCombineRows);
    }

    void add_grouped(const SolidNode& node, const Affine& map) {
        std::vector<Placed> parts;
        collect(node, map, parts);
        if (parts.size() > kGroup) {
            std::vector<Box3> boxes;
            for (const Placed& p : parts) boxes.push_back(p.support);
            const BoxTree order(boxes, {.threads = 1});
            std::vector<Placed> sorted;
            for (std::uint32_t i = 0; i < order.size(); ++i) sorted.push_back(parts[order.item(i)]);
            parts = std::move(sorted);
        }
        add_group(node, map, parts);
    }

    void collect(const SolidNode& node, const Affine& map, std::vector<Placed>& out) {
        for (const Solid& part : node.parts) {
            const Box3 support = compute_box(part, map, 0);
            if (!support.empty()) out.push_back({&part, support});
        }
    }

    void add_group(const SolidNode& node, const Affine& map, std::span<const Placed> parts) {
        if (parts.size() == 1) return add(*parts.front().solid, map);
        Box3 support;
        for (const Placed& p : parts) support.extend(p.support);
        const std::size_t step = program_.steps.size();
        open(combination(node.kind), support, kCombineRows).exponent = static_cast<float>(node.size.x);
        std::size_t size = 1;
        while (size * kGroup < parts.size()) size *= kGroup;
        for (std::size_t i = 0; i < parts.size(); i += size) {
            add_group(node, map, parts.subspan(i, std::min(size, parts.size() - i)));
        }
        close(step, kCombineRows);
    }

    void add_warp(const SolidNode& node, const Affine& map, const Box3& support) {
        const std::size_t step = program_.steps.size();
        const StepKind kind = node.kind == SolidKind::twist   ? StepKind::twist
                              : node.kind == SolidKind::taper ? StepKind::taper
                                                              : StepKind::bend;
        open(kind, support, kWarpRows).data = static_cast<std::uint32_t>(program_.warps.size());
        WarpStep& warp = program_.warps.emplace_back();
        warp.rows = to_rows((map * node.map).inverse());
        if (kind == StepKind::twist) {
            warp.rate = static_cast<float>(node.size.x);
        } else if (kind == StepKind::taper) {
            warp.height = static_cast<float>(1 / node.size.x);
            warp.rate = static_cast<float>(node.size.y - 1);
        } else {
            const double curvature = node.size.y / node.size.x, half = std::sin(node.size.y / 2);
            warp.height = static_cast<float>(node.size.x);
            warp.rate = static_cast<float>(curvature);
            warp.angle = static_cast<float>(node.size.y);
            warp.cosine = static_cast<float>(std::cos(node.size.y));
            warp.sine = static_cast<float>(std::sin(node.size.y));
            warp.end_shift_x = static_cast<float>(2 * half * half / curvature);
            warp.end_shift_z = static_cast<float>(std::sin(node.size.y) / curvature);
        }
        add(node.parts.front(), node.map.inverse());
        close(step, kWarpRows);
    }

    void add_primitive(const SolidNode& node, const Affine& map, const Box3& support) {
        const std::size_t step = program_.steps.size();
        const StepKind kind = primitive_kind(node.kind);
        const std::size_t rows = kind == StepKind::shape ? kShapeRows : 0;
        open(kind, support, rows).data = static_cast<std::uint32_t>(program_.primitives.size());
        PrimitiveStep& p = program_.primitives.emplace_back();
        const double scale = kind == StepKind::shape ? 1 : 1 / node.influence;
        p.rows = to_rows((map * node.map).inverse(), scale);
        p.weight = static_cast<float>(node.weight);
        p.share = static_cast<float>(law_share(node.law));
        p.a = static_cast<float>(node.size.x * scale);
        p.b = static_cast<float>(node.size.y * scale);
        p.c = static_cast<float>(node.size.z * scale);
        if (kind == StepKind::shape) {
            program_.shapes.push_back(node.shape);
            p.shape = node.shape.get();
            p.influence = static_cast<float>(node.influence);
        }
        if (!node.points.empty()) {
            const bool closed = node.closed || kind == StepKind::polygon;
            add_edges(p, node.points, closed, scale);
        }
        close(step, rows);
    }

    void add_edges(PrimitiveStep& p, std::span<const Vec3d> points, bool closed, double scale) {
        // Groups of edges belong to one primitive.
        program_.edges.resize((program_.edges.size() + kEdgeGroup - 1) / kEdgeGroup * kEdgeGroup);
        program_.edge_boxes.resize(program_.edges.size() / kEdgeGroup);
        p.first = static_cast<std::uint32_t>(program_.edges.size());
        p.count = static_cast<std::uint32_t>(points.size() - (closed ? 0 : 1));
        for (std::size_t i = 0; i < p.count; ++i) {
            const Vec3 a(points[i] * scale), b(points[(i + 1) % points.size()] * scale);
            const Vec3d d = Vec3d(b) - Vec3d(a);
            // Exact ends, so that adjacent edges meet without a gap.
            program_.edges.push_back({a.x, a.y, a.z, static_cast<float>(d.x), static_cast<float>(d.y),
                                      static_cast<float>(d.z),
                                      static_cast<float>(1 / std::max(length_squared(d), 1e-30))});
            if (i % kEdgeGroup == 0) program_.edge_boxes.emplace_back();
            program_.edge_boxes.back().extend(capsule_box(a, b, 1.001f));
        }
    }

    SolidProgram& program_;
    std::size_t rows_ = 0;
};

}  // namespace

SolidField::SolidField(const Solid& solid)
    : solid_(solid), bounds_(solid.bounds()), surface_bounds_(solid.surface_bounds()) {
    SolidProgram program;
    Compiler(program).add(solid, Affine{});
    program_ = std::make_shared<const SolidProgram>(std::move(program));
}

void SolidField::sample(std::uint32_t, std::span<const Vec3> points, std::span<FieldSample> out) const {
    COPPICE_ASSERT(points.size() == out.size());
    run_samples(*program_, points, out);
}

void SolidField::values(std::span<const Vec3> points, std::span<float> out) const {
    COPPICE_ASSERT(points.size() == out.size());
    run_values(*program_, points, out);
}

void SolidField::ranges(std::span<const Box3> boxes, std::span<ValueRange> out) const {
    COPPICE_ASSERT(boxes.size() == out.size());
    run_ranges(*program_, boxes, out);
}

}  // namespace coppice
