#include "coppice/foliage/organ_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/base/random.h"
#include "coppice/foliage/organ_builder_internal.h"

namespace coppice {
namespace {

using namespace foliage_internal;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kGolden = 2.39996f;  // [rad] 137.508 degrees [Vogel1979]

/// Makes the parts of one cluster.
class ClusterBuilder {
  public:
    ClusterBuilder(const OrganShape& shape, int variant)
        : s_(shape), random_(0x0f10e5, static_cast<std::uint64_t>(variant)) {}

    void build() {
        if (s_.cluster != OrganCluster::single && s_.axis_length > 0)
            stalks_.add_tube({}, {0, s_.axis_length, 0}, 1.5f * s_.stalk_width);
        for (int k = 0; k < s_.count; ++k) add_member(k);
    }

    std::vector<OrganPart> take(std::uint32_t material) {
        std::vector<OrganPart> out;
        if (!main_.empty()) out.push_back({main_.take(material), s_.color, s_.other_color});
        if (!details_.empty()) out.push_back({details_.take(material), s_.detail_color, s_.detail_color});
        if (!stalks_.empty()) out.push_back({stalks_.take(kLeafMaterial), s_.stalk_color, s_.stalk_color});
        return out;
    }

  private:
    float draw(float low, float high) {
        return static_cast<float>(random_.uniform(next_++, double{low}, double{high}));
    }

    /// A stalk of a cluster.
    struct Stalk {
        float from = 0;    ///< [m] along the axis
        float angle = 0;   ///< [rad] to the axis
        float length = 0;  ///< [m]
    };

    Stalk find_stalk(float f) const {
        const float axis = s_.axis_length;
        switch (s_.cluster) {
            case OrganCluster::single:
                break;
            case OrganCluster::umbel:
                return {axis, s_.spread * std::sqrt(f), s_.stalk_length};
            case OrganCluster::corymb: {
                const float from = axis * f, angle = s_.spread * (1 - 0.8f * f);
                return {from, angle, (axis + s_.stalk_length - from) / std::cos(angle)};
            }
            case OrganCluster::raceme:
                return {axis * (0.12f + 0.88f * f), s_.spread * (1 - 0.5f * f * f * f),
                        s_.stalk_length * (1 - 0.75f * f)};
        }
        return {0, 0, s_.stalk_length};
    }

    void add_member(int k) {
        const Stalk stalk = find_stalk((static_cast<float>(k) + 0.5f) / static_cast<float>(s_.count));
        const float angle = stalk.angle * draw(0.85f, 1.15f), azimuth = kGolden * static_cast<float>(k);
        const Vec3 along{std::sin(angle) * std::cos(azimuth), std::cos(angle),
                         std::sin(angle) * std::sin(azimuth)};
        const Vec3 from{0, stalk.from, 0}, end = from + along * (stalk.length * draw(0.85f, 1.1f));
        stalks_.add_tube(from, end, s_.stalk_width);
        const OrganFrame frame = make_organ_frame(end, along);
        const float size = draw(0.88f, 1.08f);
        switch (s_.form) {
            case OrganForm::flower:
                return add_flower(frame, size);
            case OrganForm::berry:
                return add_berry(frame, size);
            case OrganForm::nut:
                return add_nut(frame, size);
            case OrganForm::burr:
                return add_burr(frame, size);
            case OrganForm::samara:
                return add_samara(frame, size);
            case OrganForm::cone:
                return add_cone(frame, size);
        }
    }

    void add_flower(const OrganFrame& frame, float size) {
        const float turn = draw(0, 2 * kPi), length = s_.length * size;
        for (int w = 0; w < s_.whorls; ++w) {
            const float inner = static_cast<float>(w) / static_cast<float>(s_.whorls);
            for (int k = 0; k < s_.petals; ++k) {
                const float step = 2 * kPi / static_cast<float>(s_.petals);
                const float azimuth = turn + step * (static_cast<float>(k) + 0.5f * static_cast<float>(w));
                add_petal(frame, azimuth + draw(-0.12f, 0.12f), length * (1 - 0.45f * inner),
                          s_.opening * (1 - 0.75f * inner) * draw(0.88f, 1.12f));
            }
        }
        const float base = 0.14f * length;
        stalks_.add_revolution(
            frame, {{0, -1.6f * base}, {0.8f * base, -0.6f * base}, {base, 0.1f * base}, {0, 0.15f * base}},
            5);
        for (int k = 0; k < s_.stamens; ++k) add_stamen(frame, kGolden * static_cast<float>(k), length);
    }

