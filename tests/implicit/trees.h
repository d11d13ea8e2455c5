#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/implicit/solid/solid.h"

namespace coppice {

/// A solid and its field, computed independently from textbook formulas in double precision.
struct Twin {
    Solid solid;
    std::function<double(Vec3d)> field;
};

inline double wyvill(double distance, const PrimitiveOptions& o) {
    const bool soft = o.law == FieldLaw::soft;
    const double ends = soft ? 2 : 1 / std::sqrt(1 - std::cbrt(0.5));
    const double influence = o.influence > 0 ? o.influence : o.radius * ends;
    const auto f = [&](double d) {
        const double x = d / influence;
        if (x >= 1) return 0.0;
        // The published coefficients, not the factors used by the library.
        if (soft) return -4.0 / 9 * std::pow(x, 6) + 17.0 / 9 * std::pow(x, 4) - 22.0 / 9 * x * x + 1;
        return std::pow(1 - x * x, 3);
    };
    return 0.5 * f(distance) / f(o.radius);
}

inline double segment_distance(Vec3d p, Vec3d a, Vec3d b) {
    const double t = std::clamp(dot(p - a, b - a) / length_squared(b - a), 0.0, 1.0);
    return distance(p, lerp(a, b, t));
}

/// Distance from a solid of revolution given by the outline (radius, height) of its half section; the first
/// and last corners are on the axis.
inline double outline_distance(double rho, double z, const std::vector<std::array<double, 2>>& outline) {
    double least = 1e300;
    bool inside = false;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const auto [ax, ay] = outline[i];
        const auto [bx, by] = outline[(i + 1) % outline.size()];
        least = std::min(least, segment_distance({rho, z, 0}, {ax, ay, 0}, {bx, by, 1e-300}));
        if ((ay > z) != (by > z) && rho < ax + (z - ay) / (by - ay) * (bx - ax)) inside = !inside;
    }
    return inside ? 0 : least;
}

/// One primitive of each kind, with small numbers.
inline std::vector<Twin> primitive_twins(FieldLaw law = FieldLaw::cube) {
    std::vector<Twin> out;
    const auto add = [&](Solid solid, PrimitiveOptions o, std::function<double(Vec3d)> away) {
        out.push_back({std::move(solid), [o, away](Vec3d p) { return wyvill(away(p), o); }});
    };
    const PrimitiveOptions plain{.radius = 0.5f, .law = law},
        wide{.radius = 0.5f, .influence = 2, .law = law},
        tight{.radius = 0.4f, .influence = 0.5f, .law = law};
    add(sphere({1, 0, 0}, plain), plain, [](Vec3d p) { return length(p - Vec3d{1, 0, 0}); });
    add(line({0, 0, -1}, {1, 0, 1}, wide), wide, [](Vec3d p) {
        return segment_distance(p, {0, 0, -1}, {1, 0, 1});
    });
    add(circle({0, 0, 0.25f}, {0, 0, 2}, 1, plain), plain,
        [](Vec3d p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z - 0.25); });
    add(disc({0, 0.5f, 0}, {0, 1, 0}, 1, tight), tight,
        [](Vec3d p) { return std::hypot(std::max(std::hypot(p.x, p.z) - 1, 0.0), p.y - 0.5); });
    add(box({{-1, -0.5f, 0}, {0.5f, 0.5f, 1}}, plain), plain, [](Vec3d p) {
        const Vec3d q{std::clamp(p.x, -1.0, 0.5), std::clamp(p.y, -0.5, 0.5), std::clamp(p.z, 0.0, 1.0)};
        return distance(p, q);
    });
    add(cylinder({-1, 0, 0}, {1, 0, 0}, 0.5f, wide), wide, [](Vec3d p) {
        return std::hypot(std::max(std::hypot(p.y, p.z) - 0.5, 0.0), std::max(std::abs(p.x) - 1, 0.0));
    });
    add(cone({0, 0, -1}, {0, 0, 1}, 1, 0.25f, plain), plain, [](Vec3d p) {
        return outline_distance(std::hypot(p.x, p.y), p.z, {{0, -1}, {1, -1}, {0.25, 1}, {0, 1}});
    });
    add(cone({0, 0, -1}, {0, 0, 1}, 0, 1, plain), plain, [](Vec3d p) {
        return outline_distance(std::hypot(p.x, p.y), p.z, {{0, -1}, {1, 1}, {0, 1}});
    });
    const std::vector<Vec3> bends{{-1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 0, 1}};
    add(polyline(bends, false, plain), plain, [bends](Vec3d p) {
        double least = 1e300;
        for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
            least = std::min(least, segment_distance(p, Vec3d(bends[i]), Vec3d(bends[i + 1])));
        }
        return least;
    });
    const std::vector<Vec3> ell{{0, 0, 0}, {1, 0, 0}, {1, 0.4f, 0}, {0.4f, 0.4f, 0}, {0.4f, 1, 0}, {0, 1, 0}};
    add(polygon(ell, plain), plain, [](Vec3d p) {
        const bool inside = p.x > 0 && p.y > 0 && ((p.x < 1 && p.y < 0.4) || (p.x < 0.4 && p.y < 1));
        if (inside) return std::abs(p.z);
        const Vec3d a[] = {{0, 0, 0}, {1, 0, 0}, {1, 0.4, 0}, {0.4, 0.4, 0}, {0.4, 1, 0}, {0, 1, 0}};
        double least = 1e300;
        for (int i = 0; i < 6; ++i) least = std::min(least, segment_distance(p, a[i], a[(i + 1) % 6]));
        return least;
    });
    return out;
}

