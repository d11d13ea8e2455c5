#include "coppice/render/scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "coppice/base/check_fields.h"
#include "coppice/base/option_fields.h"
#include "coppice/base/parallel.h"
#include "coppice/base/random.h"
#include "coppice/points/sampling/near_mesh.h"
#include "coppice/render/trace/embree_internal.h"

namespace coppice {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kBeamStage = 0x6265616d, kNoiseStage = 0x7363616e;
constexpr std::size_t kGrain = 4096;
constexpr std::size_t kRowsPerBlock = 64;  // between two polls of the stop token
constexpr double kCoarseBeams = 1e5;       // beams of the first scan, over all positions
constexpr double kFewHits = 30;            // sufficient to detect scans that cannot succeed
constexpr double kEnoughHits = 2000;       // sufficient for an estimate within a few per cent
constexpr double kMaxBeams = 1e7, kMaxBeamsPerPoint = 1000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr float kFarthest = 1e15f;  // [m] beyond it squares of floats overflow
constexpr float kCoarseShare = 0.2f;

/// Two independent normal deviates from two uniform ones [Box1958].
struct NormalPair {
    double first, second;
};
NormalPair normal_pair(const CounterRandom& random, std::uint64_t index) {
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform(2 * index)));
    const double angle = 2 * kPi * random.uniform(2 * index + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

Box3 checked_bounds(const PolygonMesh& mesh) {
    Box3 box;
    for (const std::uint32_t v : mesh.corners) {
        const Vec3 p = mesh.positions[v];
        if (!is_finite(p) || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kFarthest) {
            throw InvalidInput(
                fmt::format("scan: vertex {} of the mesh is not finite or farther away than 1e15 m", v));
        }
        box.extend(p);
    }
    if (box.empty()) throw InvalidInput("scan: the mesh has no faces");
    return box;
}

/// [rad] The directions that contain the whole surface: azimuth relative to the direction to the centre, and
/// elevation.
struct Window {
    double left, right, low, high;
    double width() const { return std::max(0.0, right - left); }
    double height() const { return std::max(0.0, high - low); }
};

/// The same during accumulation, in numbers that increase with the angles and need no trigonometric
/// functions: azimuths on the square |x| + |y| = 1, from -2 to 2 for a full turn, and slopes.
struct Extent {
    double left = 2, right = -2, low = kInfinity, high = -kInfinity;

    /// p is relative to the scanner, which looks along x.
    void add(Vec3d p) {
        const double side = p.y / (std::abs(p.x) + std::abs(p.y));
        const double azimuth = p.x >= 0 ? side : std::copysign(2.0, p.y) - side;
        const double slope = p.z / std::sqrt(p.x * p.x + p.y * p.y);
        left = std::min(left, azimuth), right = std::max(right, azimuth);
        low = std::min(low, slope), high = std::max(high, slope);
    }
    void add(const Extent& e) {
        left = std::min(left, e.left), right = std::max(right, e.right);
        low = std::min(low, e.low), high = std::max(high, e.high);
    }
    static double angle(double azimuth) {
        const double side = std::abs(azimuth) <= 1 ? azimuth : std::copysign(2.0, azimuth) - azimuth;
        const double ahead = 1 - std::abs(side);
        return std::atan2(std::copysign(side, azimuth), std::abs(azimuth) <= 1 ? ahead : -ahead);
    }
    Window window() const { return {angle(left), angle(right), std::atan(low), std::atan(high)}; }
};

/// A position of the scanner, relative to the centre of the box; x points to the centre.
struct Station {
    Vec3d place;
    Vec3d ahead, aside;
    Window window{};

    Station(double azimuth, double distance, double height)
        : place{distance * std::cos(azimuth), distance * std::sin(azimuth), height},
          ahead{-std::cos(azimuth), -std::sin(azimuth), 0},
          aside{std::sin(azimuth), -std::cos(azimuth), 0} {}

    Vec3d turned(Vec3d p) const {
        const Vec3d d = p - place;
        return {dot(d, ahead), dot(d, aside), d.z};
    }
    Vec3d direction(double azimuth, double elevation) const {
        const double c = std::cos(elevation);
        return ahead * (c * std::cos(azimuth)) + aside * (c * std::sin(azimuth)) +
               Vec3d{0, 0, std::sin(elevation)};
    }
};

/// Returns the parameter of the extreme slope of an edge between its ends; outside (0, 1) if there is none.
/// It is the zero of the derivative of z over the horizontal distance, of which the quadratic terms cancel.
double extreme_slope(Vec3d a, Vec3d b) {
    const Vec3d d = b - a;
    const double aa = a.x * a.x + a.y * a.y, ad = a.x * d.x + a.y * d.y, dd = d.x * d.x + d.y * d.y;
    const double below = d.z * ad - a.z * dd;
    return below != 0 ? (a.z * ad - d.z * aa) / below : -1;
}

void add_edge(Extent& extent, Vec3d a, Vec3d b) {
    extent.add(a);
    const double t = extreme_slope(a, b);
    if (t > 0 && t < 1) extent.add(lerp(a, b, t));
    // An edge behind the scanner connects the left end of the image to the right one.
    if (a.y * b.y < 0 && (a.x * b.y - b.x * a.y) * (b.y - a.y) < 0) {
        extent.left = -2;
        extent.right = 2;
    }
}

/// The surface relative to the centre of its box, prepared for beams.
class Target {
  public:
    Target(const PolygonMesh& mesh, const Box3& box, const Context& ctx)
        : middle_((Vec3d(box.low) + Vec3d(box.high)) * 0.5), mesh_(triangulate(mesh)) {
        device_ = new_embree_device(ctx);
        scene_.reset(rtcNewScene(device_.get()));
        rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
        const EmbreeGeometry geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE));
        const auto positions = new_embree_buffer<Vec3>(geometry.get(), RTC_BUFFER_TYPE_VERTEX,
                                                       RTC_FORMAT_FLOAT3, mesh_.positions.size());
        const auto triangles = new_embree_buffer<Triangle>(geometry.get(), RTC_BUFFER_TYPE_INDEX,
                                                           RTC_FORMAT_UINT3, mesh_.triangles.size());
        parallel_for(ctx, positions.size(), kGrain, [&](std::size_t i) { positions[i] = Vec3(at(i)); });
        std::ranges::copy(mesh_.triangles, triangles.begin());
        attach_geometry(scene_.get(), geometry.get());
        commit_scene(device_.get(), scene_.get(), ctx);
    }

    Vec3d middle() const { return middle_; }

    Window window(const Station& station, const Context& ctx) const {
        const auto of_range = [&](IndexRange range) {
            Extent e;
            for (std::size_t t = range.begin; t < range.end; ++t) {
                for (std::size_t k = 0; k < 3; ++k) {
                    const Triangle& c = mesh_.triangles[t];
                    add_edge(e, station.turned(at(c[k])), station.turned(at(c[(k + 1) % 3])));
                }
            }
            return e;
        };
        const auto join = [](Extent a, const Extent& b) {
            a.add(b);
            return a;
        };
        return parallel_reduce(ctx, mesh_.triangles.size(), kGrain, Extent{}, of_range, join).window();
    }

    /// Computes the first intersection of a beam, on the triangle in double precision; returns false if there
    /// is none.
    bool first_point(Vec3d from, Vec3d direction, Vec3d& point) const {
        const RTCRayHit r = cast_ray(scene_.get(), Vec3(from), Vec3(direction));
        if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        const Triangle& t = mesh_.triangles[r.hit.primID];
        const double u = r.hit.u, v = r.hit.v;
        point = at(t[0]) * (1 - u - v) + at(t[1]) * u + at(t[2]) * v;
        return true;
    }

  private:
    Vec3d at(std::size_t vertex) const { return Vec3d(mesh_.positions[vertex]) - middle_; }

    Vec3d middle_;
    TriMesh mesh_;
    EmbreeDevice device_;
    EmbreeScene scene_;
};

