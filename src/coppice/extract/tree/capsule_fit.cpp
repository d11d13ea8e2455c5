#include "coppice/extract/tree/capsule_fit_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/id.h"
#include "coppice/base/kernel/round_cone.h"
#include "coppice/base/progress.h"

namespace coppice {

namespace {

constexpr std::size_t kCapsuleFitGrain = 4096;
constexpr double kMaxChange = 3;  // maximum factor by which one fit changes a radius, up or down

using Vec4 = std::array<double, 4>;
using Mat4 = std::array<Vec4, 4>;

/// Fitted surface and its samples.
struct Model {
    const InitialTree& tree;
    const InitialTreeLinks& links;
    std::span<const Vec3> positions, normals;
    std::vector<RoundCone> cones;  ///< one per node, computed by the last `update_cones`

    void update_cones() {
        cones.resize(tree.size());
        for (std::uint32_t n = 0; n < tree.size(); ++n) cones[n] = surface_cone(tree, links, n);
    }
    /// Returns the closest point of sample i on the segment that ends at node n.
    RoundCone::ClosestPoint closest_point(std::uint32_t n, std::size_t i) const {
        return cones[n].closest_point(Vec3d(positions[i]));
    }
};

/// Returns the signed distance from the segment; it is larger for segments with a surface that faces another
/// way than the sample.
double score(const Model& model, std::uint32_t n, std::size_t i) {
    const RoundCone::ClosestPoint f = model.closest_point(n, i);
    double depth = f.signed_distance();
    if (!model.normals.empty()) {
        const double facing = dot(normalized(f.offset, {}), Vec3d(model.normals[i]));
        depth += std::max(0.0, 0.3 - facing) * f.radius;
    }
    return depth;
}

/// Returns the segment with the smallest score of sample i, by a descent from `n` over adjacent segments.
std::uint32_t deepest_segment(const Model& model, std::uint32_t n, std::size_t i) {
    constexpr int kMaxSteps = 64;
    double best = score(model, n, i);
    for (int step = 0; step < kMaxSteps; ++step) {
        const std::uint32_t here = n;
        const auto look = [&](std::uint32_t m) {
            const double v = score(model, m, i);
            if (v < best) {
                best = v;
                n = m;
            }
        };
        for (const std::uint32_t c : model.links.children(here)) look(c);
        if (const std::uint32_t q = model.tree.parent[here]; q != kNoIndex) {
            look(q);
            for (const std::uint32_t c : model.links.children(q))
                if (c != here) look(c);
        }
        if (n == here) break;
    }
    return n;
}

void assign_samples(Model& model, std::span<std::uint32_t> node, const Context& ctx) {
    model.update_cones();
    parallel_for(ctx, node.size(), kCapsuleFitGrain, [&](std::size_t i) {
        if (node[i] != kNoIndex) node[i] = deepest_segment(model, node[i], i);
    });
}

/// Normal equations of one segment: blocks of its parent, of its child, and between both. Of the symmetric
/// blocks pp and cc only the lower triangles are computed.
struct Block {
    Mat4 pp{}, pc{}, cc{};
    Vec4 gp{}, gc{};
    double weight = 0;
};

Block normal_equations(const Model& model, std::uint32_t n, std::span<const std::uint32_t> samples,
                       double robust) {
    Block out;
    const std::uint32_t q = model.tree.parent[n];
    const bool tapers = q != kNoIndex && model.links.leader(q) == n;
    for (const std::uint32_t i : samples) {
        const RoundCone::ClosestPoint f = model.closest_point(n, i);
        if (!(f.distance() > 0)) continue;
        const Vec3d d = normalized(f.offset, {});
        const double r = f.signed_distance(), x = r / f.radius / robust;
        double w = 1 / (1 + x * x);
        w *= w;
        if (!model.normals.empty() && length_squared(model.normals[i]) > 0) {
            const double facing = std::max(0.0, dot(d, Vec3d(model.normals[i])));
            w *= facing * facing;
        }
        w /= f.radius * f.radius;
        const double share = q == kNoIndex ? 1 : f.t;
        const Vec4 jc{-d.x * share, -d.y * share, -d.z * share, tapers ? -share : -1.0};
        const double other = 1 - share;
        const Vec4 jp{-d.x * other, -d.y * other, -d.z * other, tapers ? -other : 0.0};
        for (int a = 0; a < 4; ++a) {
            for (int b = 0; b <= a; ++b) {
                out.cc[a][b] += w * jc[a] * jc[b];
                out.pp[a][b] += w * jp[a] * jp[b];
            }
            for (int b = 0; b < 4; ++b) out.pc[a][b] += w * jp[a] * jc[b];
            out.gc[a] -= w * jc[a] * r;
            out.gp[a] -= w * jp[a] * r;
        }
        out.weight += w;
    }
    return out;
}

/// Replaces the lower triangle of a symmetric positive definite matrix by its Cholesky factor.
void factorize(Mat4& a) {
    for (int j = 0; j < 4; ++j) {
        for (int k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        a[j][j] = std::sqrt(std::max(a[j][j], 1e-300));
        for (int i = j + 1; i < 4; ++i) {
            for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
}

/// Solves a x = b for the columns of b, where `a` is the Cholesky factor.
template <std::size_t N>
void solve_spd(const Mat4& a, std::array<Vec4, N>& columns) {
    for (Vec4& x : columns) {
        for (int i = 0; i < 4; ++i) {
            for (int k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
            x[i] /= a[i][i];
        }
        for (int i = 3; i >= 0; --i) {
            for (int k = i + 1; k < 4; ++k) x[i] -= a[k][i] * x[k];
            x[i] /= a[i][i];
        }
    }
}

/// Symmetric system with a block of four unknowns (position and radius) per node and a block per edge.
struct TreeSystem {
    std::vector<Mat4> diagonal;  // lower triangles
    std::vector<Mat4> across;    // rows of the parent, columns of the child
    std::vector<Vec4> right;
};

TreeSystem assemble(const InitialTree& tree, std::span<const Block> blocks, double stiffness) {
    const std::uint32_t size = tree.size();
    TreeSystem system{std::vector<Mat4>(size), std::vector<Mat4>(size), std::vector<Vec4>(size)};
    auto& [diagonal, across, right] = system;
    double mean = 0;
    for (std::uint32_t n = 0; n < size; ++n) mean += blocks[n].weight * tree.radius[n] * tree.radius[n];
    mean /= std::max(size, 1u);
    for (std::uint32_t n = 0; n < size; ++n) {
        const Block& b = blocks[n];
        const double unit = std::max(mean, 1.0) / (tree.radius[n] * tree.radius[n]);
        const double spring = stiffness * unit, hold = 1e-4 * unit;
        const std::uint32_t q = tree.parent[n];
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) across[n][i][j] = b.pc[i][j];
            for (int j = 0; j <= i; ++j) {
                diagonal[n][i][j] += b.cc[i][j];
                if (q != kNoIndex) diagonal[q][i][j] += b.pp[i][j];
            }
            diagonal[n][i][i] += hold + (q == kNoIndex ? 0 : spring);
            right[n][i] += b.gc[i];
            if (q == kNoIndex) continue;
            diagonal[q][i][i] += spring;
            across[n][i][i] -= spring;
            right[q][i] += b.gp[i];
        }
    }
    return system;
}

/// Eliminates the nodes from the tips to the root, then back-substitutes.
std::vector<Vec4> solve(const InitialTree& tree, TreeSystem system, const Context& ctx) {
    auto& diagonal = system.diagonal;
    auto& across = system.across;
    auto& right = system.right;
    for (std::uint32_t n = tree.size(); n-- > 0;) {
        poll_stop(ctx, n);
        const std::uint32_t q = tree.parent[n];
        if (tree.fixed[n]) continue;
        factorize(diagonal[n]);
        if (q == kNoIndex) continue;
        // Columns of diagonal^-1 across^T, and diagonal^-1 right.
        std::array<Vec4, 5> x;
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) x[j][i] = across[n][j][i];
        x[4] = right[n];
        solve_spd(diagonal[n], x);
        for (int i = 0; i < 4; ++i) {
            for (int k = 0; k < 4; ++k) {
                for (int j = 0; j <= i; ++j) diagonal[q][i][j] -= across[n][i][k] * x[j][k];
                right[q][i] -= across[n][i][k] * x[4][k];
            }
        }
    }
    std::vector<Vec4> step(tree.size());
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        if (tree.fixed[n]) continue;
        std::array<Vec4, 1> x{right[n]};
        const std::uint32_t q = tree.parent[n];
        if (q != kNoIndex)
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 4; ++k) x[0][i] -= across[n][k][i] * step[q][k];
        solve_spd(diagonal[n], x);
        step[n] = x[0];
    }
    return step;
}

/// Moves the nodes, each by at most `most` times its radius. A few coplanar samples do not determine a
/// radius: radii stay within a factor of their initial value.
void move_nodes(InitialTree& tree, std::span<const Vec4> step, std::span<const double> first_radius,
                double most) {
    for (std::uint32_t n = 0; n < tree.size(); ++n) {
        const Vec3d move(step[n][0], step[n][1], step[n][2]);
        const double farthest = most * tree.radius[n], l = length(move);
        if (!std::isfinite(l) || !std::isfinite(step[n][3])) continue;
        tree.position[n] += l > farthest ? move * (farthest / l) : move;
        tree.radius[n] = std::clamp(tree.radius[n] + step[n][3], first_radius[n] / kMaxChange,
                                    first_radius[n] * kMaxChange);
    }
}

}  // namespace