/// A ball as a closed shape: an exact signed distance.
class BallShape final : public Shape {
  public:
    BallShape(Vec3 center, float radius) : center_(center), radius_(radius) {}
    Box3 bounds() const override { return capsule_box(center_, center_, radius_); }
    bool is_closed() const override { return true; }
    void distance(std::span<const Vec3> points, std::span<FieldSample> out) const override {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3 d = points[i] - center_;
            out[i] = {length(d) - radius_, normalized(d)};
        }
    }

  private:
    Vec3 center_;
    float radius_;
};

/// Creates random trees.
class TreeMaker {
  public:
    explicit TreeMaker(std::uint64_t seed) : random_(seed, 17) {}

    /// `depth` levels of combinations, maps and warps above the primitives.
    Twin tree(int depth) {
        if (depth == 0) return leaf();
        switch (pick(8)) {
            case 0:
                return mapped(tree(depth - 1));
            case 1:
                return warped(tree(depth - 1));
            default:
                return combined(depth);
        }
    }

    double uniform(double low, double high) { return random_.uniform(next_++, low, high); }
    int pick(int count) { return static_cast<int>(uniform(0, count)); }
    Vec3 point(double reach) {
        return Vec3(Vec3d{uniform(-reach, reach), uniform(-reach, reach), uniform(-reach, reach)});
    }
    Vec3 direction() {
        const Vec3 p = point(1);
        return length(p) > 0.1f ? normalized(p) : Vec3{0, 0, 1};
    }

    Twin mapped(const Twin& t) {
        const Vec3 by = point(2), axis = direction();
        const auto angle = static_cast<float>(uniform(-3, 3));
        const Vec3 factors(Vec3d{uniform(0.6, 1.5), uniform(0.6, 1.5), uniform(0.6, 1.5)});
        const Solid solid = translated(rotated(scaled(t.solid, factors), axis, angle), by);
        return {
            solid, [t, by, axis, angle, factors](Vec3d p) {
                p = Affine::rotation(Vec3d(axis) / length(Vec3d(axis)), -double(angle)).point(p - Vec3d(by));
                return t.field({p.x / factors.x, p.y / factors.y, p.z / factors.z});
            }};
    }

