#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/implicit/solid/solid_program_internal.h"

// Vectors with a size known only at run time cannot be members of a struct; such machines use NEON or scalar
// code. The other targets are disabled because they run this code no faster than their predecessors, and
// increase the compile time.
#define HWY_DISABLED_TARGETS \
    (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
// Scalar code if there are no vectors; their emulation takes clang minutes to compile, and gcc 12 cannot
// compile it.
#define HWY_BROKEN_EMU128 1
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "coppice/implicit/solid/solid_simd.cpp"
#include <hwy/foreach_target.h>  // includes this file once per instruction set
#include <hwy/highway.h>

#include "coppice/implicit/solid/solid_skeletons_internal.h"
#include "coppice/implicit/solid/solid_vector_internal.h"
#include "coppice/implicit/solid/solid_warps_internal.h"

HWY_BEFORE_NAMESPACE();

namespace coppice::HWY_NAMESPACE {

/// Requested results for the points of a block; the value is the number of rows of kSolidBlock numbers.
enum class Want : std::size_t { value = 1, range = 2, sample = 4 };

template <Want W>
class Evaluator {
  public:
    static constexpr std::size_t kRows = static_cast<std::size_t>(W);

    explicit Evaluator(const SolidProgram& program) : program_(program) {}

    /// Writes the field of step i to `out`; returns false, without writing, if it is 0 at all points.
    bool run(std::uint32_t i, const Block& at, float* HWY_RESTRICT out, float* HWY_RESTRICT scratch) const {
        const SolidStep& step = program_.steps[i];
        if (!step.support.overlaps(at.box)) return false;
        switch (step.kind) {
            case StepKind::max:
            case StepKind::sum:
            case StepKind::ricci:
                return gather(i, at, out, scratch);
            case StepKind::min:
                return intersect(i, at, out, scratch);
            case StepKind::difference:
                return subtract(i, at, out, scratch);
            case StepKind::twist:
            case StepKind::taper:
            case StepKind::bend:
                return warp(i, at, out, scratch);
            default:
                primitive(step, at, out, scratch);
                return true;
        }
    }

  private:
    bool gather(std::uint32_t i, const Block& at, float* HWY_RESTRICT out,
                float* HWY_RESTRICT scratch) const {
        const SolidStep& step = program_.steps[i];
        bool any = false;
        for (std::uint32_t child = i + 1; child < step.end; child = program_.steps[child].end) {
            if (!any) {
                any = run(child, at, out, scratch);
            } else if (run(child, at, scratch, scratch + kCombineRows * kSolidBlock)) {
                combine(step, out, scratch);
            }
        }
        return any;
    }

    bool intersect(std::uint32_t i, const Block& at, float* HWY_RESTRICT out,
                   float* HWY_RESTRICT scratch) const {
        const SolidStep& step = program_.steps[i];
        if (!run(i + 1, at, out, scratch)) return false;
        for (std::uint32_t child = program_.steps[i + 1].end; child < step.end;
             child = program_.steps[child].end) {
            if (!run(child, at, scratch, scratch + kCombineRows * kSolidBlock)) return false;
            combine(step, out, scratch);
        }
        return true;
    }

    bool subtract(std::uint32_t i, const Block& at, float* HWY_RESTRICT out,
                  float* HWY_RESTRICT scratch) const {
        const SolidStep& step = program_.steps[i];
        if (!run(i + 1, at, out, scratch)) return false;
        // The value is limited to 1 even if no part is subtracted.
        clear(scratch);
        combine(step, out, scratch);
        for (std::uint32_t child = program_.steps[i + 1].end; child < step.end;
             child = program_.steps[child].end) {
            if (run(child, at, scratch, scratch + kCombineRows * kSolidBlock)) combine(step, out, scratch);
        }
        return true;
    }

    bool warp(std::uint32_t i, const Block& at, float* HWY_RESTRICT out, float* HWY_RESTRICT scratch) const {
        const SolidStep& step = program_.steps[i];
        const WarpStep& w = program_.warps[step.data];
        if (i + 1 == step.end) return false;
        Block bent{scratch, {}};
        switch (step.kind) {
            case StepKind::twist:
                warp_block<Twist>(w, at, bent);
                break;
            case StepKind::taper:
                warp_block<Taper>(w, at, bent);
                break;
            default:
                warp_block<Bend>(w, at, bent);
        }
        if (!run(i + 1, bent, out, scratch + kWarpRows * kSolidBlock)) return false;
        if constexpr (W == Want::sample) pull_back(step.kind, w, bent, out);
        return true;
    }

    template <class Warp>
    HWY_NOINLINE void warp_block(const WarpStep& w, const Block& at, Block& bent) const {
        const Warp map(w);
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            if constexpr (W == Want::range) {
                map.ranges(at, bent, k);
            } else {
                map.points(at, bent, k);
            }
        }
        bent.find_box(W == Want::range);
    }

    HWY_NOINLINE void pull_back(StepKind kind, const WarpStep& w, const Block& bent,
                                float* HWY_RESTRICT out) const {
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            Point g = load_point(out + kSolidBlock, k);
            if (kind == StepKind::twist) {
                g = Twist(w).pull_back(bent, k, g);
            } else if (kind == StepKind::taper) {
                g = Taper(w).pull_back(bent, k, g);
            } else {
                g = Bend(w).pull_back(bent, k, g);
            }
            store_point(back_through(w.rows, g), out + kSolidBlock, k);
        }
    }

    HWY_INLINE void clear(float* HWY_RESTRICT out) const { std::fill_n(out, kRows * kSolidBlock, 0.0f); }

    void combine(const SolidStep& step, float* HWY_RESTRICT out, const float* HWY_RESTRICT other) const {
        switch (step.kind) {
            case StepKind::max:
                return combine_all(Greatest(), out, other);
            case StepKind::min:
                return combine_all(Least(), out, other);
            case StepKind::difference:
                return combine_all(Difference(), out, other);
            case StepKind::sum:
                return combine_all(Sum(), out, other);
            default:
                return combine_all(Ricci(step.exponent), out, other);
        }
    }

    template <class Rule>
    HWY_NOINLINE void combine_all(const Rule& rule, float* HWY_RESTRICT out,
                                  const float* HWY_RESTRICT other) const {
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            if constexpr (W == Want::sample) {
                Sample a = load_sample(out, k);
                rule.sample(a, load_sample(other, k));
                store_sample(a, out, k);
            } else if constexpr (W == Want::range) {
                const V low = load(other, k), high = load(other + kSolidBlock, k);
                // A difference decreases if the subtracted value increases.
                store(rule.value(load(out, k), Rule::kFalls ? high : low), out, k);
                store(rule.value(load(out + kSolidBlock, k), Rule::kFalls ? low : high), out + kSolidBlock,
                      k);
            } else {
                store(rule.value(load(out, k), load(other, k)), out, k);
            }
        }
    }

    void primitive(const SolidStep& step, const Block& at, float* HWY_RESTRICT out,
                   float* HWY_RESTRICT scratch) const {
        const PrimitiveStep& p = program_.primitives[step.data];
        switch (step.kind) {
            case StepKind::point:
                return skeleton(PointSkeleton(), p, at, out);
            case StepKind::segment:
                return skeleton(SegmentSkeleton(p), p, at, out);
            case StepKind::circle:
                return skeleton(CircleSkeleton(p), p, at, out);
            case StepKind::cylinder:
                return skeleton(CylinderSkeleton(p), p, at, out);
            case StepKind::box:
                return skeleton(BoxSkeleton(p), p, at, out);
            case StepKind::cone:
                return skeleton(ConeSkeleton(p), p, at, out);
            case StepKind::polyline:
                return polyline(p, at, out);
            case StepKind::polygon:
                return skeleton(PolygonSkeleton(p, program_.edges.data()), p, at, out);
            default:
                return shape(p, at, out, scratch);
        }
    }

    template <class Skeleton>
    HWY_NOINLINE void skeleton(const Skeleton& distance, const PrimitiveStep& p, const Block& at,
                               float* HWY_RESTRICT out) const {
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            write(p, at, k, distance(through(p.rows, load_point(at.rows, k))), out);
        }
    }

    /// Evaluates only the groups of edges near the block.
    HWY_NOINLINE void polyline(const PrimitiveStep& p, const Block& at, float* HWY_RESTRICT out) const {
        Box3 near;
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            const Point q = through(p.rows, load_point(at.rows, k));
            Point h{zero(), zero(), zero()};
            if constexpr (W == Want::range)
                h = reach_through(p.rows, load_point(at.rows + 3 * kSolidBlock, k));
            extend(near, q, h);
        }
        const std::uint32_t first_group = p.first / kEdgeGroup;
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            const Point q = through(p.rows, load_point(at.rows, k));
            Nearest nearest = nowhere();
            for (std::uint32_t e = 0; e < p.count; e += kEdgeGroup) {
                if (!program_.edge_boxes[first_group + e / kEdgeGroup].overlaps(near)) continue;
                for (std::uint32_t j = e; j < std::min(p.count, e + kEdgeGroup); ++j) {
                    take_nearer(program_.edges[p.first + j], q, nearest);
                }
            }
            write(p, at, k, nearest, out);
        }
    }

    /// Writes the field of the squared distance, and its gradient.
    HWY_INLINE void write(const PrimitiveStep& p, const Block& at, std::size_t k, const Nearest& n,
                          float* HWY_RESTRICT out) const {
        const Falloff law(p);
        if constexpr (W == Want::range) {
            const V reach = ball_through(p.rows, load_point(at.rows + 3 * kSolidBlock, k));
            const V d = hn::Sqrt(n.squared);
            const V nearest = hn::Max(hn::Sub(d, reach), zero()), farthest = hn::Add(d, reach);
            store_range(law.value(hn::Mul(farthest, farthest)), law.value(hn::Mul(nearest, nearest)), out, k);
        } else {
            store(law.value(n.squared), out, k);
            if constexpr (W == Want::sample) {
                const V slope = law.slope(n.squared);
                const Point g = back_through(p.rows, n.away);
                const auto inside = hn::Lt(n.squared, splat(1.0f));
                store_point({hn::IfThenElseZero(inside, hn::Mul(slope, g.x)),
                             hn::IfThenElseZero(inside, hn::Mul(slope, g.y)),
                             hn::IfThenElseZero(inside, hn::Mul(slope, g.z))},
                            out + kSolidBlock, k);
            }
        }
    }

    HWY_NOINLINE void shape(const PrimitiveStep& p, const Block& at, float* HWY_RESTRICT out,
                            float* HWY_RESTRICT scratch) const {
        auto* points = reinterpret_cast<Vec3*>(scratch);
        auto* samples = reinterpret_cast<FieldSample*>(scratch + 3 * kSolidBlock);
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            const Point q = through(p.rows, load_point(at.rows, k));
            hn::StoreInterleaved3(q.x, q.y, q.z, Tag(), scratch + 3 * k);
        }
        p.shape->distance(std::span(points, kSolidBlock), std::span(samples, kSolidBlock));
        const Box3 support = p.shape->bounds().inflated(p.influence);
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) write_shape(p, at, k, support, scratch, out);
    }

    /// Writes the field of a shape from points and distances in `scratch`.
    HWY_INLINE void write_shape(const PrimitiveStep& p, const Block& at, std::size_t k, const Box3& support,
                                const float* HWY_RESTRICT scratch, float* HWY_RESTRICT out) const {
        const bool closed = p.shape->is_closed();
        const V per_influence = splat(1 / p.influence);
        Point q, g;
        V d;
        hn::LoadInterleaved3(Tag(), scratch + 3 * k, q.x, q.y, q.z);
        hn::LoadInterleaved4(Tag(), scratch + (3 * kSolidBlock + 4 * k), d, g.x, g.y, g.z);
        d = hn::Mul(d, per_influence);
        if constexpr (W == Want::range) {
            const V steepness = splat(std::min(p.shape->steepness(), 1e18f));
            const V reach = hn::Mul(hn::Mul(steepness, per_influence),
                                    ball_through(p.rows, load_point(at.rows + 3 * kSolidBlock, k)));
            store_range(shape_falloff(closed, p, hn::Add(d, reach)),
                        shape_falloff(closed, p, hn::Sub(d, reach)), out, k);
        } else {
            // The field ends at the support's box even if the distance is not a true one.
            const auto inside = hn::And(contains(support, q), hn::Lt(d, splat(1.0f)));
            store(hn::IfThenElseZero(inside, shape_falloff(closed, p, d)), out, k);
            if constexpr (W == Want::sample) {
                const V slope = hn::IfThenElseZero(inside, hn::Mul(per_influence, shape_slope(closed, p, d)));
                g = back_through(p.rows, g);
                store_point({hn::Mul(slope, g.x), hn::Mul(slope, g.y), hn::Mul(slope, g.z)},
                            out + kSolidBlock, k);
            }
        }
    }

    const SolidProgram& program_;
};

