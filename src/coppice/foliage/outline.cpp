#include <algorithm>
#include <cmath>
#include <numbers>

#include "coppice/base/sort.h"
#include "coppice/foliage/outline_internal.h"

namespace coppice::foliage_internal {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kMaxAngle = 0.88f * kPi;  // of the margin of palmate blades from the midrib

/// Returns the factor of the distance from the midrib due to pinnate lobes: 1 at their ends, and at the tip.
float compute_lobe_factor(const LeafShape& shape, float t) {
    if (shape.lobes != LeafLobes::pinnate) return 1;
    // Sinuses are narrower than lobes, by the power of the cosine, and shallow at the tip.
    const float phase = 2 * kPi * (static_cast<float>(shape.lobe_count) + 0.5f) * t;
    const float depth = shape.lobe_depth * (1 - 0.6f * t * t * t * t);
    return 1 - depth * std::pow(0.5f + 0.5f * std::cos(phase), 1.3f);
}

/// Returns the height of the margin at t in [-0.5, 0.5] of the depth of the teeth, with a mean of 0.
float compute_tooth(const LeafShape& shape, float t) {
    const auto saw = [](float x) {
        constexpr float kRise = 0.75f;
        const float f = x - std::floor(x);
        return (f < kRise ? f / kRise : (1 - f) / (1 - kRise)) - 0.5f;
    };
    const float x = t * static_cast<float>(shape.teeth);
    switch (shape.margin) {
        case LeafMargin::entire:
            return 0;
        case LeafMargin::serrate:
            return saw(x);
        case LeafMargin::double_serrate:
            return 0.7f * saw(x) + 0.3f * saw(3 * x);
        case LeafMargin::crenate:
            return std::abs(std::sin(kPi * x)) - 2 / kPi;
    }
    return 0;
}

/// Returns the distance of the margin of one lobe from the end of the petiole, at an angle from the midrib of
/// the lobe. The lobe has a length and a half-width; its half-width per length along it decreases, so that
/// every angle meets its margin once.
float compute_lobe_reach(const OutlineExponents& e, float length, float half_width, float angle) {
    if (angle >= kPi / 2) return 0;
    const float slope = std::tan(angle);
    float low = 0, high = 1;
    for (int i = 0; i < 24; ++i) {
        const float t = 0.5f * (low + high);
        (half_width * compute_half_width(e, t) > slope * length * t ? low : high) = t;
    }
    return length * low / std::cos(angle);
}

/// Returns the distance of the margin of a palmate blade of length 1 from the end of the petiole.
float compute_palmate_reach(const LeafShape& shape, float angle) {
    const std::vector<float> lobes = find_lobe_angles(shape);
    const OutlineExponents e{.base = 0.55f, .tip = shape.tip_exponent > 0 ? shape.tip_exponent : 0.6f};
    const float half_width = 0.27f * (1.3f - shape.lobe_depth);
    constexpr float kSharp = 7;  // of the smooth maximum
    float sum = 0;
    for (const float lobe : lobes) {
        for (const float side : {1.0f, -1.0f}) {
            if (lobe == 0 && side < 0) continue;
            const float length = 1 - 0.42f * std::pow(lobe / kMaxAngle, 1.3f);
            sum += std::pow(compute_lobe_reach(e, length, half_width, std::abs(angle - side * lobe)), kSharp);
        }
    }
    const float last = lobes.back();
    const float behind = std::max(0.0f, (angle - last) / (kMaxAngle - last));
    const float web = (1 - shape.lobe_depth) * (1 - 0.42f * std::pow(angle / kMaxAngle, 1.3f)) *
                      std::sqrt(std::max(0.0f, 1 - behind * behind));
    return std::pow(sum + std::pow(web, kSharp), 1 / kSharp);
}

std::vector<BladeRow> make_palmate_rows(const LeafShape& shape, const std::vector<float>& ts) {
    std::vector<BladeRow> rows;
    float widest = 1e-6f;
    for (const float t : ts) {
        const float angle = kMaxAngle * (1 - t);
        const float reach = t == 0 ? 0 : compute_palmate_reach(shape, angle);
        rows.push_back({t, {}, {reach * std::sin(angle), reach * std::cos(angle)}});
        widest = std::max(widest, rows.back().outer.x);
    }
    const float along = shape.length / rows.back().outer.y;
    for (BladeRow& row : rows) {
        row.outer.x *= 0.5f * shape.width / widest;
        row.outer.y *= along;
    }
    rows.back().outer.x = 0;
    return rows;
}

/// Returns the row at t of a blade with a midrib; its inner end is below its outer end by the angle of veins.
BladeRow make_midrib_row(const LeafShape& shape, const OutlineExponents& e, float t) {
    const float width = compute_half_width(e, t), across = 0.5f * shape.width * width;
    const float behind = e.heart * width * std::pow(1 - t, 6.0f);
    const float inner = t * shape.length - across / std::tan(shape.vein_angle);
    return {t, {0, std::max(inner, 0.0f)}, {across, (t - behind) * shape.length}};
}

std::vector<BladeRow> make_midrib_rows(const LeafShape& shape, const std::vector<float>& ts) {
    const OutlineExponents e = find_exponents(shape);
    std::vector<BladeRow> rows;
    for (const float t : ts) {
        BladeRow row = make_midrib_row(shape, e, t);
        if (!rows.empty()) row.inner.y = std::max(row.inner.y, rows.back().inner.y);
        rows.push_back(row);
    }
    for (BladeRow& row : rows)
        row.outer = row.inner + (row.outer - row.inner) * compute_lobe_factor(shape, row.t);
    return rows;
}

/// Moves the margin along the rows.
void add_teeth(const LeafShape& shape, std::vector<BladeRow>& rows) {
    for (BladeRow& row : rows) {
        const Point2 across = row.outer - row.inner;
        const float reach = std::hypot(across.x, across.y);
        const float fade = std::min(1.0f, reach / (0.2f * shape.width));
        if (reach < 1e-6f * shape.length || row.t >= 1) continue;
        const float height = compute_tooth(shape, row.t) * shape.tooth_depth * shape.length * fade;
        row.outer = row.outer + across * (std::max(height, -0.5f * reach) / reach);
    }
}

/// Returns the parameters of the rows: closer to each other at the ends of a blade, where its width changes
/// most, or at the valleys and peaks of its teeth.
std::vector<float> choose_parameters(const LeafShape& shape, int count) {
    std::vector<float> ts;
    if (shape.margin != LeafMargin::entire && count >= 2 * shape.teeth) {
        const int per_tooth = count / shape.teeth;
        // The margin turns most in the first tooth.
        for (const float f : {0.0f, 0.04f, 0.15f, 0.4f}) ts.push_back(f / static_cast<float>(shape.teeth));
        for (int i = 0; i < shape.teeth; ++i) {
            if (i > 0) ts.push_back(static_cast<float>(i) / static_cast<float>(shape.teeth));
            for (int k = 1; k < per_tooth; ++k) {
                const float peak = shape.margin == LeafMargin::crenate ? 0.5f : 0.75f;
                const float f = per_tooth == 2 ? peak : static_cast<float>(k) / static_cast<float>(per_tooth);
                ts.push_back((static_cast<float>(i) + f) / static_cast<float>(shape.teeth));
            }
        }
        ts.push_back(1);
        sort_unique(ts);
        return ts;
    }
    const bool even = shape.lobes != LeafLobes::none;
    for (int i = 0; i <= count; ++i) {
        const float x = static_cast<float>(i) / static_cast<float>(count);
        const float eased = 0.5f - 0.5f * std::cos(kPi * x);
        ts.push_back(even ? x : 0.3f * x + 0.7f * eased);
    }
    return ts;
}

}  // namespace

