#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/median.h"
#include "coppice/sketch/branch_internal.h"
#include "coppice/sketch/fit_internal.h"
#include "coppice/sketch/match_internal.h"

namespace coppice::sketch_internal {
namespace {

constexpr double kMaxCost = 3;          // maximum cost of a match; above it, strokes show different branches
constexpr double kMinMatched = 0.3;     // minimum matched fraction of the strokes
constexpr double kHopeless = 1e6;       // score of an attempt without a result
constexpr double kOutlierDistance = 3;  // factor on 1 pixel + noise: minimum detour to a wrong point
// maximum number of points of all strokes for which every point is tried if no match is found
constexpr std::size_t kMaxTried = 40;
constexpr std::size_t kMaxSuspects = 6;  // maximum number of points tried otherwise
constexpr double kNear = 3;  // [noise] distance from the parent axis within which a stroke begins on it
constexpr double kGuessedStart = 0.6;
constexpr double kGuessedEnd = 0.3;  // [radius of the parent branch] radii without drawn widths

std::string rounded(double number, int digits) {
    std::string text = std::to_string(number);
    return text.substr(0, text.find('.') + (digits > 0 ? 1 + static_cast<std::size_t>(digits) : 0));
}

/// Returns the angle [rad] between two lines of sight, ignoring their orientation.
double compute_angle(const ViewRay& a, const ViewRay& b) {
    const double angle = angle_between(a, b);
    return std::min(angle, std::numbers::pi - angle);
}

/// Projects the axis into an image.
Line shown_in(const SketchView& view, const Axis& axis) {
    std::vector<PicturePoint> points;
    for (const Vec3d p : axis.positions) points.push_back(project(view, p));
    return line_through(std::move(points));
}

class BranchMaker {
  public:
    BranchMaker(const SketchFacts& facts, std::uint32_t branch, const Axis* parent, BranchFit& fit)
        : facts_(facts),
          views_(facts.views),
          branch_(facts.sketch.branches[branch]),
          parent_(parent),
          options_(facts.options),
          fit_(fit) {}

    Axis run(const Context& ctx) {
        if (parent_ && parent_->positions.empty()) return refuse("its parent branch was refused");
        if (branch_.strokes.size() < 2) return refuse("it is drawn in a single view");
        std::vector<Line> drawn = make_lines(true);
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            if (drawn[i].points.size() < 2)
                return refuse("all points of its stroke in '" + view_name(i) + "' coincide");
        }
        Outcome best = attempt(drawn, ctx);
        if (!best.suspects.empty() && total_left_out(drawn) > 0)
            keep_better(best, drawn, make_lines(false), ctx);
        while (!best.suspects.empty() && leave_out_one(drawn, best, ctx)) {
        }
        fit_ = best.fit;
        return best.why.empty() ? best.axis : refuse(best.why);
    }

  private:
    const SketchView& view(std::size_t i) const { return views_[branch_.strokes[i].view]; }
    const std::string& view_name(std::size_t i) const { return view(i).name; }

    Axis refuse(const std::string& why) {
        std::string strokes;
        for (std::size_t i = 0; i < branch_.strokes.size(); ++i)
            strokes += (i == 0 ? "'" : ", '") + view_name(i) + "'";
        fit_.refused =
            "branch '" + branch_.name + "' (" + (strokes.empty() ? "no strokes" : "strokes in " + strokes);
        if (fit_.angle > 0)
            fit_.refused += ", " + rounded(fit_.angle * 180 / std::numbers::pi, 1) + " degrees apart";
        fit_.refused += ") is refused: " + why;
        return {};
    }

    /// A point of a line.
    struct Suspect {
        std::size_t line, point;
        double odd;
    };

    /// Result of an attempt with a set of lines.
    struct Outcome {
        Axis axis;
        BranchFit fit;
        std::string why;                ///< reason for rejection, or empty
        double odd = 0;                 ///< negative log-likelihood of the result; smaller is better
        std::vector<Suspect> suspects;  ///< possibly wrong points, most unlikely first
    };

