#include "coppice/sketch/fit_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/sketch/banded_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr int kMostSteps = 30;
constexpr double kSettled = 1e-3;    // of its noise, by which no node moves any more
constexpr double kFarOff = 3;        // of its noise, and as many pixels: what is farther off counts less
constexpr double kAlongOwn = 0.25;   // weight along a stroke of its own points, against across
constexpr double kAlongOther = 0.1;  // the same of where the other stroke's points were matched
constexpr double kSharp = 0.5;       // of the usual turn at a node: what turns more is a corner
constexpr double kStartNoise = 0.1;  // [pixels] of a start that is given
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d eigen(Vec3d v) { return {v.x, v.y, v.z}; }

/// Where one picture wants one node.
struct Wish {
    const SketchView* view;
    PicturePoint target;     ///< [pixels]
    PicturePoint direction;  ///< unit, of the stroke there
    double noise = 1;        ///< [pixels]
    double across = 0;       ///< weights: 1 / pixels
    double along = 0;
};

struct Node {
    Vec3d position;
    std::array<double, 2> along{kNone, kNone};  // of the two strokes that were matched
    std::array<bool, 2> own{};                  // whether it is a point of them
    bool end = false;                           // where both strokes end
};

/// t of s by a match, linear between its pairs; NaN beyond.
double other_of(const Match& match, double s, bool from_first) {
    const auto here = [&](const Pair& p) { return from_first ? p.s : p.t; };
    const auto there = [&](const Pair& p) { return from_first ? p.t : p.s; };
    const auto& pairs = match.pairs;
    if (s < here(pairs.front()) - 1e-9 || s > here(pairs.back()) + 1e-9) return kNone;
    for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
        const double a = here(pairs[i]), b = here(pairs[i + 1]);
        if (s > b + 1e-9 || b - a < 1e-12) continue;
        return std::lerp(there(pairs[i]), there(pairs[i + 1]), std::clamp((s - a) / (b - a), 0.0, 1.0));
    }
    return there(pairs.back());
}

class AxisFit {
  public:
    explicit AxisFit(const FitInput& in) : in_(in) {}

    FittedAxis run(const Context& ctx) {
        place_nodes();
        if (!triangulate()) return {};
        measure_pieces();
        refine(ctx);
        FittedAxis out;
        for (const Node& node : nodes_) out.nodes.push_back({node.position, node.along});
        out.cost = cost_ / static_cast<double>(nodes_.size());
        return out;
    }

  private:
    const Line& line(std::size_t which) const { return *in_.matched[which].line; }
    const SketchView& view(std::size_t which) const { return *in_.matched[which].view; }

