#include "coppice/extract/mesh/distance_internal.h"

#include <algorithm>
#include <cmath>

#include "coppice/base/progress.h"

namespace coppice::extract_internal {
namespace {

/// Returns the time at which a plane front that passes a at time ta and b at time tb reaches c, if its path
/// is inside the triangle; otherwise the arrival time along the edges.
double arrival(Vec3d c, Vec3d a, double ta, Vec3d b, double tb) {
    if (ta > tb) {
        std::swap(ta, tb);
        std::swap(a, b);
    }
    const Vec3d ca = a - c, cb = b - c;
    const double la = length(ca), lb = length(cb);
    const double along = std::min(ta + la, tb + lb);
    const double u = tb - ta, cosine = la > 0 && lb > 0 ? dot(ca, cb) / (la * lb) : 1;
    const double sine2 = 1 - cosine * cosine;
    // t = arrival after a: (a^2 + b^2 - 2 a b cos) t^2 + 2 b u (a cos - b) t + b^2 (u^2 - a^2 sin^2) = 0.
    const double qa = la * la + lb * lb - 2 * la * lb * cosine, qb = 2 * lb * u * (la * cosine - lb),
                 qc = lb * lb * (u * u - la * la * sine2);
    const double root = qb * qb - 4 * qa * qc;
    if (!(qa > 0) || root < 0) return along;
    const double t = (-qb + std::sqrt(root)) / (2 * qa);
    if (!(t > u) || cosine <= 0) return along;
    // distance from c of the intersection of the front with the edge to b
    const double crossing = lb * (t - u) / t;
    if (!(crossing > la * cosine) || !(crossing < la / cosine)) return along;
    return std::min(along, ta + t);
}

struct Candidate {
    double distance;
    std::uint32_t vertex;
};
bool later(const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance > b.distance : a.vertex > b.vertex;
}

}  // namespace

std::vector<double> march_distances(const Surface& s, std::span<const std::uint32_t> sources,
                                    const Context& ctx) {
    std::vector<double> distance(s.size(), std::numeric_limits<double>::infinity());
    std::vector<Candidate> heap;
    std::vector<char> fixed(s.size(), 0);
    const auto offer = [&](std::uint32_t v, double d) {
        if (fixed[v] || !(d < distance[v])) return;
        distance[v] = d;
        heap.push_back({d, v});
        std::push_heap(heap.begin(), heap.end(), later);
    };
    for (const std::uint32_t v : sources) offer(v, 0);
    for (std::size_t step = 1; !heap.empty(); ++step) {
        poll_stop(ctx, step);
        const auto [d, v] = heap.front();
        std::pop_heap(heap.begin(), heap.end(), later);
        heap.pop_back();
        if (fixed[v]) continue;
        fixed[v] = 1;
        const Vec3d p(s.positions[v]);
        for (const std::uint32_t h : s.outgoing(v)) {
            const std::uint32_t a = s.to(h), b = s.from(previous_half_edge<3>(h));
            const Vec3d pa(s.positions[a]), pb(s.positions[b]);
            if (!fixed[a])
                offer(a, fixed[b] ? arrival(pa, p, d, pb, distance[b]) : d + coppice::distance(p, pa));
            if (!fixed[b])
                offer(b, fixed[a] ? arrival(pb, p, d, pa, distance[a]) : d + coppice::distance(p, pb));
        }
    }
    return distance;
}

}  // namespace coppice::extract_internal