OutlineExponents find_exponents(const LeafShape& shape) {
    constexpr std::array<OutlineExponents, 9> kExponents{{
        {0.75f, 0.75f, 0},     // elliptic
        {0.7f, 1.1f, 0},       // ovate
        {1.2f, 0.6f, 0},       // obovate
        {0.8f, 1.2f, 0},       // lanceolate
        {0.2f, 0.2f, 0},       // linear
        {0.42f, 0.9f, 0.16f},  // cordate
        {0.3f, 1.25f, 0.0f},   // triangular
        {0.75f, 1.5f, 0},      // rhombic
        {0.5f, 0.55f, 0},      // orbicular
    }};
    OutlineExponents out = kExponents[static_cast<std::size_t>(shape.outline)];
    if (shape.base_exponent > 0) out.base = shape.base_exponent;
    if (shape.tip_exponent > 0) out.tip = shape.tip_exponent;
    return out;
}

float compute_half_width(const OutlineExponents& e, float t) {
    if (t <= 0 || t >= 1) return 0;
    const float widest = e.base / (e.base + e.tip);
    return std::pow(t / widest, e.base) * std::pow((1 - t) / (1 - widest), e.tip);
}

std::vector<float> find_lobe_angles(const LeafShape& shape) {
    const int sides = shape.lobe_count / 2;
    const float step = std::min(0.9f, 1.95f / static_cast<float>(std::max(sides, 1)));
    std::vector<float> out;
    for (int i = 0; i <= sides; ++i) out.push_back(step * static_cast<float>(i));
    return out;
}

float find_row_at_angle(float angle) { return 1 - angle / kMaxAngle; }

std::vector<BladeRow> make_rows(const LeafShape& shape, int count) {
    const std::vector<float> ts = choose_parameters(shape, count);
    std::vector<BladeRow> rows =
        shape.lobes == LeafLobes::palmate ? make_palmate_rows(shape, ts) : make_midrib_rows(shape, ts);
    if (shape.margin != LeafMargin::entire && count >= 2 * shape.teeth) add_teeth(shape, rows);
    return rows;
}

}  // namespace coppice::foliage_internal