/// Rows of numbers, aligned for vectors.
class BlockRows {
  public:
    explicit BlockRows(std::size_t rows) : store_(rows * kSolidBlock + kAlign) {
        const auto address = reinterpret_cast<std::uintptr_t>(store_.data());
        start_ =
            store_.data() + (kAlign * sizeof(float) - address % (kAlign * sizeof(float))) / sizeof(float);
    }
    float* row(std::size_t i) { return start_ + i * kSolidBlock; }

  private:
    static constexpr std::size_t kAlign = 16;
    std::vector<float> store_;
    float* start_;
};

constexpr std::size_t kPointRows = 6;
constexpr std::size_t kOutRows = 4;

/// Converts points to rows; the last one fills up the block. Points that are not finite or extremely far are
/// moved to where all fields are 0.
HWY_INLINE void load_block(std::span<const Vec3> points, Block& at) {
    const std::size_t count = points.size();
    Vec3 padded[kSolidBlock];
    if (count < kSolidBlock) {
        std::copy_n(points.data(), count, padded);
        std::fill(padded + count, padded + kSolidBlock, points.back());
    }
    const float* in = count < kSolidBlock ? &padded[0].x : &points[0].x;
    for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
        Point p;
        hn::LoadInterleaved3(Tag(), in + 3 * k, p.x, p.y, p.z);
        store_point({near_or_far(p.x), near_or_far(p.y), near_or_far(p.z)}, at.rows, k);
    }
    at.find_box(false);
}

