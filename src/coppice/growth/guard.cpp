#include "coppice/growth/guard.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"

namespace coppice {
namespace {

constexpr int kCorrections = 12;
constexpr float kMargin = 0.01f;          // margin that a step keeps, relative to its length
constexpr float kSegmentMargin = 0.002f;  // the same for segments that are only checked

float part(int sample) { return static_cast<float>(sample + 1) / Guard::kSamples; }

}  // namespace

Guard::Guard(FieldRef field, const GuardOptions& options) : field_(field), options_(options) {
    check_fields(options, "guard");
}

Guard::Clearance Guard::compute_clearance(const FieldSample& sample) const {
    const float slope = length(sample.gradient);
    const Vec3 outward = slope > 0 ? sample.gradient * (-1 / slope) : Vec3{};
    const float steep = std::max(slope, 1e-12f);
    const bool outside = options_.side == GuardSide::outside;
    const float beyond = outside ? field_.level() - sample.value : sample.value - field_.level();
    const Vec3 away = outside ? outward : -outward;
    Clearance nearest{beyond / steep - options_.clearance, away};
    if (options_.shell > 0) {
        const float left = (options_.shell - beyond) / steep;
        if (left < nearest.distance) nearest = {left, -away};
    }
    // A field value of NaN is treated as excluded.
    return std::isnan(nearest.distance) ? Clearance{-Guard::kSamples, {}} : nearest;
}

Guard::Samples Guard::samples(Vec3 a, Vec3 b) const {
    std::array<Vec3, kSamples> at;
    std::array<FieldSample, kSamples> value;
    for (int i = 0; i < kSamples; ++i) at[i] = lerp(a, b, part(i));
    field_.sample(0, at, value);
    Samples out;
    for (int i = 0; i < kSamples; ++i) out[i] = compute_clearance(value[i]);
    return out;
}

bool Guard::allows(Vec3 p) const {
    FieldSample value;
    field_.sample(0, {&p, 1}, {&value, 1});
    return compute_clearance(value).distance > 0;
}

bool Guard::allows_segment(Vec3 a, Vec3 b) const {
    const float margin = kSegmentMargin * distance(a, b);
    const Samples all = samples(a, b);
    return allows(a) && std::ranges::all_of(all, [&](const Clearance& r) { return r.distance > margin; });
}

std::optional<Vec3> Guard::step(Vec3 from, Vec3 direction, float length) const {
    const float margin = kMargin * length;
    Vec3 end = from + direction * length;
    for (int attempt = 0; attempt <= kCorrections; ++attempt) {
        const Samples all = samples(from, end);
        int worst = 0;
        float lacking = 0;
        for (int i = 0; i < kSamples; ++i) {
            // The start may be closer than the margin, as roots are, so the margin is required gradually.
            const float l = margin * part(i) - all[i].distance;
            if (l >= lacking) {
                lacking = l;
                worst = i;
            }
        }
        if (lacking <= 0 && all[worst].distance > 0) return end;
        const float push = std::min(1.2f * lacking / part(worst) + 0.1f * margin, length);
        const Vec3 way = end + all[worst].away * push - from;
        end = from + normalized(way, direction) * length;
    }
    return std::nullopt;
}

void list_fields(GuardOptions& o, FieldList& list) {
    list.add(Field{"guard_side", "Side of the guarding solid on which branches stay."}, o.side);
    list.add(Field{"guard_shell", "Maximum difference from the iso value on that side; 0 means unlimited.",
                   Unit::none, 0, 1e6},
             o.shell);
    list.add(
        Field{"guard_clearance", "Minimum distance of axes from the guarding surface.", Unit::metre, 0, 1e4},
        o.clearance);
}

}  // namespace coppice