    Twin warped(const Twin& t) {
        switch (pick(3)) {
            case 0: {
                const auto rate = static_cast<float>(uniform(-0.5, 0.5));
                return {twisted(t.solid, {0.5f, 0, 0}, {0, 0, 3}, rate), [t, rate](Vec3d p) {
                            const double a = -double(rate) * p.z, x = p.x - 0.5;
                            return t.field({0.5 + std::cos(a) * x - std::sin(a) * p.y,
                                            std::sin(a) * x + std::cos(a) * p.y, p.z});
                        }};
            }
            case 1: {
                const auto factor = static_cast<float>(uniform(0.5, 2));
                return {tapered(t.solid, {0, 0, -1}, {0, 0, 2}, factor), [t, factor](Vec3d p) {
                            const double s = 1 + (double(factor) - 1) * std::clamp((p.z + 1) / 3, 0.0, 1.0);
                            return t.field({p.x / s, p.y / s, p.z});
                        }};
            }
            default:
                return bent_twin(t, static_cast<float>(uniform(0.2, 1.2)));
        }
    }

    /// Bends from z = -h up, towards x, as gradually as the solid's size requires.
    static Twin bent_twin(const Twin& t, float angle) {
        const Box3 b = t.solid.bounds();
        const float reach = b.empty() ? 1 : std::max(b.high.x, 0.5f);
        const float h = 1.1f * reach * angle;
        const Solid solid = bent(t.solid, {0, 0, 0}, {0, 0, h}, {1, 0, 0}, angle);
        return {solid, [t, h, angle](Vec3d p) {
                    const double radius = double(h) / angle;
                    double phi = std::atan2(p.z, radius - p.x);
                    if (phi < angle / 2 - std::numbers::pi) phi += 2 * std::numbers::pi;
                    if (phi < 0) return t.field(p);
                    const double r = std::hypot(p.z, radius - p.x);
                    if (phi < angle) return t.field({radius - r, p.y, phi * radius});
                    return t.field({radius - r * std::cos(phi - angle), p.y, h + r * std::sin(phi - angle)});
                }};
    }

  private:
    Twin leaf() {
        static const std::vector<Twin> kPrimitives = primitive_twins();
        return mapped(kPrimitives[static_cast<std::size_t>(pick(static_cast<int>(kPrimitives.size())))]);
    }

    Twin combined(int depth) {
        std::vector<Twin> parts;
        std::vector<Solid> solids;
        const int count = 2 + pick(2);
        for (int i = 0; i < count; ++i) {
            parts.push_back(tree(depth - 1));
            solids.push_back(parts.back().solid);
        }
        const auto fold = [parts](auto rule) {
            return [parts, rule](Vec3d p) {
                double value = parts[0].field(p);
                for (std::size_t i = 1; i < parts.size(); ++i) value = rule(value, parts[i].field(p));
                return value;
            };
        };
        switch (pick(6)) {
            case 0:
                return {unite(solids), fold([](double a, double b) { return std::max(a, b); })};
            case 1:
                return {intersect(solids), fold([](double a, double b) { return std::min(a, b); })};
            case 2:
                return {subtract(solids[0], std::span(solids).subspan(1)),
                        fold([](double a, double b) { return std::max(0.0, std::min(a, 1 - b)); })};
            case 3: {
                const auto n = static_cast<float>(uniform(1, 9));
                return {ricci_blend(solids, n), fold([n](double a, double b) {
                            const double m = std::max(a, b);
                            return m > 0
                                       ? m * std::pow(std::pow(a / m, n) + std::pow(b / m, n), 1 / double(n))
                                       : 0;
                        })};
            }
            default:
                return {blend(solids), fold([](double a, double b) { return a + b; })};
        }
    }

    CounterRandom random_;
    std::uint64_t next_ = 0;
};

/// Points in and around a box, in short rows so that batches are coherent.
inline std::vector<Vec3> random_points_in(Box3 box, int count, std::uint64_t seed = 3) {
    if (box.empty()) box = {{-1, -1, -1}, {1, 1, 1}};
    const CounterRandom random(seed, 5);
    std::vector<Vec3> out;
    const Vec3 size = box.size();
    for (std::uint64_t i = 0; static_cast<int>(i) < count; ++i) {
        out.push_back(box.low + Vec3{size.x * float(random.uniform(3 * i, -0.1, 1.1)),
                                     size.y * float(random.uniform(3 * i + 1, -0.1, 1.1)),
                                     size.z * float(random.uniform(3 * i + 2, -0.1, 1.1))});
    }
    return out;
}

}  // namespace coppice
