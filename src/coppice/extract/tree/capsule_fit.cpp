#include "coppice/extract/tree/capsule_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "coppice/base/compressed_rows.h"
#include "coppice/base/round_cone.h"
#include "coppice/extract/stage_internal.h"

namespace coppice {
namespace {

constexpr std::uint32_t kNone = DraftTree::kNoParent;
constexpr std::size_t kGrain = 4096;
constexpr double kMostChange = 3;  // of a radius in one fit, up or down

using Vec4 = std::array<double, 4>;
using Mat4 = std::array<Vec4, 4>;

/// Where a sample lies against the segment that ends at a node.
class Fit {
  public:
    Fit(DraftTree& tree, FitSamples& samples, const FitOptions& options, const Context& ctx)
        : t_(tree), s_(samples), options_(options), ctx_(ctx), links_(tree), first_radius_(tree.radius) {}

    void run();
    RoundCone::Foot foot(std::uint32_t n, std::size_t i) const {
        return surface_cone(t_, links_, n).foot(Vec3d(s_.positions[i]));
    }
    void assign();

  private:
    struct Block {  // normal equations of one segment: parent, child and between
        Mat4 pp{}, pc{}, cc{};
        Vec4 gp{}, gc{};
        double weight = 0;
    };
    double score(std::uint32_t n, std::size_t i) const;
    Block block(std::uint32_t n) const;
    void solve(const std::vector<Block>& blocks);

