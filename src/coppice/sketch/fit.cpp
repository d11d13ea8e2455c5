#include "coppice/sketch/fit_internal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "coppice/sketch/banded_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr int kMaxSteps = 30;
constexpr double kSettled = 1e-2;  // [noise] maximum displacement of the nodes at convergence
// factor on 1 + 1 pixel / noise: scale of the robust cost, beyond which outliers count less
constexpr double kFarOff = 3;
// weight along a stroke of its own points, relative to the weight across it
constexpr double kAlongOwn = 0.25;
constexpr double kAlongOther = 0.1;  // the same for matched points of the other stroke
constexpr double kSharp = 0.5;       // [standard turn at a node] larger turns are corners
constexpr double kOddTurn = 3;       // the same for the detection of wrong points
constexpr double kStartNoise = 0.1;  // [pixels] noise of a given start
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector3d eigen(Vec3d v) { return {v.x, v.y, v.z}; }

/// Target position of a node in an image.
struct Target {
    std::size_t node;
    const SketchView* view;
    PicturePoint target;     ///< [pixels]
    PicturePoint direction;  ///< unit vector, direction of the stroke there
    double noise = 1;        ///< [pixels]
    double across = 0;       ///< weights [1 / pixels]
    double along = 0;
};

struct Node {
    Vec3d position;
    std::array<double, 2> along{kNone, kNone};  // position along the two matched strokes
    std::array<int, 2> own{-1, -1};             // index of the corresponding point of each stroke; -1 = none
    bool end = false;                           // common end of both strokes
};