/// The beams of one station at one step: its window, with random phases.
struct Grid {
    double left, low, step;
    std::size_t columns, rows;

    Grid(const Window& w, double step_, const CounterRandom& random, std::uint64_t station)
        : left(w.left - step_ * random.uniform(2 * station)),
          low(w.low - step_ * random.uniform(2 * station + 1)),
          step(step_),
          columns(static_cast<std::size_t>(find_columns(w, step_))),
          rows(static_cast<std::size_t>(count_rows(w, step_))) {}

    /// One more than fit, because of the phase, but at most one full turn.
    static double find_columns(const Window& w, double step) {
        return std::floor(std::min(w.width() / step + 2, std::max(1.0, 2 * kPi / step)));
    }
    static double count_rows(const Window& w, double step) { return std::floor(w.height() / step + 2); }

    double azimuth(std::size_t column) const { return left + step * static_cast<double>(column); }
    double elevation(std::size_t row) const { return low + step * static_cast<double>(row); }
};

class Scan {
  public:
    Scan(const Target& target, const ScanOptions& options, double base, const Context& ctx)
        : target_(target), options_(options), beams_(static_cast<std::uint64_t>(options.seed), kBeamStage) {
        for (int i = 0; i < options.positions; ++i) {
            stations_.emplace_back(options.azimuth + 2 * kPi * i / options.positions, options.distance,
                                   base + options.height);
            stations_.back().window = target.window(stations_.back(), ctx);
        }
    }

