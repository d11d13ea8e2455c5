#include "coppice/field/weights/global_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/base/error.h"
#include "coppice/base/parallel.h"
#include "coppice/field/convolution_field.h"
#include "coppice/field/weights/nnls.h"
#include "coppice/field/weights/weight_constraints_internal.h"

namespace coppice {
namespace {

constexpr std::uint64_t kMaxPairs = std::uint64_t{1} << 28;
constexpr std::size_t kGlobalWeightsGrain = 64;
constexpr double kSeen = 0.01;  // relative to the iso value: minimum norm of a column that is fitted

/// The constraints of one segment.
struct Site {
    NodeId segment;
    std::size_t begin, end;
};

std::vector<Site> find_sites(std::span<const WeightConstraint> constraints) {
    std::vector<Site> sites;
    for (std::size_t j = 0; j < constraints.size(); ++j) {
        if (sites.empty() || sites.back().segment != constraints[j].segment)
            sites.push_back({constraints[j].segment, j, j});
        sites.back().end = j + 1;
    }
    return sites;
}

void set_regions(ConvolutionField& field, std::span<const WeightConstraint> constraints,
                 std::span<const Site> sites, const Context& ctx) {
    std::vector<FieldRegion> regions(sites.size());
    for (std::size_t r = 0; r < sites.size(); ++r) {
        regions[r].seed = sites[r].segment;
        for (std::size_t j = sites[r].begin; j < sites[r].end; ++j)
            regions[r].box.extend(constraints[j].position);
    }
    field.set_regions(regions, ctx);
}

kernel::SegmentConstants<double> widened(const kernel::SegmentConstants<float>& s) {
    return {s.ax,  s.ay,     s.az,     s.ux,    s.uy,     s.uz,   s.begin,
            s.end, s.length, s.radius, s.slope, s.weight, s.balls};
}

/// Returns the contribution of every segment with its local weight at every constraint; entries may be 0.
SparseRows contributions(const ConvolutionField& field, std::span<const WeightConstraint> constraints,
                         std::span<const Site> sites, const Context& ctx) {
    SparseRows f;
    f.columns = static_cast<std::uint32_t>(field.segments().size());
    f.first.reserve(constraints.size() + 1);
    for (std::uint32_t r = 0; r < sites.size(); ++r)
        for (std::size_t j = sites[r].begin; j < sites[r].end; ++j)
            f.first.push_back(f.first.back() + field.candidates(r).size());
    if (f.first.back() > kMaxPairs)
        throw Unsupported("weights: the segments overlap too much for a global fit; set weights to local");
    f.column.resize(f.first.back());
    f.value.resize(f.first.back());
    parallel_for(ctx, sites.size(), kGlobalWeightsGrain, [&](std::size_t r) {
        const auto list = field.candidates(static_cast<std::uint32_t>(r));
        for (std::size_t k = 0; k < list.size(); ++k) {
            const auto segment = widened(field.segments()[list[k]]);
            for (std::size_t j = sites[r].begin; j < sites[r].end; ++j) {
                const Vec3d p(constraints[j].position);
                f.column[f.first[j] + k] = list[k];
                f.value[f.first[j] + k] = sample_segment(field.kernel(), segment, {p.x, p.y, p.z}).value;
            }
        }
    });
    return f;
}

/// Returns for every column whether it is fitted.
std::vector<std::uint8_t> seen_columns(const SparseRows& f) {
    std::vector<double> squares(f.columns, 0.0);
    for (std::size_t e = 0; e < f.entries(); ++e) squares[f.column[e]] += f.value[e] * f.value[e];
    std::vector<std::uint8_t> seen(f.columns);
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = squares[i] >= kSeen * kSeen;
    return seen;
}

/// Returns the entries of fitted columns that are not 0.
SparseRows only_seen(const SparseRows& f, std::span<const std::uint8_t> seen) {
    SparseRows out;
    out.columns = f.columns;
    out.first.reserve(f.first.size());
    for (std::size_t j = 0; j < f.rows(); ++j) {
        for (std::uint64_t e = f.first[j]; e < f.first[j + 1]; ++e) {
            if (!seen[f.column[e]] || f.value[e] == 0) continue;
            out.column.push_back(f.column[e]);
            out.value.push_back(f.value[e]);
        }
        out.first.push_back(out.value.size());
    }
    return out;
}

WeightResidual residual(const SparseRows& f, std::span<const double> x, const Context& ctx) {
    WeightResidual out;
    for (const double value : product(f, x, ctx)) {
        out.rms += (value - 1) * (value - 1);
        out.largest = std::max(out.largest, std::abs(value - 1));
    }
    out.rms = std::sqrt(out.rms / static_cast<double>(f.rows()));
    return out;
}

/// Returns the iso value minus the contributions of the unseen segments.
std::vector<double> right_side(const SparseRows& f, std::span<const std::uint8_t> seen, const Context& ctx) {
    std::vector<double> unseen(f.columns);
    for (std::size_t i = 0; i < unseen.size(); ++i) unseen[i] = seen[i] ? 0 : 1;
    std::vector<double> b = product(f, unseen, ctx);
    for (double& v : b) v = 1 - v;
    return b;
}

/// Returns the weights, each averaged with the weights of the segments that share a node with it.
std::vector<double> averaged(const Skeleton& s, const std::vector<double>& x) {
    // Of the segments at a node: the segment that ends there, and those that start there.
    std::vector<double> sum(s.size(), 0);
    std::vector<std::uint32_t> count(s.size(), 0);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        for (const NodeId end : {n, s.parent(n)}) {
            sum[end.index()] += x[n.index()];
            ++count[end.index()];
        }
    }
    std::vector<double> out = x;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const std::size_t i = n.index(), p = s.parent(n).index();
        out[i] = (sum[i] + sum[p] - x[i]) / (count[i] + count[p] - 1);
    }
    return out;
}

}  // namespace