    std::vector<Line> make_lines(bool clean) const {
        std::vector<Line> out;
        for (const Stroke& stroke : branch_.strokes)
            out.push_back(make_line(facts_.sketch.views[stroke.view], stroke, facts_.hand,
                                    double{options_.noise}, clean));
        return out;
    }

    static std::size_t total_left_out(const std::vector<Line>& lines) {
        std::size_t sum = 0;
        for (const Line& line : lines) sum += line.left_out;
        return sum;
    }

    /// Tries other lines and keeps them if the result is more likely.
    void keep_better(Outcome& best, std::vector<Line>& drawn, std::vector<Line> others, const Context& ctx) {
        Outcome tried = attempt(others, ctx);
        if (tried.odd >= best.odd) return;
        best = std::move(tried);
        drawn = std::move(others);
    }

    Outcome attempt(const std::vector<Line>& drawn, const Context& ctx) {
        lines_ = drawn;
        fit_ = {.branch = fit_.branch};
        for (std::size_t i = 0; i < drawn.size(); ++i) {
            const Stroke& stroke = branch_.strokes[i];
            fit_.strokes.push_back({.view = stroke.view,
                                    .points = static_cast<std::uint32_t>(stroke.points.size()),
                                    .left_out = static_cast<std::uint32_t>(drawn[i].left_out)});
        }
        Outcome out;
        out.axis = made(out, ctx);
        out.fit = fit_;
        return out;
    }

    Axis made(Outcome& out, const Context& ctx) {
        if (parent_) find_start();
        choose_pair();
        if (fit_.angle < double{options_.min_angle})
            return out.why = "the angle between its views is too small", Axis{};
        const Match match = matched();
        fit_.matched = match.share;
        out.odd = kHopeless * (1 + match.cost);
        if (!matches(match)) {
            out.why = "its strokes do not match: their points are not on each other's lines of sight";
            suspect_all(out);
            return {};
        }
        const std::vector<AxisNode> nodes = fit(match, ctx);
        if (nodes.size() < 2) {
            suspect_all(out);
            return out.why = "its lines of sight meet behind a camera", Axis{};
        }
        Axis axis = find_axis(nodes);
        measure_errors(axis);
        double error = 0;
        for (const StrokeFit& stroke : fit_.strokes) error = std::max(error, stroke.rms_error);
        if (error > double{options_.max_error}) {
            out.why = "no branch is near all of its strokes, the best one is off by " + rounded(error, 1) +
                      " pixels";
        }
        judge(nodes, match, out);
        if (!out.why.empty()) {
            out.odd += kHopeless;
            suspect_all(out);
        }
        return axis;
    }

    /// Without evidence for a wrong point, any of a small number of points may be wrong.
    void suspect_all(Outcome& out) const {
        std::size_t points = 0;
        for (const Line& line : lines_) points += line.points.size();
        if (points > kMaxTried) return;
        for (std::size_t i = 0; i < lines_.size(); ++i)
            for (std::size_t p = 0; p < lines_[i].points.size(); ++p) suspect(out, i, p, kWrong);
    }

    /// Adds a point of a line of this attempt, converted to the index in its stroke.
    void suspect(Outcome& out, std::size_t line, std::size_t point, double odd) const {
        if (lines_[line].drawn[point] >= 0)
            out.suspects.push_back({line, static_cast<std::size_t>(lines_[line].drawn[point]), odd});
    }

    /// Scores for every point of a line of the pair.
    struct Oddness {
        std::vector<double>
            all;  ///< of its position, of the turns around it and of its distance from adjacent points
        std::vector<double> off;  ///< of its position only
    };