    DraftTree& t_;
    FitSamples& s_;
    const FitOptions& options_;
    const Context& ctx_;
    DraftLinks links_;
    CompressedRows<std::uint32_t> samples_of_;  // each node
    std::vector<double> first_radius_;
};

/// The depth in the segment; segments whose surface faces the other way count as far.
double Fit::score(std::uint32_t n, std::size_t i) const {
    const RoundCone::Foot f = foot(n, i);
    double score = f.signed_distance();
    if (!s_.normals.empty()) {
        const double facing = dot(normalized(f.offset, {}), Vec3d(s_.normals[i]));
        score += std::max(0.0, 0.3 - facing) * f.radius;
    }
    return score;
}

void Fit::assign() {
    constexpr int kMostSteps = 64;
    extract_internal::stoppable_for(ctx_, s_.positions.size(), kGrain, [&](std::size_t i) {
        std::uint32_t n = s_.node[i];
        if (n == kNone) return;
        double best = score(n, i);
        for (int step = 0; step < kMostSteps; ++step) {
            const std::uint32_t here = n;
            const auto look = [&](std::uint32_t m) {
                const double v = score(m, i);
                if (v < best) {
                    best = v;
                    n = m;
                }
            };
            for (const std::uint32_t c : links_.children(here)) look(c);
            if (const std::uint32_t q = t_.parent[here]; q != kNone) {
                look(q);
                for (const std::uint32_t c : links_.children(q))
                    if (c != here) look(c);
            }
            if (n == here) break;
        }
        s_.node[i] = n;
    });
}

Fit::Block Fit::block(std::uint32_t n) const {
    Block out;
    const std::uint32_t q = t_.parent[n];
    const bool tapers = q != kNone && links_.leader(q) == n;
    for (const std::uint32_t i : samples_of_[n]) {
        const RoundCone::Foot f = foot(n, i);
        if (!(f.distance() > 0)) continue;
        const Vec3d d = normalized(f.offset, {});
        const double r = f.signed_distance(), x = r / f.radius / options_.robust;
        double w = 1 / (1 + x * x);
        w *= w;
        if (!s_.normals.empty() && length_squared(s_.normals[i]) > 0) {
            const double facing = std::max(0.0, dot(d, Vec3d(s_.normals[i])));
            w *= facing * facing;
        }
        w /= f.radius * f.radius;
        const double share = q == kNone ? 1 : f.t;
        const Vec4 jc{-d.x * share, -d.y * share, -d.z * share, tapers ? -share : -1.0};
        const double other = 1 - share;
        const Vec4 jp{-d.x * other, -d.y * other, -d.z * other, tapers ? -other : 0.0};
        for (int a = 0; a < 4; ++a) {
            for (int b = 0; b < 4; ++b) {
                out.cc[a][b] += w * jc[a] * jc[b];
                out.pp[a][b] += w * jp[a] * jp[b];
                out.pc[a][b] += w * jp[a] * jc[b];
            }
            out.gc[a] -= w * jc[a] * r;
            out.gp[a] -= w * jp[a] * r;
        }
        out.weight += w;
    }
    return out;
}

/// Solves a x = b for the columns of b; a is symmetric and positive.
template <std::size_t N>
void solve_spd(Mat4 a, std::array<Vec4, N>& columns) {
    for (int j = 0; j < 4; ++j) {  // Cholesky in place
        for (int k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
        a[j][j] = std::sqrt(std::max(a[j][j], 1e-300));
        for (int i = j + 1; i < 4; ++i) {
            for (int k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
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

/// Eliminates the nodes from the tips to the root, and moves them on the way back.
void Fit::solve(const std::vector<Block>& blocks) {
    const std::uint32_t n_nodes = t_.size();
    std::vector<Mat4> diagonal(n_nodes), across(n_nodes);  // across: rows of the parent, columns of the child
    std::vector<Vec4> right(n_nodes);
    double mean = 0;
    for (std::uint32_t n = 0; n < n_nodes; ++n) mean += blocks[n].weight * t_.radius[n] * t_.radius[n];
    mean /= n_nodes;
    for (std::uint32_t n = 0; n < n_nodes; ++n) {
        const Block& b = blocks[n];
        const double unit = std::max(mean, 1.0) / (t_.radius[n] * t_.radius[n]);
        const double spring = options_.stiffness * unit, hold = 1e-4 * unit;
        const std::uint32_t q = t_.parent[n];
        for (int i = 0; i < 4; ++i) {
            for (int j = 0; j < 4; ++j) {
                diagonal[n][i][j] += b.cc[i][j];
                across[n][i][j] = b.pc[i][j];
                if (q != kNone) diagonal[q][i][j] += b.pp[i][j];
            }
            diagonal[n][i][i] += hold + (q == kNone ? 0 : spring);
            right[n][i] += b.gc[i];
            if (q == kNone) continue;
            diagonal[q][i][i] += spring;
            across[n][i][i] -= spring;
            right[q][i] += b.gp[i];
        }
    }
    for (std::uint32_t n = n_nodes; n-- > 0;) {
        extract_internal::poll_stop(ctx_, n);
        const std::uint32_t q = t_.parent[n];
        if (q == kNone) continue;
        // Columns of diagonal^-1 across^T, and diagonal^-1 right.
        std::array<Vec4, 5> x;
        for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) x[j][i] = across[n][j][i];
        x[4] = right[n];
        solve_spd(diagonal[n], x);
        for (int i = 0; i < 4; ++i) {
            for (int k = 0; k < 4; ++k) {
                for (int j = 0; j < 4; ++j) diagonal[q][i][j] -= across[n][i][k] * x[j][k];
                right[q][i] -= across[n][i][k] * x[4][k];
            }
        }
    }
    std::vector<Vec4> step(n_nodes);
    for (std::uint32_t n = 0; n < n_nodes; ++n) {
        std::array<Vec4, 1> x{right[n]};
        const std::uint32_t q = t_.parent[n];
        if (q != kNone)
            for (int i = 0; i < 4; ++i)
                for (int k = 0; k < 4; ++k) x[0][i] -= across[n][k][i] * step[q][k];
        solve_spd(diagonal[n], x);
        step[n] = x[0];
    }
    for (std::uint32_t n = 0; n < n_nodes; ++n) {
        const Vec3d move(step[n][0], step[n][1], step[n][2]);
        const double most = options_.move * t_.radius[n], l = length(move);
        if (!std::isfinite(l) || !std::isfinite(step[n][3])) continue;
        t_.position[n] += l > most ? move * (most / l) : move;
        // A few samples on a plane would call for any radius.
        t_.radius[n] = std::clamp(t_.radius[n] + step[n][3], first_radius_[n] / kMostChange,
                                  first_radius_[n] * kMostChange);
    }
}

void Fit::run() {
    std::vector<Block> blocks(t_.size());
    for (int k = 0; k < options_.iterations; ++k) {
        links_.update_leaders(t_);
        assign();
        samples_of_ = group_by(s_.node, t_.size());
        extract_internal::stoppable_for(
            ctx_, t_.size(), 64, [&](std::size_t n) { blocks[n] = block(static_cast<std::uint32_t>(n)); });
        solve(blocks);
        ctx_.report(static_cast<float>(k + 1) / static_cast<float>(options_.iterations));
    }
    links_.update_leaders(t_);
    assign();
}

}  // namespace

void fit_capsules(DraftTree& tree, FitSamples& samples, const FitOptions& options, const Context& ctx) {
    Fit(tree, samples, options, ctx).run();
}

std::vector<float> fit_residuals(const DraftTree& tree, const FitSamples& samples, const Context& ctx) {
    std::vector<float> out(samples.positions.size(), 0);
    DraftTree copy = tree;
    FitSamples same = samples;
    const FitOptions options;
    const Fit fit(copy, same, options, ctx);
    extract_internal::stoppable_for(ctx, out.size(), kGrain, [&](std::size_t i) {
        if (samples.node[i] != kNone)
            out[i] = static_cast<float>(fit.foot(samples.node[i], i).signed_distance());
    });
    return out;
}

}  // namespace coppice