    /// A node for every point of both strokes, in the order of the match.
    void place_nodes() {
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
            for (const double s : line(which).along) {
                Node node;
                node.along[which] = s;
                node.own[which] = true;
                node.along[1 - which] = other_of(*in_.match, s, which == 0);
                nodes_.push_back(node);
            }
        }
        // A point beyond the match lies before all others or behind them.
        const Pair first = in_.match->pairs.front(), last = in_.match->pairs.back();
        const auto place = [&](const Node& node) {
            const double s = node.along[0], t = node.along[1];
            if (std::isnan(t)) return s < first.s ? s - first.s - 1 : s - last.s + kBeyond;
            if (std::isnan(s)) return t < first.t ? t - first.t - 1 : t - last.t + kBeyond;
            const double span_s = last.s - first.s, span_t = last.t - first.t;
            return (s - first.s) / std::max(span_s, 1e-9) + (t - first.t) / std::max(span_t, 1e-9);
        };
        std::ranges::stable_sort(nodes_, {}, place);
        join_ends();
    }

    /// Both strokes' first points are one node where both are matched, and so are their last ones.
    void join_ends() {
        const auto join = [&](std::size_t a, std::size_t b) {
            Node& x = nodes_[a];
            const Node& y = nodes_[b];
            const bool same = !std::isnan(x.along[0]) && !std::isnan(x.along[1]) && !std::isnan(y.along[0]) &&
                              !std::isnan(y.along[1]) && (x.own[0] ? y.own[1] : y.own[0]) &&
                              std::abs(x.along[0] - y.along[0]) < 1e-6 &&
                              std::abs(x.along[1] - y.along[1]) < 1e-6;
            if (!same || nodes_.size() < 3) return;
            x.own = {true, true};
            x.end = true;
            nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(b));
        };
        join(0, 1);
        join(nodes_.size() - 2, nodes_.size() - 1);
    }

    bool triangulate() {
        std::vector<std::size_t> sure;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const auto [s, t] = nodes_[i].along;
            if (std::isnan(s) || std::isnan(t)) continue;
            const ViewRay a = ray(view(0), line(0).at(s)), b = ray(view(1), line(1).at(t));
            const auto p = meet(a, b);
            if (!p || !in_front(*p)) continue;
            nodes_[i].position = *p;
            sure.push_back(i);
        }
        if (sure.size() < 2) return false;
        std::size_t next = 0;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (next < sure.size() && sure[next] == i) {
                ++next;
                continue;
            }
            // As deep as the nearest node that is known.
            const std::size_t near = next == 0 ? sure.front() : sure[next - 1];
            const std::size_t which = std::isnan(nodes_[i].along[0]) ? 1 : 0;
            const ViewRay r = ray(view(which), line(which).at(nodes_[i].along[which]));
            nodes_[i].position = r.origin + r.direction * dot(nodes_[near].position - r.origin, r.direction);
        }
        if (in_.start) nodes_.front().position = *in_.start;
        return true;
    }

    bool in_front(Vec3d p) const {
        return std::ranges::all_of(in_.matched, [&](const Sight& sight) {
            return sight.view->projection == Projection::orthographic || depth(*sight.view, p) > 1e-6;
        });
    }

    /// How long the pieces between nodes are meant to be: as in the pictures, in the scale of the branch.
    void measure_pieces() {
        Vec3d middle{};
        for (const Node& node : nodes_) middle += node.position / static_cast<double>(nodes_.size());
        scale_ = 0.5 * (pixels_per_metre(view(0), middle) + pixels_per_metre(view(1), middle));
        double reach = distance(nodes_.front().position, nodes_.back().position);
        const Pair first = in_.match->pairs.front(), last = in_.match->pairs.back();
        const double span_s = std::max(last.s - first.s, 1e-9), span_t = std::max(last.t - first.t, 1e-9);
        reach = std::max(reach, 0.5 * (span_s / pixels_per_metre(view(0), middle) +
                                       span_t / pixels_per_metre(view(1), middle)));
        std::vector<double> at;
        for (const Node& node : nodes_) {
            const double s = (node.along[0] - first.s) / span_s, t = (node.along[1] - first.t) / span_t;
            at.push_back(reach * (std::isnan(s) ? t : std::isnan(t) ? s : 0.5 * (s + t)));
        }
        const double least = 1e-3 * reach / static_cast<double>(nodes_.size());
        pieces_.clear();
        total_ = 0;
        for (std::size_t i = 0; i + 1 < at.size(); ++i) {
            pieces_.push_back(std::max(at[i + 1] - at[i], least));
            total_ += pieces_.back();
        }
    }

    std::vector<Wish> wishes(const Node& node) const {
        std::vector<Wish> out;
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
            if (std::isnan(node.along[which])) continue;
            const Line& l = line(which);
            const double weight = 1 / l.noise;
            double s = node.along[which];
            if (!node.own[which]) {
                // The foot on the stroke, near where it was matched, is what lies across.
                const double slack = 2 * l.length() / static_cast<double>(l.points.size());
                s = l.nearest(project(view(which), node.position), std::max(0.0, s - slack),
                              std::min(l.length(), s + slack));
            }
            const double along = node.end ? weight : node.own[which] ? kAlongOwn * weight : 0;
            out.push_back({&view(which), l.at(s), l.direction(s), l.noise, weight, along});
            if (node.own[which]) continue;
            const double matched = node.along[which];
            out.push_back(
                {&view(which), l.at(matched), l.direction(matched), l.noise, 0, kAlongOther * weight});
        }
        for (const Sight& other : in_.others) {
            const PicturePoint p = project(*other.view, node.position);
            const double s = other.line->nearest(p, 0, other.line->length());
            if (s <= 0 || s >= other.line->length()) continue;
            out.push_back({other.view, other.line->at(s), other.line->direction(s), other.line->noise,
                           1 / other.line->noise, 0});
        }
        return out;
    }

    /// Geman and McClure's: rr / (1 + rr / cc), so that what is far off pulls no more; `weight` is its slope.
    static double robust(double rr, double noise, double& weight) {
        const double far = kFarOff * (1 + 1 / noise), share = 1 / (1 + rr / (far * far));
        weight = share * share;
        return rr * share;
    }

    /// Charbonnier's: from quadratic to linear, so that a sharp corner costs no more than a bow as wide.
    static double sharp(double bb, double& weight) {
        const double root = std::sqrt(1 + bb / (kSharp * kSharp));
        weight = 1 / root;
        return 2 * kSharp * kSharp * (root - 1);
    }

    double cost_of(const std::vector<Vec3d>& positions, const std::vector<std::vector<Wish>>& wishes) const {
        double sum = 0, weight = 0;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            for (const Wish& w : wishes[i]) {
                const PicturePoint off = project(*w.view, positions[i]) - w.target;
                const double across = w.across * cross(w.direction, off),
                             along = w.along * dot(w.direction, off);
                sum += robust(across * across + along * along, w.noise, weight);
            }
        }
        for (std::size_t i = 1; i + 1 < positions.size(); ++i)
            sum += sharp(length_squared(bend_at(positions, i)), weight);
        if (in_.start) sum += length_squared((positions.front() - *in_.start) * start_weight());
        return sum;
    }

    double start_weight() const { return scale_ / kStartNoise; }

    double bend_weight(std::size_t i) const {
        return 1 / (in_.bend * std::sqrt(0.5 * (pieces_[i - 1] + pieces_[i]) / total_));
    }

    /// How far the axis turns at a node, in what it may turn by.
    Vec3d bend_at(const std::vector<Vec3d>& p, std::size_t i) const {
        return ((p[i + 1] - p[i]) / pieces_[i] - (p[i] - p[i - 1]) / pieces_[i - 1]) * bend_weight(i);
    }

    BandedSystem system_of(const std::vector<Vec3d>& positions,
                           const std::vector<std::vector<Wish>>& wishes) const {
        BandedSystem system(positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i)
            for (const Wish& w : wishes[i]) add_wish(system, i, w, positions[i]);
        for (std::size_t i = 1; i + 1 < positions.size(); ++i) add_bend(system, i, positions);
        if (in_.start) {
            const double ww = start_weight() * start_weight();
            system.diagonal(0) += ww * Eigen::Matrix3d::Identity();
            system.right(0) -= ww * eigen(positions.front() - *in_.start);
        }
        return system;
    }

    static void add_wish(BandedSystem& system, std::size_t i, const Wish& w, Vec3d position) {
        const PicturePoint off = project(*w.view, position) - w.target;
        const auto [x, y] = projection_change(*w.view, position);
        const double across = w.across * cross(w.direction, off), along = w.along * dot(w.direction, off);
        double weight = 0;
        robust(across * across + along * along, w.noise, weight);
        const Eigen::Vector3d slope_across = w.across * eigen(y * w.direction.x - x * w.direction.y);
        const Eigen::Vector3d slope_along = w.along * eigen(x * w.direction.x + y * w.direction.y);
        system.diagonal(i) +=
            weight * (slope_across * slope_across.transpose() + slope_along * slope_along.transpose());
        system.right(i) -= weight * (across * slope_across + along * slope_along);
    }

    void add_bend(BandedSystem& system, std::size_t i, const std::vector<Vec3d>& positions) const {
        const double w = bend_weight(i), before = w / pieces_[i - 1], behind = w / pieces_[i];
        const double here = -before - behind;
        const Vec3d turn = bend_at(positions, i);
        double weight = 0;
        sharp(length_squared(turn), weight);
        const Eigen::Matrix3d one = weight * Eigen::Matrix3d::Identity();
        const Eigen::Vector3d bend = weight * eigen(turn);
        system.diagonal(i - 1) += before * before * one;
        system.diagonal(i) += here * here * one;
        system.diagonal(i + 1) += behind * behind * one;
        system.next(i - 1) += before * here * one;
        system.next(i) += here * behind * one;
        system.after_next(i - 1) += before * behind * one;
        system.right(i - 1) -= before * bend;
        system.right(i) -= here * bend;
        system.right(i + 1) -= behind * bend;
    }

    void refine(const Context& ctx) {
        double damping = 1e-6;
        for (int step = 0; step < kMostSteps; ++step) {
            ctx.throw_if_cancelled();
            std::vector<Vec3d> positions;
            std::vector<std::vector<Wish>> wished;
            for (const Node& node : nodes_) {
                positions.push_back(node.position);
                wished.push_back(wishes(node));
            }
            const BandedSystem system = system_of(positions, wished);
            const double before = cost_of(positions, wished);
            double moved = 0;
            for (;; damping *= 10) {
                const std::vector<Eigen::Vector3d> change = system.solve(damping);
                std::vector<Vec3d> tried = positions;
                moved = 0;
                for (std::size_t i = 0; i < tried.size(); ++i) {
                    tried[i] += Vec3d{change[i].x(), change[i].y(), change[i].z()};
                    moved = std::max(moved, scale_ * change[i].norm());
                }
                const double after = cost_of(tried, wished);
                if (after <= before && std::ranges::all_of(tried, [](Vec3d p) { return is_finite(p); })) {
                    for (std::size_t i = 0; i < tried.size(); ++i) nodes_[i].position = tried[i];
                    cost_ = after;
                    break;
                }
                if (damping > 1e6) return;
            }
            damping = std::max(damping / 10, 1e-9);
            if (moved < kSettled * std::max(line(0).noise, line(1).noise)) return;
        }
    }

    static constexpr double kBeyond = 1e9;  // sorts what lies behind a match

    const FitInput& in_;
    std::vector<Node> nodes_;
    std::vector<double> pieces_;  ///< [m] meant, node to node
    double total_ = 0;            ///< [m] of all pieces
    double scale_ = 1;            ///< [pixels / m]
    double cost_ = 0;
};

}  // namespace

FittedAxis fit_axis(const FitInput& input, const Context& ctx) { return AxisFit(input).run(ctx); }

double angle_between(const ViewRay& a, const ViewRay& b) {
    return std::atan2(length(cross(a.direction, b.direction)), dot(a.direction, b.direction));
}

std::optional<Vec3d> meet(const ViewRay& a, const ViewRay& b) {
    const Vec3d between = b.origin - a.origin;
    const double cosine = dot(a.direction, b.direction), sine_squared = 1 - cosine * cosine;
    if (sine_squared < 1e-12) return std::nullopt;
    const double along_a = dot(between, a.direction), along_b = dot(between, b.direction);
    const double s = (along_a - cosine * along_b) / sine_squared,
                 t = (cosine * along_a - along_b) / sine_squared;
    return (a.origin + a.direction * s + b.origin + b.direction * t) * 0.5;
}

}  // namespace coppice::sketch_internal