    void add_petal(const OrganFrame& frame, float azimuth, float length, float opening) {
        static constexpr std::array<float, 5> kRows{0.0f, 0.3f, 0.6f, 0.85f, 1.0f};
        static constexpr std::array<float, 5> kWidths{0.14f, 0.68f, 1.0f, 0.92f, 0.5f};
        const Vec3 radial = frame.around(azimuth), side = cross(frame.along, radial);
        const float half = 0.5f * s_.width * length / s_.length;
        std::vector<std::vector<Vec3>> rows;
        Vec3 p = frame.origin;
        float before = 0;
        for (std::size_t i = 0; i < kRows.size(); ++i) {
            const float angle = opening * (0.65f + 0.5f * kRows[i]);
            const Vec3 way = frame.along * std::cos(angle) + radial * std::sin(angle);
            const Vec3 up = frame.along * std::sin(angle) - radial * std::cos(angle);
            p = p + way * ((kRows[i] - before) * length);
            before = kRows[i];
            const float w = half * kWidths[i];
            const Vec3 raised = up * (0.22f * w),
                       notch = i + 1 == kRows.size() ? way * (-0.06f * length) : Vec3{};
            rows.push_back({p + side * w + raised, p + notch, p - side * w + raised});
        }
        main_.add_rows(rows);
    }

    void add_stamen(const OrganFrame& frame, float azimuth, float petal) {
        const float angle = 0.75f * std::sqrt(draw(0, 1)), length = petal * draw(0.4f, 0.6f);
        const Vec3 way = frame.along * std::cos(angle) + frame.around(azimuth) * std::sin(angle);
        const OrganFrame tip = make_organ_frame(frame.origin + way * (0.9f * length), way);
        details_.add_spine(make_organ_frame(frame.origin, way), 0.05f * petal, length);
        details_.add_revolution(tip, {{0, 0}, {0.045f * petal, 0.05f * petal}, {0, 0.1f * petal}}, 3);
    }

    /// Returns the profile of a round fruit between two hollows.
    std::vector<Point2> make_profile(float length, float width, float hollow, int rings) const {
        std::vector<Point2> out;
        for (int i = 0; i <= rings; ++i) {
            const float f = static_cast<float>(i) / static_cast<float>(rings);
            const float r = i == 0 || i == rings ? 0 : std::sin(kPi * f);
            // The shoulders at the stalk are wider than the end.
            const float wide = 1 + 0.6f * hollow * std::cos(kPi * f);
            const float sunk = hollow * length * (1 - r) * (1 - r);
            const float y = 0.5f * length * (1 - std::cos(kPi * f)) + (f < 0.5f ? sunk : -0.6f * sunk);
            out.push_back({0.5f * width * r * wide, y});
        }
        return out;
    }

    static bool is_large(float length) { return length > 0.04f; }

    void add_berry(const OrganFrame& frame, float size) {
        const float length = s_.length * size, width = s_.width * size;
        const bool large = is_large(length);
        OrganFrame sunk = frame;
        sunk.origin = frame.origin - frame.along * (s_.dimple * length);
        main_.add_revolution(sunk, make_profile(length, width, s_.dimple, large ? 12 : 6), large ? 16 : 8);
        if (s_.dimple <= 0) return;
        const float low = length * (1 - 0.75f * s_.dimple);
        for (int k = 0; k < 5; ++k) {
            const float azimuth = 2 * kPi * static_cast<float>(k) / 5;
            details_.add_triangle(sunk.point(0.06f * width, azimuth - 0.6f, low),
                                  sunk.point(0.06f * width, azimuth + 0.6f, low),
                                  sunk.point(0.1f * width, azimuth, low + 0.09f * width));
        }
    }

    void add_nut(const OrganFrame& frame, float size) {
        const float length = s_.length * size, r = 0.5f * s_.width * size;
        std::vector<Point2> body{{0, 0.1f * length}};
        for (int i = 1; i < 7; ++i) {
            const float f = static_cast<float>(i) / 7;
            body.push_back({r * std::pow(std::sin(kPi * f), 0.6f), length * (0.1f + 0.86f * f)});
        }
        body.push_back({0, length});
        main_.add_revolution(frame, body, 9);
        const float c = 1.14f * r, depth = 0.38f * length;
        details_.add_revolution(frame,
                                {{0, 0},
                                 {0.6f * c, 0.06f * depth},
                                 {0.95f * c, 0.45f * depth},
                                 {c, depth},
                                 {0.8f * c, depth},
                                 {0, 0.9f * depth}},
                                9);
    }

    void add_burr(const OrganFrame& frame, float size) {
        const float length = s_.length * size, width = s_.width * size;
        main_.add_revolution(frame, make_profile(length, width, 0, 8), 12);
        const OrganFrame middle{frame.origin + frame.along * (0.5f * length), frame.across, frame.along,
                                frame.up};
        for (int k = 0; k < s_.scales; ++k) {
            const float z = 1 - 2 * (static_cast<float>(k) + 0.5f) / static_cast<float>(s_.scales);
            const Vec3 way =
                middle.around(kGolden * static_cast<float>(k)) * std::sqrt(1 - z * z) + middle.along * z;
            main_.add_spine(make_organ_frame(middle.origin + way * (0.46f * width), way), 0.06f * width,
                            0.2f * width);
        }
    }

