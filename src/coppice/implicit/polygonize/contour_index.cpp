#include "coppice/implicit/polygonize/contour_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace coppice {
namespace {

constexpr std::uint32_t kShortEnough = 6;  // maximum length of lists in squares that are not subdivided
constexpr std::uint32_t kTooLong = 24;     // minimum length of lists for which the tree is faster
constexpr int kMinCuts = 4;
constexpr int kMaxCuts = 9;
constexpr double kMaxWork = 2e7;
constexpr double kMargin = 1.0;  // [size] of the squares around the contours

double dot(Vec2d a, Vec2d b) { return a.x * b.x + a.y * b.y; }

Vec2d nearest_on(const PlaneSegment& s, Vec2d p) {
    const Vec2d d = s.b - s.a;
    return s.a + d * std::clamp(dot(p - s.a, d) / dot(d, d), 0.0, 1.0);
}

double squared_distance(const PlaneSegment& s, Vec2d p) {
    const Vec2d v = p - nearest_on(s, p);
    return dot(v, v);
}

/// Returns the centre of one of four quadrants, given by the signs of x and y.
Vec2d child_center(Vec2d center, double half, unsigned child) {
    const double q = 0.5 * half;
    return {center.x + (child & 1 ? q : -q), center.y + (child & 2 ? q : -q)};
}

/// A square of the plane, and the segments that may be nearest to points in it.
struct Square {
    std::uint32_t cell;
    int cuts;
    double budget;  // maximum number of distance computations
    Vec2d center;
    double half;
    std::vector<std::uint32_t> list;

    double reach() const { return std::numbers::sqrt2 * half; }
};

/// Removes segments that are farther than the segment nearest to the centre, anywhere in the square; moves
/// that segment to the front. Returns its distance.
///
/// The difference of two distances changes at most by the difference of their gradients, which are unit
/// vectors away from the segments; and these turn, within the square, by at most reach / (distance - reach).
double keep_what_may_be_nearest(std::span<const PlaneSegment> segments, Square& square) {
    const Vec2d c = square.center;
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < square.list.size(); ++k)
        if (const double d = squared_distance(segments[square.list[k]], c); d < least) least = d, nearest = k;
    least = std::sqrt(least);
    std::swap(square.list[0], square.list[nearest]);
    const double reach = square.reach();
    const double turn = least > reach ? std::min(2.0, 2 * reach / (least - reach)) : 2.0;
    const Vec2d away = least > 0 ? (c - nearest_on(segments[square.list[0]], c)) * (1 / least) : Vec2d{};
    std::size_t kept = 1;
    for (std::size_t k = 1; k < square.list.size(); ++k) {
        const Vec2d v = c - nearest_on(segments[square.list[k]], c);
        const double d = std::sqrt(dot(v, v));
        double change = 2;
        if (turn < 2 && d > 0) {
            const Vec2d g = v * (1 / d) - away;
            change = std::min(2.0, std::sqrt(dot(g, g)) + turn);
        }
        if (d <= (least + reach * change) * (1 + 1e-12)) square.list[kept++] = square.list[k];
    }
    square.list.resize(kept);
    return least;
}

}  // namespace

double contour_area(std::span<const Vec2d> corners) {
    double twice = 0;
    const Vec2d o = corners[0];
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const Vec2d a = corners[i] - o, b = corners[i + 1] - o;
        twice += a.x * b.y - a.y * b.x;
    }
    return 0.5 * twice;
}

ContourIndex::ContourIndex(std::vector<PlaneSegment> segments, bool closed)
    : segments_(std::move(segments)), closed_(closed), boxes_({}, Context{.threads = 1}) {
    low_ = high_ = segments_[0].a;
    std::vector<Box3> boxes(segments_.size());
    for (std::size_t i = 0; i < segments_.size(); ++i) {
        for (const Vec2d p : {segments_[i].a, segments_[i].b}) {
            low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
            high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
            extend_outward(boxes[i], {p.x, p.y, 0});
        }
    }
    boxes_ = BoxTree(boxes, Context{.threads = 1});
    center_ = (low_ + high_) * 0.5;
    half_ = (0.5 + kMargin) * std::max(high_.x - low_.x, high_.y - low_.y);
    build_rows();
    build_cells();
}