    /// Returns the step at which approximately the requested number of beams meets the surface.
    double step(const Context& ctx) const {
        double area = 0;
        for (const Station& s : stations_) area += s.window.width() * s.window.height();
        if (!(area > 0)) {
            throw InvalidInput("scan: seen from the scanner, the mesh is a line or a point; check its faces");
        }
        double step = checked(std::sqrt(area / kCoarseBeams));
        const double wanted = std::min(kEnoughHits, static_cast<double>(options_.points));
        for (;;) {
            const auto hits = static_cast<double>(count_hits(step, ctx));
            if (hits >= std::min(kFewHits, wanted)) {
                const double fit = checked(step * std::sqrt(hits / options_.points));
                if (hits >= wanted) return fit;
            }
            step = checked(step / 2);
        }
    }

    std::uint64_t count_hits(double step, const Context& ctx) const {
        std::uint64_t hits = 0;
        for (std::size_t s = 0; s < stations_.size(); ++s) {
            const Grid grid(stations_[s].window, step, beams_, s);
            hits += parallel_reduce(
                ctx, grid.rows, 1, std::uint64_t{0},
                [&](IndexRange range) {
                    std::uint64_t count = 0;
                    if (ctx.stop.stop_requested()) return count;
                    for_row(s, grid, range.begin, [&](std::size_t, Vec3d, Vec3d) { ++count; });
                    return count;
                },
                std::plus<>());
            ctx.throw_if_cancelled();
        }
        return hits;
    }

    PointSet points(double step, Vec3d origin, const Context& ctx) const {
        PointSet out;
        out.origin = origin;
        out.positions.reserve(static_cast<std::size_t>(1.1 * options_.points));
        for (std::size_t s = 0; s < stations_.size(); ++s) {
            const Grid grid(stations_[s].window, step, beams_, s);
            std::vector<std::vector<Vec3>> rows(kRowsPerBlock);
            for (std::size_t first = 0; first < grid.rows; first += kRowsPerBlock) {
                ctx.throw_if_cancelled();
                const std::size_t count = std::min(kRowsPerBlock, grid.rows - first);
                parallel_for(ctx, count, 1, [&](std::size_t i) { fill_row(s, grid, first + i, rows[i]); });
                for (std::size_t i = 0; i < count; ++i)
                    out.positions.insert(out.positions.end(), rows[i].begin(), rows[i].end());
                const float done = static_cast<float>(first + count) / static_cast<float>(grid.rows);
                ctx.report(kCoarseShare + (1 - kCoarseShare) * (static_cast<float>(s) + done) /
                                              static_cast<float>(stations_.size()));
            }
        }
        return out;
    }

  private:
    double checked(double step) const {
        double beams = 0;
        for (const Station& s : stations_)
            beams += Grid::find_columns(s.window, step) * Grid::count_rows(s.window, step);
        if (beams <= kMaxBeams + kMaxBeamsPerPoint * options_.points) return step;
        throw InvalidInput(
            "scan: the scanner sees too little of the mesh; request fewer points, or reduce the distance");
    }