void compute_samples(const SolidProgram& program, std::span<const Vec3> points, std::span<FieldSample> out) {
    static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(FieldSample) == 4 * sizeof(float));
    BlockRows rows(kPointRows + kOutRows + program.scratch);
    const Evaluator<Want::sample> evaluator(program);
    for (std::size_t i = 0; i < points.size(); i += kSolidBlock) {
        const std::size_t count = std::min(kSolidBlock, points.size() - i);
        Block at{rows.row(0), {}};
        load_block(points.subspan(i, count), at);
        float* result = rows.row(kPointRows);
        if (!evaluator.run(0, at, result, rows.row(kPointRows + kOutRows))) {
            std::fill_n(out.data() + i, count, FieldSample{});
            continue;
        }
        FieldSample padded[kSolidBlock];
        float* to = count < kSolidBlock ? &padded[0].value : &out[i].value;
        for (std::size_t k = 0; k < kSolidBlock; k += kLanes) {
            const Sample s = load_sample(result, k);
            hn::StoreInterleaved4(s.value, s.gradient.x, s.gradient.y, s.gradient.z, Tag(), to + 4 * k);
        }
        if (count < kSolidBlock) std::copy_n(padded, count, out.data() + i);
    }
}

void compute_values(const SolidProgram& program, std::span<const Vec3> points, std::span<float> out) {
    BlockRows rows(kPointRows + kOutRows + program.scratch);
    const Evaluator<Want::value> evaluator(program);
    for (std::size_t i = 0; i < points.size(); i += kSolidBlock) {
        const std::size_t count = std::min(kSolidBlock, points.size() - i);
        Block at{rows.row(0), {}};
        load_block(points.subspan(i, count), at);
        float* result = rows.row(kPointRows);
        if (evaluator.run(0, at, result, rows.row(kPointRows + kOutRows))) {
            std::copy_n(result, count, out.data() + i);
        } else {
            std::fill_n(out.data() + i, count, 0.0f);
        }
    }
}