    void add_samara(const OrganFrame& frame, float size) {
        // Shares of the length, and of the width above and below the axis.
        static constexpr std::array<std::array<float, 3>, 6> kWing{{{0.1f, 0.1f, 0.1f},
                                                                    {0.35f, 0.22f, 0.2f},
                                                                    {0.6f, 0.3f, 0.55f},
                                                                    {0.82f, 0.28f, 0.68f},
                                                                    {0.95f, 0.16f, 0.5f},
                                                                    {1.0f, 0.0f, 0.2f}}};
        const float length = s_.length * size, width = s_.width * size, turn = draw(0, 2 * kPi);
        for (const float side : {0.0f, kPi}) {
            const Vec3 out = frame.around(turn + side);
            const Vec3 way = frame.along * std::cos(s_.opening) + out * std::sin(s_.opening);
            const Vec3 low = frame.along * std::sin(s_.opening) - out * std::cos(s_.opening);
            const float nut = 0.28f * length;
            main_.add_revolution(make_organ_frame(frame.origin, way),
                                 {{0, 0},
                                  {0.24f * nut, 0.15f * nut},
                                  {0.32f * nut, 0.5f * nut},
                                  {0.2f * nut, 0.85f * nut},
                                  {0, nut}},
                                 6);
            // The upper edge of the wing is straight, the lower one curved.
            std::vector<std::vector<Vec3>> rows;
            for (const auto& [t, high, deep] : kWing) {
                const Vec3 at = frame.origin + way * (t * length);
                rows.push_back({at - low * (high * width), at + low * (deep * width)});
            }
            main_.add_rows(rows);
        }
    }

    float find_cone_radius(float t) const {
        const bool slim = s_.length > 2.2f * s_.width;
        const float a = slim ? 0.2f : 0.42f, b = slim ? 0.32f : 0.85f, peak = a / (a + b);
        return std::pow(t / peak, a) * std::pow((1 - t) / (1 - peak), b);
    }

    void add_cone(const OrganFrame& frame, float size) {
        const float length = s_.length * size, radius = 0.5f * s_.width * size;
        std::vector<Point2> core{{0, 0}};
        for (const float t : {0.04f, 0.2f, 0.45f, 0.7f, 0.93f})
            core.push_back({0.8f * radius * find_cone_radius(t), t * length});
        core.push_back({0, 0.98f * length});
        main_.add_revolution(frame, core, 7);
        // Scales overlap: each is higher than the distance to the next one above it.
        const float area = 2 * kPi * radius * length * 0.8f / static_cast<float>(s_.scales);
        const float side = 1.5f * std::sqrt(area);
        for (int k = 0; k < s_.scales; ++k) {
            const float t = (static_cast<float>(k) + 0.5f) / static_cast<float>(s_.scales);
            const float r = radius * find_cone_radius(t), azimuth = kGolden * static_cast<float>(k);
            const float scale = side * std::clamp(1.3f * find_cone_radius(t), 0.35f, 1.0f);
            add_scale(frame, azimuth, r, t * length - 0.3f * scale, scale);
        }
    }

    /// Adds a rhombic scale with a raised middle; the opening lifts its tip.
    void add_scale(const OrganFrame& frame, float azimuth, float r, float height, float scale) {
        const float half = 0.5f * scale / std::max(r, 0.3f * scale), lifted = 0.45f * scale * s_.opening;
        const Vec3 low = frame.point(0.78f * r, azimuth, height);
        const Vec3 left = frame.point(0.9f * r + 0.3f * lifted, azimuth + half, height + 0.55f * scale);
        const Vec3 right = frame.point(0.9f * r + 0.3f * lifted, azimuth - half, height + 0.55f * scale);
        const Vec3 top = frame.point(0.88f * r + lifted, azimuth, height + scale);
        const Vec3 middle = frame.point(r + 0.12f * scale + 0.6f * lifted, azimuth, height + 0.68f * scale);
        main_.add_rows({{low}, {left, middle, right}, {top}});
    }

    const OrganShape& s_;
    CounterRandom random_;
    std::uint64_t next_ = 0;
    OrganBuilder main_, details_, stalks_;
};

void check(const OrganShape& s) {
    const auto is_positive = [](float x) { return x > 0 && x < 100; };
    if (!is_positive(s.length) || !is_positive(s.width) || !is_positive(s.stalk_width))
        throw InvalidInput("organ: length, width and stalk_width must be positive and below 100 m");
    if (!(s.axis_length >= 0) || !(s.stalk_length >= 0) || !(s.spread >= 0 && s.spread <= 1.5f))
        throw InvalidInput("organ: axis_length and stalk_length must not be negative, spread in [0, 1.5]");
    constexpr int kMax = 1000;
    if (s.count < 1 || s.count > kMax || s.petals < 1 || s.petals > kMax || s.whorls < 1 || s.whorls > kMax ||
        s.stamens < 0 || s.stamens > kMax || s.scales < 0 || s.scales > kMax)
        throw InvalidInput(fmt::format("organ: numbers of parts must be at most {}", kMax));
}

}  // namespace

std::vector<OrganPart> make_organ(const OrganShape& shape, std::uint32_t material, int variant) {
    check(shape);
    ClusterBuilder builder(shape, variant);
    builder.build();
    return builder.take(material);
}

}  // namespace coppice