    /// Computes the score of the axis and the points that may be wrong.
    void judge(const std::vector<AxisNode>& nodes, const Match& match, Outcome& out) const {
        out.odd = 0;
        for (const AxisNode& node : nodes) out.odd += node.odd;
        for (const Line& line : lines_) out.odd += kWrong * static_cast<double>(line.left_out);
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}}) {
            Oddness odd = oddness_at(nodes, which);
            const Pair last = match.pairs.back();
            out.odd += judge_stroke(pair_[which], which == 0 ? last.s : last.t, odd.all);
            for (std::size_t p = 0; p < odd.all.size(); ++p)
                if (odd.all[p] > kWrong && (odd.off[p] > 0.5 * kWrong || detours(nodes, which, p)))
                    suspect(out, pair_[which], p, odd.all[p]);
        }
        std::ranges::stable_sort(out.suspects, std::ranges::greater(), &Suspect::odd);
        if (out.suspects.size() > kMaxSuspects) out.suspects.resize(kMaxSuspects);
    }

    Oddness oddness_at(const std::vector<AxisNode>& nodes, std::size_t which) const {
        const std::size_t count = lines_[pair_[which]].points.size();
        Oddness out{std::vector<double>(count, 0), std::vector<double>(count, 0)};
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (nodes[i].point[which] < 0) continue;
            const auto p = static_cast<std::size_t>(nodes[i].point[which]);
            out.off[p] = nodes[i].off;
            for (std::size_t n = i - std::min<std::size_t>(i, 1); n <= i + 1 && n < nodes.size(); ++n)
                out.all[p] += nodes[n].odd;
        }
        return out;
    }

    /// Returns the score of the point distances of a stroke, and of a missing tip beyond `matched` [pixels]
    /// or a missing start. Adds it to the scores of its points.
    double judge_stroke(std::size_t stroke, double matched, std::vector<double>& odd) const {
        const Line& line = lines_[stroke];
        double sum = 0;
        for (std::size_t p = 1; p < line.points.size(); ++p) {
            const double leap = compute_leap(stroke, p);
            sum += leap;
            odd[p] += leap;
            odd[p - 1] += leap;
        }
        if (line.length() - matched > kNear * line.noise) sum += kShort, odd.back() += kWrong;
        if (parent_ && line.drawn.front() < 0 && place_in(stroke, 1) == 0) sum += kShort, odd[1] += kShort;
        return sum;
    }

    /// Returns whether a point of a line of the pair causes a large detour of the axis, or is an end.
    bool detours(const std::vector<AxisNode>& nodes, std::size_t which, std::size_t point) const {
        const Line& line = lines_[pair_[which]];
        if (point == 0 || point + 1 == line.points.size() || line.drawn[point - 1] < 0) return true;
        const auto find_node = [&](std::size_t p) {
            return std::ranges::find_if(
                nodes, [&](const AxisNode& n) { return n.point[which] == static_cast<int>(p); });
        };
        const auto from = find_node(point - 1), to = find_node(point + 1);
        double way = -distance(from->position, to->position);
        for (auto node = from; node < to; ++node) way += distance(node->position, (node + 1)->position);
        return way * pixels_per_metre(view(pair_[which]), from->position) >
               kOutlierDistance * (1 + line.noise);
    }

    /// Returns the index in the stroke, counted from the start of the branch, of a point of the line; 0 for a
    /// start that was not drawn.
    int place_in(std::size_t stroke, std::size_t point) const {
        const int drawn = lines_[stroke].drawn[point];
        const auto count = static_cast<int>(branch_.strokes[stroke].points.size());
        return drawn < 0 ? 0 : fit_.strokes[stroke].reversed ? count - 1 - drawn : drawn;
    }

    /// Returns the score of the distance between a point and the previous one.
    double compute_leap(std::size_t stroke, std::size_t point) const {
        if (facts_.hand.piece <= 0) return 0;
        const Line& line = lines_[stroke];
        const int pieces = std::max(place_in(stroke, point) - place_in(stroke, point - 1), 1);
        const double piece = (line.along[point] - line.along[point - 1]) / pieces;
        if (piece <= facts_.hand.piece) return 0;
        const double far = std::log(piece / facts_.hand.piece) / facts_.hand.spread;
        const bool late = line.drawn[point - 1] < 0 && place_in(stroke, point) == 0;
        return std::min(far * far, late ? kShort : kWrong);
    }

    /// Tries to remove each of the possibly wrong points, and keeps the best result if it is more likely: in
    /// a short stroke, a wrong point cannot be detected from the stroke alone.
    bool leave_out_one(std::vector<Line>& drawn, Outcome& best, const Context& ctx) {
        std::size_t points = 0;
        for (const Line& line : drawn) points += line.points.size();
        // The wrong points of long strokes were found before, and each attempt is expensive.
        if (points > kMaxTried && best.why.empty()) return false;
        if (total_left_out(drawn) > points / 4) return false;
        const Outcome before = best;
        std::vector<Line> kept = drawn;
        for (const Suspect& suspect : before.suspects) {
            const Line& line = drawn[suspect.line];
            const auto found = std::ranges::find(line.drawn, static_cast<int>(suspect.point));
            if (line.points.size() <= (parent_ ? 1u : 2u) || found == line.drawn.end()) continue;
            std::vector<Line> without = drawn;
            without[suspect.line] = without_point(line, static_cast<std::size_t>(found - line.drawn.begin()));
            if (std::ranges::none_of(without, [](const Line& l) { return l.points.size() > 1; })) continue;
            Outcome tried = attempt(without, ctx);
            if (tried.odd < best.odd) best = std::move(tried), kept = std::move(without);
        }
        drawn = std::move(kept);
        return best.odd < before.odd;
    }

    /// Selects the two views with the largest angle.
    void choose_pair() {
        const auto sight = [&](std::size_t i) {
            return ray(view(i), lines_[i].at(0.5 * lines_[i].length()));
        };
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            for (std::size_t j = i + 1; j < lines_.size(); ++j) {
                const double angle = compute_angle(sight(i), sight(j));
                if (angle > fit_.angle) fit_.angle = angle, pair_ = {i, j};
            }
        }
    }

    /// Reverses strokes that end on the parent axis and begin off it, and finds the start of the branch on
    /// the parent axis.
    void find_start() {
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const Line shown = shown_in(view(i), *parent_);
            const auto off = [&](PicturePoint p) {
                return length(p - shown.at(shown.nearest(p, 0, shown.length())));
            };
            const double start = off(lines_[i].points.front()), end = off(lines_[i].points.back());
            if (start > 10 && end < 0.3 * start) turn(i);
        }
        start_ =
            branch_.attach ? place_at(*branch_.attach) : place_on(*parent_, views_, branch_.strokes, lines_);
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const PicturePoint p = project(view(i), parent_->at(start_));
            // A stroke that begins inside the parent branch begins at the start.
            const double thick = parent_->radius_at(start_) * pixels_per_metre(view(i), parent_->at(start_));
            const double near = std::max(kNear * lines_[i].noise, thick);
            const bool begins = length(p - lines_[i].points.front()) <= near && lines_[i].points.size() > 1;
            lines_[i] = begins ? with_first(lines_[i], p) : with_start(lines_[i], p);
        }
    }

    void turn(std::size_t i) {
        lines_[i] = reversed(lines_[i]);
        fit_.strokes[i].reversed = !fit_.strokes[i].reversed;
    }

    Place place_at(double share) const {
        const auto& p = parent_->positions;
        double total = 0, before = 0;
        for (std::size_t i = 0; i + 1 < p.size(); ++i) total += distance(p[i], p[i + 1]);
        for (std::size_t i = 0; i + 1 < p.size(); ++i) {
            const double piece = distance(p[i], p[i + 1]);
            if (before + piece >= share * total)
                return {i, std::clamp((share * total - before) / std::max(piece, 1e-12), 0.0, 1.0)};
            before += piece;
        }
        return {p.size() - 2, 1};
    }

    static bool matches(const Match& match) { return match.cost <= kMaxCost && match.share >= kMinMatched; }

    Match matched() {
        const auto [i, j] = pair_;
        const Matrix3 f = fundamental_matrix(view(i), view(j));
        Match match = match_lines(lines_[i], lines_[j], f, parent_ != nullptr);
        if (match.cost <= kMaxCost || parent_) return match;
        // A stem may have been drawn downwards in one view.
        Match turned = match_lines(lines_[i], reversed(lines_[j]), f, false);
        if (turned.cost > 0.5 * match.cost) return match;
        turn(j);
        return turned;
    }

    std::vector<AxisNode> fit(const Match& match, const Context& ctx) const {
        std::vector<Sight> others;
        for (std::size_t i = 0; i < lines_.size(); ++i)
            if (i != pair_[0] && i != pair_[1]) others.push_back({&view(i), &lines_[i]});
        const auto [i, j] = pair_;
        FitInput input{.matched = {Sight{&view(i), &lines_[i]}, Sight{&view(j), &lines_[j]}},
                       .others = others,
                       .match = &match,
                       .start = {},
                       .bend = double{options_.bend}};
        if (parent_) input.start = parent_->at(start_);
        return fit_axis(input, ctx).nodes;
    }

    Axis find_axis(const std::vector<AxisNode>& nodes) {
        Axis axis;
        axis.start = start_;
        for (const AxisNode& node : nodes) axis.positions.push_back(node.position);
        set_radii(nodes, axis);
        return axis;
    }

    void set_radii(const std::vector<AxisNode>& nodes, Axis& axis) {
        const bool drawn = std::ranges::any_of(lines_, [](const Line& l) { return !l.widths.empty(); });
        std::vector<double> along(1, 0);
        for (std::size_t i = 1; i < nodes.size(); ++i)
            along.push_back(along.back() + distance(nodes[i - 1].position, nodes[i].position));
        fit_.length = along.back();
        const auto between = [&](double first, double last) {
            for (const double s : along)
                axis.radii.push_back(std::lerp(first, last, s / std::max(along.back(), 1e-300)));
        };
        if (branch_.diameters) return between(0.5 * (*branch_.diameters)[0], 0.5 * (*branch_.diameters)[1]);
        if (drawn) {
            for (const AxisNode& node : nodes) axis.radii.push_back(drawn_radius(node));
            return;
        }
        COPPICE_ASSERT(parent_ != nullptr);  // checked by reconstruct
        fit_.guessed_radius = true;
        const double thick = parent_->radius_at(start_);
        between(kGuessedStart * thick, kGuessedEnd * thick);
    }

    /// Returns the mean radius from the drawn widths: of the pair where it is matched, otherwise of all
    /// strokes at the closest points.
    double drawn_radius(const AxisNode& node) const {
        double sum = 0;
        int count = 0;
        const auto add = [&](std::size_t i, double s) {
            sum += 0.5 * lines_[i].width_at(s) / pixels_per_metre(view(i), node.position);
            ++count;
        };
        for (const std::size_t which : {std::size_t{0}, std::size_t{1}})
            if (!lines_[pair_[which]].widths.empty() && !std::isnan(node.along[which]))
                add(pair_[which], node.along[which]);
        for (std::size_t i = 0; count == 0 && i < lines_.size(); ++i) {
            const Line& line = lines_[i];
            if (!line.widths.empty()) add(i, line.nearest(project(view(i), node.position), 0, line.length()));
        }
        return sum / count;
    }

    void measure_errors(const Axis& axis) {
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const Line line = shown_in(view(i), axis);
            double sum = 0;
            StrokeFit& fit = fit_.strokes[i];
            for (const PicturePoint p : lines_[i].points) {
                const double off = length(p - line.at(line.nearest(p, 0, line.length())));
                sum += off * off;
                fit.max_error = std::max(fit.max_error, off);
            }
            fit.rms_error = std::sqrt(sum / static_cast<double>(lines_[i].points.size()));
        }
    }

    const SketchFacts& facts_;
    std::span<const SketchView> views_;
    const SketchBranch& branch_;
    const Axis* parent_;
    const SketchOptions& options_;
    BranchFit& fit_;
    std::vector<Line> lines_;  ///< by stroke
    std::array<std::size_t, 2> pair_{0, 1};
    Place start_;
};

}  // namespace

Axis make_axis(const SketchFacts& facts, std::uint32_t branch, const Axis* parent, BranchFit& fit,
               const Context& ctx) {
    return BranchMaker(facts, branch, parent, fit).run(ctx);
}

}  // namespace coppice::sketch_internal