/// Returns the t of s in a match, interpolated linearly between its pairs; NaN outside the match.
double find_other(const Match& match, double s, bool from_first) {
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
        for (const Node& node : nodes_) out.nodes.push_back({node.position, node.along, node.own});
        judge(out.nodes);
        return out;
    }

  private:
    const Line& line(std::size_t which) const { return *in_.matched[which].line; }
    const SketchView& view(std::size_t which) const { return *in_.matched[which].view; }

    /// Creates a node for every point of both strokes, in the order of the match.
    void place_nodes() {
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
            for (std::size_t p = 0; p < line(which).along.size(); ++p) {
                const double s = line(which).along[p];
                Node node;
                node.along[which] = s;
                node.own[which] = static_cast<int>(p);
                node.along[1 - which] = find_other(*in_.match, s, which == 0);
                nodes_.push_back(node);
            }
        }
        // A point outside the match comes before or after all others.
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

    /// Merges the first points of both strokes into one node if both are matched, and likewise the last
    /// points.
    void join_ends() {
        const auto join = [&](std::size_t a, std::size_t b) {
            Node& x = nodes_[a];
            const Node& y = nodes_[b];
            const bool same = !std::isnan(x.along[0]) && !std::isnan(x.along[1]) && !std::isnan(y.along[0]) &&
                              !std::isnan(y.along[1]) && (x.own[0] >= 0 ? y.own[1] : y.own[0]) >= 0 &&
                              std::abs(x.along[0] - y.along[0]) < 1e-6 &&
                              std::abs(x.along[1] - y.along[1]) < 1e-6;
            if (!same || nodes_.size() < 3) return;
            x.own = {std::max(x.own[0], y.own[0]), std::max(x.own[1], y.own[1])};
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
            // Uses the depth of the closest known node.
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

    /// Computes the target lengths of the segments: as in the images, at the scale of the branch.
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

    void request_all() {
        targets_.clear();
        for (std::size_t i = 0; i < nodes_.size(); ++i) add_requests(i);
    }

    void add_requests(std::size_t i) {
        const Node& node = nodes_[i];
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
            if (std::isnan(node.along[which])) continue;
            const Line& l = line(which);
            const double weight = 1 / l.noise, matched = node.along[which];
            if (node.own[which] >= 0) {
                const double along = node.end ? weight : kAlongOwn * weight;
                targets_.push_back(
                    {i, &view(which), l.at(matched), l.direction(matched), l.noise, weight, along});
                continue;
            }
            // The target across the stroke is the closest point of the stroke near the matched position.
            const double slack = 2 * l.length() / static_cast<double>(l.points.size());
            const double s = l.nearest(project(view(which), node.position), std::max(0.0, matched - slack),
                                       std::min(l.length(), matched + slack));
            targets_.push_back({i, &view(which), l.at(s), l.direction(s), l.noise, weight, 0});
            targets_.push_back(
                {i, &view(which), l.at(matched), l.direction(matched), l.noise, 0, kAlongOther * weight});
        }
        for (const Sight& other : in_.others) {
            const PicturePoint p = project(*other.view, node.position);
            const double s = other.line->nearest(p, 0, other.line->length());
            if (s <= 0 || s >= other.line->length()) continue;
            targets_.push_back({i, other.view, other.line->at(s), other.line->direction(s), other.line->noise,
                                1 / other.line->noise, 0});
        }
    }

    /// Geman-McClure cost rr / (1 + rr / cc), which is bounded for outliers; `weight` is its derivative.
    static double robust(double rr, double noise, double& weight) {
        const double far = kFarOff * (1 + 1 / noise), share = 1 / (1 + rr / (far * far));
        weight = share * share;
        return rr * share;
    }

    /// Charbonnier cost: from quadratic to linear, so that a sharp corner costs no more than a wide bend by
    /// the same angle.
    static double sharp(double bb, double knee, double& weight) {
        const double root = std::sqrt(1 + bb / (knee * knee));
        weight = 1 / root;
        return 2 * knee * knee * (root - 1);
    }

    /// Deviation of a node from a target.
    struct Miss {
        double across, along;  ///< weighted
        double squared() const { return across * across + along * along; }
    };

    static Miss miss(const Target& w, Vec3d position) {
        const PicturePoint off = project(*w.view, position) - w.target;
        return {w.across * cross(w.direction, off), w.along * dot(w.direction, off)};
    }

    double compute_cost(const std::vector<Vec3d>& positions) const {
        double sum = 0, weight = 0;
        for (const Target& w : targets_) sum += robust(miss(w, positions[w.node]).squared(), w.noise, weight);
        for (std::size_t i = 1; i + 1 < positions.size(); ++i)
            sum += sharp(length_squared(bend_at(positions, i)), kSharp, weight);
        if (in_.start) sum += length_squared((positions.front() - *in_.start) * start_weight());
        return sum;
    }

    double start_weight() const { return scale_ / kStartNoise; }

    double bend_weight(std::size_t i) const {
        return 1 / (in_.bend * std::sqrt(0.5 * (pieces_[i - 1] + pieces_[i]) / total_));
    }

    /// Returns the turn of the axis at a node in standard turns.
    Vec3d bend_at(const std::vector<Vec3d>& p, std::size_t i) const {
        return ((p[i + 1] - p[i]) / pieces_[i] - (p[i] - p[i - 1]) / pieces_[i - 1]) * bend_weight(i);
    }

    /// Sets up the system for a step from these positions and returns their cost.
    double linearise(const std::vector<Vec3d>& positions) {
        system_.reset(positions.size());
        double cost = 0;
        for (const Target& w : targets_) cost += add_target(w, positions[w.node]);
        for (std::size_t i = 1; i + 1 < positions.size(); ++i) cost += add_bend(i, positions);
        if (!in_.start) return cost;
        const double ww = start_weight() * start_weight();
        const Vec3d off = positions.front() - *in_.start;
        system_.diagonal(0).diagonal().array() += ww;
        system_.right(0) -= ww * eigen(off);
        return cost + ww * length_squared(off);
    }

    double add_target(const Target& w, Vec3d position) {
        const Miss m = miss(w, position);
        const auto [x, y] = projection_change(*w.view, position);
        double weight = 0;
        const double cost = robust(m.squared(), w.noise, weight);
        const Vec3d across = (y * w.direction.x - x * w.direction.y) * w.across,
                    along = (x * w.direction.x + y * w.direction.y) * w.along;
        for (const auto& [slope, off] :
             {std::pair(eigen(across), m.across), std::pair(eigen(along), m.along)}) {
            const Eigen::Vector3d weighted = weight * slope;
            system_.diagonal(w.node).noalias() += weighted * slope.transpose();
            system_.right(w.node) -= off * weighted;
        }
        return cost;
    }

    double add_bend(std::size_t i, const std::vector<Vec3d>& positions) {
        const double w = bend_weight(i), before = w / pieces_[i - 1], behind = w / pieces_[i];
        const double here = -before - behind;
        const Vec3d turn = bend_at(positions, i);
        double weight = 0;
        const double cost = sharp(length_squared(turn), kSharp, weight);
        const Eigen::Vector3d bend = weight * eigen(turn);
        system_.diagonal(i - 1).diagonal().array() += weight * before * before;
        system_.diagonal(i).diagonal().array() += weight * here * here;
        system_.diagonal(i + 1).diagonal().array() += weight * behind * behind;
        system_.next(i - 1).diagonal().array() += weight * before * here;
        system_.next(i).diagonal().array() += weight * here * behind;
        system_.after_next(i - 1).diagonal().array() += weight * before * behind;
        system_.right(i - 1) -= before * bend;
        system_.right(i) -= here * bend;
        system_.right(i + 1) -= behind * bend;
        return cost;
    }

    std::vector<Vec3d> positions() const {
        std::vector<Vec3d> out;
        for (const Node& node : nodes_) out.push_back(node.position);
        return out;
    }

    void refine(const Context& ctx) {
        std::vector<Vec3d> now = positions(), tried = now;
        std::vector<Eigen::Vector3d> change;
        double damping = 1e-6;
        for (int step = 0; step < kMaxSteps; ++step) {
            ctx.throw_if_cancelled();
            request_all();
            const double before = linearise(now);
            double moved = 0;
            for (;; damping *= 10) {
                system_.solve(damping, change);
                moved = 0;
                for (std::size_t i = 0; i < now.size(); ++i) {
                    tried[i] = now[i] + Vec3d{change[i].x(), change[i].y(), change[i].z()};
                    moved = std::max(moved, scale_ * change[i].norm());
                }
                // False for a cost that is not finite.
                if (compute_cost(tried) <= before) break;
                if (damping > 1e6) return;
            }
            std::swap(now, tried);
            for (std::size_t i = 0; i < now.size(); ++i) nodes_[i].position = now[i];
            damping = std::max(damping / 10, 1e-9);
            if (moved < kSettled * std::max(line(0).noise, line(1).noise)) return;
        }
    }

    /// Computes scores without the tolerance of the fit: turns up to kOddTurn count quadratically.
    void judge(std::vector<AxisNode>& nodes) {
        request_all();
        const std::vector<Vec3d> at = positions();
        double weight = 0;
        for (const Target& w : targets_) {
            const double noise = std::min(w.noise, 1.0);
            nodes[w.node].off += noise * noise * robust(miss(w, at[w.node]).squared(), w.noise, weight);
        }
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            nodes[i].odd = nodes[i].off;
            if (i > 0 && i + 1 < nodes.size())
                nodes[i].odd += sharp(length_squared(bend_at(at, i)), kOddTurn, weight);
        }
    }

    static constexpr double kBeyond = 1e9;  // sort key of points after a match

    const FitInput& in_;
    std::vector<Node> nodes_;
    std::vector<double> pieces_;  ///< [m] target lengths between nodes
    double total_ = 0;            ///< [m] total of all segments
    double scale_ = 1;            ///< [pixels / m]
    std::vector<Target> targets_;
    BandedSystem system_;
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