    /// Calls visit(index of the beam in the grid, point, direction) for each beam of a row that meets the
    /// target.
    template <class Visit>
    void for_row(std::size_t s, const Grid& grid, std::size_t row, const Visit& visit) const {
        const Station& station = stations_[s];
        const double elevation = grid.elevation(row);
        for (std::size_t column = 0; column < grid.columns; ++column) {
            const Vec3d direction = station.direction(grid.azimuth(column), elevation);
            Vec3d point;
            if (target_.first_point(station.place, direction, point))
                visit(row * grid.columns + column, point, direction);
        }
    }

    void fill_row(std::size_t s, const Grid& grid, std::size_t row, std::vector<Vec3>& out) const {
        const CounterRandom noise(static_cast<std::uint64_t>(options_.seed), kNoiseStage + s);
        out.clear();
        for_row(s, grid, row, [&](std::size_t beam, Vec3d point, Vec3d direction) {
            const double error = options_.noise * normal_pair(noise, beam).first;
            out.push_back(Vec3(target_.middle() + point + direction * error));
        });
    }

    const Target& target_;
    const ScanOptions& options_;
    CounterRandom beams_;
    std::vector<Station> stations_;
};

PointSet uniform_points(const PolygonMesh& mesh, const ScanOptions& options, const Context& ctx) {
    const NearMeshOptions even{.count = options.points, .low = 0, .high = 0, .seed = options.seed};
    PointSet out = near_mesh(triangulate(mesh), even, ctx);
    const CounterRandom noise(static_cast<std::uint64_t>(options.seed), kNoiseStage);
    parallel_for(ctx, out.size(), kGrain, [&](std::size_t i) {
        const NormalPair xy = normal_pair(noise, 2 * i), z = normal_pair(noise, 2 * i + 1);
        out.positions[i] =
            Vec3(Vec3d(out.positions[i]) + Vec3d{xy.first, xy.second, z.first} * double{options.noise});
    });
    return out;
}

}  // namespace

PointSet scan(const PolygonMesh& mesh, const ScanOptions& options, const Context& ctx) {
    check_fields(options, "scan");
    const Box3 box = checked_bounds(mesh);
    ctx.throw_if_cancelled();
    if (options.pattern == ScanPattern::uniform) return uniform_points(mesh, options, ctx);
    const Target target(mesh, box, ctx);
    const Scan scan(target, options, box.low.z - target.middle().z, ctx);
    const double step = scan.step(ctx);
    ctx.report(kCoarseShare);
    PointSet out = scan.points(step, mesh.origin, ctx);
    if (out.empty()) throw InvalidInput("scan: the scanner sees no part of the mesh; reduce the distance");
    return out;
}

void list_fields(ScanOptions& o, FieldList& list) {
    list.add(common_field(
                 "pattern",
                 "Distribution of the points: as a laser scanner measures them, or uniform on the surface."),
             o.pattern);
    list.add(common_field("points", "Approximate number of points.", Unit::none, 1, 1e8), o.points);
    list.add(common_field("positions", "Number of scanner positions, evenly spaced around the object.",
                          Unit::none, 1, 1000),
             o.positions);
    list.add(common_field("distance",
                          "Distance of the scanner from the vertical axis through the centre of the object.",
                          Unit::metre, 1e-3, 1e6),
             o.distance);
    list.add(Field{"height", "Height of the scanner above the lowest point.", Unit::metre, -1e6, 1e6},
             o.height);
    list.add(Field{"azimuth", "Direction of the first scanner, counter-clockwise from +x seen from above.",
                   Unit::radian, -6.2832, 6.2832},
             o.azimuth);
    list.add(common_field(
                 "noise",
                 "Standard deviation of the measured range, or of each coordinate for the uniform pattern.",
                 Unit::metre, 0, 1e3),
             o.noise);
    list.add(common_field("seed", "Seed of the noise and of the beam directions.", Unit::none, 0, 2147483647),
             o.seed);
}

}  // namespace coppice