void compute_ranges(const SolidProgram& program, std::span<const Box3> boxes, std::span<ValueRange> out) {
    BlockRows rows(kPointRows + kOutRows + program.scratch);
    const Evaluator<Want::range> evaluator(program);
    for (std::size_t i = 0; i < boxes.size(); i += kSolidBlock) {
        const std::size_t count = std::min(kSolidBlock, boxes.size() - i);
        Block at{rows.row(0), {}};
        for (std::size_t k = 0; k < kSolidBlock; ++k) {
            const Box3& b = boxes[i + std::min(k, count - 1)];
            const Vec3 center = b.center();
            for (int axis = 0; axis < 3; ++axis) {
                // The centre is rounded; the box must still contain both ends.
                const float half = std::max(b.high[axis] - center[axis], center[axis] - b.low[axis]);
                rows.row(static_cast<std::size_t>(axis))[k] = std::clamp(center[axis], -kFar, kFar);
                rows.row(static_cast<std::size_t>(axis) + 3)[k] = std::min(1.000001f * half, kFar);
            }
        }
        at.find_box(true);
        const float* result = rows.row(kPointRows);
        if (!evaluator.run(0, at, rows.row(kPointRows), rows.row(kPointRows + kOutRows))) {
            std::fill_n(out.data() + i, count, ValueRange{0, 0});
            continue;
        }
        for (std::size_t k = 0; k < count; ++k) out[i + k] = {result[k], result[kSolidBlock + k]};
    }
}

}  // namespace coppice::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace coppice {

HWY_EXPORT(compute_samples);
HWY_EXPORT(compute_values);
HWY_EXPORT(compute_ranges);

void run_samples(const SolidProgram& program, std::span<const Vec3> points, std::span<FieldSample> out) {
    if (program.steps.empty()) return std::fill(out.begin(), out.end(), FieldSample{});
    HWY_DYNAMIC_DISPATCH(compute_samples)(program, points, out);
}

void run_values(const SolidProgram& program, std::span<const Vec3> points, std::span<float> out) {
    if (program.steps.empty()) return std::fill(out.begin(), out.end(), 0.0f);
    HWY_DYNAMIC_DISPATCH(compute_values)(program, points, out);
}

void run_ranges(const SolidProgram& program, std::span<const Box3> boxes, std::span<ValueRange> out) {
    if (program.steps.empty()) return std::fill(out.begin(), out.end(), ValueRange{0, 0});
    HWY_DYNAMIC_DISPATCH(compute_ranges)(program, boxes, out);
}

}  // namespace coppice

#endif