/// The minimum size of squares corresponds to 16 squares per segment if all were subdivided.
void ContourIndex::build_cells() {
    int max_cuts = kMinCuts;
    while (max_cuts < kMaxCuts && (std::size_t{4} << (2 * max_cuts)) <= 16 * segments_.size()) ++max_cuts;
    std::vector<std::uint32_t> all(segments_.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    cells_.resize(1);
    std::vector<Square> open{{0, 0, std::min(2e3 * static_cast<double>(segments_.size()), kMaxWork), center_,
                              half_, std::move(all)}};
    while (!open.empty()) {
        Square square = std::move(open.back());
        open.pop_back();
        const double share = 0.25 * (square.budget - static_cast<double>(square.list.size()));
        const double least = keep_what_may_be_nearest(segments_, square);
        const std::size_t kept = square.list.size();
        // Squares that the contour does not intersect are completely inside or outside.
        const bool crossed = closed_ && least <= square.reach() * (1 + 1e-12);
        const bool worth_it = kept > kShortEnough || crossed;
        if (worth_it && square.cuts < max_cuts && static_cast<double>(kept) <= share) {
            const auto first = static_cast<std::uint32_t>(cells_.size());
            cells_[square.cell].first = first;
            cells_.resize(first + 4);
            for (unsigned c = 0; c < 4; ++c)
                open.push_back({first + c, square.cuts + 1, share,
                                child_center(square.center, square.half, c), 0.5 * square.half, square.list});
            continue;
        }
        Cell& cell = cells_[square.cell];
        cell.is_leaf = true;
        cell.is_complete = kept <= kTooLong;
        cell.first = static_cast<std::uint32_t>(list_.size());
        cell.count = cell.is_complete ? static_cast<std::uint32_t>(kept) : 1;
        if (!crossed) cell.side = inside(square.center) ? Side::inside : Side::outside;
        for (std::size_t k = 0; k < cell.count; ++k) list_.push_back(square.list[k]);
    }
}

/// Creates as many stripes as segments, or fewer if long segments would be in too many.
void ContourIndex::build_rows() {
    const double height = high_.y - low_.y;
    std::size_t rows = std::min<std::size_t>(segments_.size(), 1 << 16), total = 0;
    const auto find_span = [&](const PlaneSegment& s) {
        return std::array{row(std::min(s.a.y, s.b.y)), row(std::max(s.a.y, s.b.y))};
    };
    for (;; rows /= 2) {
        rows_per_metre_ = height > 0 ? static_cast<double>(rows) / height : 0;
        row_first_.assign(rows + 1, 0);
        total = 0;
        for (const PlaneSegment& s : segments_) {
            const auto [first, last] = find_span(s);
            total += last - first + 1;
        }
        if (rows <= 1 || total <= 8 * segments_.size()) break;
    }
    for (const PlaneSegment& s : segments_) {
        const auto [first, last] = find_span(s);
        for (std::uint32_t r = first; r <= last; ++r) ++row_first_[r];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& f : row_first_) f = sum += f;  // ends here; starts after filling from the end
    row_list_.resize(total);
    for (std::size_t i = segments_.size(); i-- > 0;) {
        const auto [first, last] = find_span(segments_[i]);
        for (std::uint32_t r = first; r <= last; ++r)
            row_list_[--row_first_[r]] = static_cast<std::uint32_t>(i);
    }
}

std::uint32_t ContourIndex::row(double y) const {
    const double r = (y - low_.y) * rows_per_metre_, last = static_cast<double>(row_first_.size()) - 2;
    return static_cast<std::uint32_t>(std::clamp(r, 0.0, last));
}

bool ContourIndex::inside(Vec2d p) const {
    if (!closed_ || !(p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y)) return false;
    const std::uint32_t r = row(p.y);
    bool odd = false;
    for (std::uint32_t k = row_first_[r]; k < row_first_[r + 1]; ++k) {
        const auto& [a, b] = segments_[row_list_[k]];
        if ((a.y > p.y) == (b.y > p.y)) continue;  // an end on the ray belongs to the segment above it
        if (p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y))) odd = !odd;
    }
    return odd;
}

const ContourIndex::Cell* ContourIndex::find(Vec2d p) const {
    if (!(std::abs(p.x - center_.x) <= half_ && std::abs(p.y - center_.y) <= half_)) return nullptr;
    const Cell* cell = &cells_[0];
    Vec2d center = center_;
    double half = half_;
    while (!cell->is_leaf) {
        const unsigned child = (p.x >= center.x ? 1u : 0u) | (p.y >= center.y ? 2u : 0u);
        center = child_center(center, half, child);
        half *= 0.5;
        cell = &cells_[cell->first + child];
    }
    return cell;
}

PlaneSample ContourIndex::distance(Vec2d p) const {
    std::uint32_t nearest = 0;
    double squared = std::numeric_limits<double>::infinity();
    const auto look = [&](std::uint32_t i) {
        const double d = squared_distance(segments_[i], p);
        if (d < squared) squared = d, nearest = i;
    };
    const Cell* cell = find(p);
    if (cell != nullptr && cell->is_complete) {
        for (std::uint32_t k = 0; k < cell->count; ++k) look(list_[cell->first + k]);
        return signed_sample(p, nearest, squared, cell->side);
    }
    if (cell != nullptr) look(list_[cell->first]);
    const Vec3d at{p.x, p.y, 0};
    boxes_.search([&](std::uint32_t l, std::uint32_t i) { return distance_squared(boxes_.level(l)[i], at); },
                  squared, look);
    if (!std::isfinite(squared)) return {squared, {}};
    return signed_sample(p, nearest, squared, cell != nullptr ? cell->side : Side::outside);
}

PlaneSample ContourIndex::signed_sample(Vec2d p, std::uint32_t segment, double squared, Side side) const {
    const PlaneSegment& s = segments_[segment];
    const double d = std::sqrt(squared);
    if (d > 0) {
        const bool is_inside = closed_ && (side == Side::unknown ? inside(p) : side == Side::inside);
        const double sign = is_inside ? -1 : 1;
        return {sign * d, (p - nearest_on(s, p)) * (sign / d)};
    }
    const Vec2d along = s.b - s.a;
    const Vec2d across = Vec2d{along.y, -along.x} * (1 / std::sqrt(dot(along, along)));
    const bool flip = closed_ && inside(p + across * (1e-6 * half_));
    return {0, across * (flip ? -1.0 : 1.0)};
}

}  // namespace coppice