GlobalWeights global_weights(const Skeleton& skeleton, const FieldOptions& options,
                             std::span<const Vec3> points, const Context& ctx) {
    FieldOptions plain = options;
    plain.weights = Weights::global;
    plain.contact = 0;
    ConvolutionField field(skeleton, plain, ctx);
    const std::vector<WeightConstraint> constraints = points.empty()
                                                          ? surface_constraints(skeleton, options, ctx)
                                                          : attached_constraints(skeleton, points, ctx);
    const std::vector<Site> sites = find_sites(constraints);
    set_regions(field, constraints, sites, ctx);
    const SparseRows f = contributions(field, constraints, sites, ctx);
    const std::vector<std::uint8_t> seen = seen_columns(f);
    if (std::find(seen.begin(), seen.end(), 1) == seen.end())
        throw InvalidInput("weights: no constraint is near the skeleton; provide points on its surface");

    const SparseRows fitted = only_seen(f, seen);
    const NnlsResult solved = nnls(fitted, right_side(f, seen, ctx), {}, ctx);
    GlobalWeights out;
    out.constraints = constraints.size();
    out.entries = fitted.entries();
    out.pivots = solved.pivots;
    out.sweeps = solved.sweeps;
    out.converged = solved.converged;
    std::vector<double> x(f.columns, 1.0);
    out.local = residual(f, x, ctx);
    out.factors.assign(f.columns, 1.0f);
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (seen[i]) {
            x[i] = solved.x[i];
            out.zero += x[i] == 0;
        } else {
            out.unseen += field.segments()[i].weight > 0;
        }
    }
    for (int k = 0; k < options.weight_averaging; ++k) x = averaged(skeleton, x);
    std::ranges::copy(x, out.factors.begin());
    out.global = residual(f, x, ctx);
    return out;
}

}  // namespace coppice