void fit_capsules(InitialTree& tree, FitSamples& samples, const FitOptions& options, const Context& ctx) {
    InitialTreeLinks links(tree);
    Model model{tree, links, samples.positions, samples.normals, {}};
    const std::vector<double> first_radius = tree.radius;
    std::vector<Block> blocks(tree.size());
    for (int k = 0; k < options.iterations; ++k) {
        assign_samples(model, samples.node, ctx);
        const auto samples_of = group_by(samples.node, tree.size());
        parallel_for(ctx, tree.size(), 64, [&](std::size_t i) {
            const auto n = static_cast<std::uint32_t>(i);
            blocks[n] = normal_equations(model, n, samples_of[n], options.robust);
        });
        const auto step = solve(tree, assemble(tree, blocks, options.stiffness), ctx);
        move_nodes(tree, step, first_radius, options.move);
        links.update_leaders(tree);
        ctx.report(static_cast<float>(k + 1) / static_cast<float>(options.iterations));
    }
    assign_samples(model, samples.node, ctx);
}

std::vector<float> fit_residuals(const InitialTree& tree, const FitSamples& samples, const Context& ctx) {
    std::vector<float> out(samples.positions.size(), 0);
    const InitialTreeLinks links(tree);
    Model model{tree, links, samples.positions, samples.normals, {}};
    model.update_cones();
    parallel_for(ctx, out.size(), kCapsuleFitGrain, [&](std::size_t i) {
        if (samples.node[i] != kNoIndex)
            out[i] = static_cast<float>(model.closest_point(samples.node[i], i).signed_distance());
    });
    return out;
}

}  // namespace coppice
