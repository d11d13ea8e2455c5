#include "coppice/pipeline/texture/tube_texture_internal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coppice/base/parallel.h"

namespace coppice::pipeline_internal {
namespace {

constexpr std::size_t kTubeGrain = 64;
// Share of the length of a tube by which differences of v around it may decrease along it.
constexpr float kMaxDecrease = 0.25f;

// Returns the number of places by which a ring has to be rotated to be closest to another one.
std::uint32_t best_rotation(std::span<const Vec3> from, std::span<const Vec3> to) {
    const auto count = static_cast<std::uint32_t>(from.size());
    float least = std::numeric_limits<float>::infinity();
    std::uint32_t best = 0;
    for (std::uint32_t r = 0; r < count; ++r) {
        float sum = 0;
        for (std::uint32_t k = 0; k < count; ++k) sum += length_squared(from[k] - to[(k + r) % count]);
        if (sum >= least) continue;
        least = sum;
        best = r;
    }
    return best;
}

}  // namespace

std::vector<std::uint32_t> find_kept_quads(const QuadBuild& build, const TubeRows& rows) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t q = 0; q < build.refinement.quad_count(); ++q) {
        if (build.remeshed.stays(rows.of_quad(q))) out.push_back(q);
    }
    return out;
}

TubeTexture::TubeTexture(const QuadBuild& build, const TextureOptions& options, const SlotOptions& slots,
                         const Context& ctx)
    : build_(build),
      options_(options),
      slots_(slots),
      tube_rows_(build.cage, build.tubes, build.refinement.levels(), build.sides),
      faces_(faces_of_tubes(tube_rows_)),
      cage_(build.refinement.cage()),
      size_(1u << build.refinement.levels()),
      sides_(tube_rows_.sides()),
      tube_(build.tubes.size()),
      patch_(build.cage.region.size()),
      rows_((build.tubes.size() + 1) * (size_ + 1)),
      ring_v_(build.tubes.size() * 2 * sides_) {
    for (std::uint32_t row = 0; row <= size_; ++row)
        rows_[rows_.size() - 1 - size_ + row] = static_cast<float>(row) / static_cast<float>(size_);
    parallel_for(ctx, tube_.size(), kTubeGrain, [&](std::size_t i) {
        const NodeId tube(static_cast<std::uint32_t>(i));
        if (faces_[i].side.count > 0) measure_rows(tube);
    });
    if (slots.twigs && slots.twig_tile > 0) beyond_.emplace(build);
    follow_axes();
    parallel_for(ctx, tube_.size(), kTubeGrain, [&](std::size_t i) {
        const NodeId tube(static_cast<std::uint32_t>(i));
        if (faces_[i].side.count > 0) set_sides(tube);
    });
    for (const NodeId node : nodes(build.tubes)) set_forks(node);
}

void TubeTexture::set_columns(const TexturePatch& p, PatchColumns& out) const {
    out.u.resize(size_ + 1);
    out.first.resize(size_ + 1);
    out.last.resize(size_ + 1);
    for (std::uint32_t column = 0; column <= size_; ++column) {
        const float share = static_cast<float>(column) / static_cast<float>(size_);
        out.u[column] = turns(p, column) * static_cast<float>(p.wraps);
        out.first[column] = std::lerp(p.v[0], p.v[1], share);
        out.last[column] = std::lerp(p.v[3], p.v[2], share);
    }
}

TubeTexture::Ring TubeTexture::ring(NodeId tube, int end) const {
    const CageRun side = faces_[tube.index()].side;
    Ring out(side.count);
    for (std::uint32_t k = 0; k < side.count; ++k) out[k] = cage_.quads[side.first + k][end == 0 ? 0 : 3];
    return out;
}

// Returns the place of the edge between two successive vertices of a ring, or kNoIndex.
std::uint32_t TubeTexture::find_edge(std::span<const std::uint32_t> ring, std::uint32_t a, std::uint32_t b) {
    for (std::size_t k = 0; k < ring.size(); ++k) {
        if (ring[k] == a && ring[(k + 1) % ring.size()] == b) return static_cast<std::uint32_t>(k);
    }
    return kNoIndex;
}

// Sets the circumference, the rows, and the length for one wrap.
void TubeTexture::measure_rows(NodeId tube) {
    const CageRun side = faces_[tube.index()].side;
    const std::uint32_t columns = side.count * size_;
    std::vector<Vec3> below(columns), above(columns);
    const auto fill = [&](std::uint32_t row, std::vector<Vec3>& out) {
        for (std::uint32_t c = 0; c < columns; ++c)
            out[c] = position(vertex(side.first + c / size_, c % size_, row));
    };
    const auto circumference = [&](const std::vector<Vec3>& ring) {
        float sum = 0;
        for (std::uint32_t c = 0; c < columns; ++c) sum += distance(ring[c], ring[(c + 1) % columns]);
        return sum;
    };
    float* const rows = &rows_[std::size_t{tube.index()} * (size_ + 1)];
    fill(0, below);
    float around = circumference(below), total = around;
    rows[0] = 0;
    for (std::uint32_t row = 0; row < size_; ++row) {
        fill(row + 1, above);
        float along = 0;
        for (std::uint32_t c = 0; c < columns; ++c) along += distance(below[c], above[c]);
        const float next = circumference(above);
        rows[row + 1] =
            rows[row] + along / static_cast<float>(columns) / std::max(0.5f * (around + next), 1e-30f);
        total += next;
        around = next;
        std::swap(below, above);
    }
    at(tube).circumference = total / static_cast<float>(size_ + 1);
    at(tube).length = rows[size_];
    for (std::uint32_t row = 1; row <= size_; ++row) {
        rows[row] = rows[size_] > 0 ? rows[row] / at(tube).length
                                    : static_cast<float>(row) / static_cast<float>(size_);
    }
}

// [m] Returns the width of the tiles around a tube: it is one of a twig if it begins as a twig.
float TubeTexture::tile(NodeId tube) const {
    const bool is_twig = beyond_ && 2 * beyond_->at(tube, 0) < slots_.twig_diameter;
    return is_twig ? slots_.twig_tile : options_.tile;
}

// `current`: 0 at the beginning of a branch.
std::uint32_t TubeTexture::choose_wraps(NodeId tube, std::uint32_t current) const {
    const float exact = std::min(at(tube).circumference / tile(tube), 1e6f);
    const auto nearest = static_cast<std::uint32_t>(std::max(1L, std::lround(exact)));
    if (current == 0) return nearest;
    const float ratio = exact / static_cast<float>(current);
    const bool fits = ratio * ratio <= 2 && ratio * ratio >= 0.5f;
    return fits ? current : nearest;
}

void TubeTexture::follow_axes() {
    const Skeleton& tubes = build_.tubes;
    for (const NodeId n : nodes(tubes)) {
        if (faces_[n.index()].side.count == 0) continue;
        const NodeId parent = tubes.parent(n);
        const bool continues = !tubes.is_root(parent) && tubes.leader(parent) == n &&
                               faces_[parent.index()].side.count == faces_[n.index()].side.count;
        if (continues) {
            continue_axis(n);
        } else {
            at(n).axis = axis_count_++;
            at(n).wraps = choose_wraps(n, 0);
            begin_zone(n, at(n).wraps);
        }
        set_end(n);
    }
}

// Continues the branch of the parent's tube. Between the two rings there can be a gap, across which other
// branches leave.
void TubeTexture::continue_axis(NodeId tube) {
    const NodeId parent = build_.tubes.parent(tube);
    const Tube& before = at(parent);
    Tube& after = at(tube);
    std::vector<Vec3> from, to;
    for (const std::uint32_t v : ring(parent, 1)) from.push_back(position(v));
    for (const std::uint32_t v : ring(tube, 0)) to.push_back(position(v));
    const auto count = static_cast<std::uint32_t>(from.size());
    const std::uint32_t rotation = best_rotation(from, to);
    const float density = static_cast<float>(before.wraps) / std::max(before.circumference, 1e-30f);
    float sum = 0;
    for (std::uint32_t k = 0; k < count; ++k) {
        const std::uint32_t next = (k + rotation) % count;
        sum += ring_v(tube, 0, next) = ring_v(parent, 1, k) + density * distance(from[k], to[next]);
    }
    after.axis = before.axis;
    after.column = (before.column + count - rotation) % count;
    after.begin = sum / static_cast<float>(count);
    after.wraps = choose_wraps(tube, before.wraps);
    after.zone = before.zone;
    if (after.wraps != before.wraps) begin_zone(tube, before.wraps);
}

// Sets v at the end of a tube. Differences around it decrease as fast as its length allows.
void TubeTexture::set_end(NodeId tube) {
    Tube& own = at(tube);
    const float length = static_cast<float>(own.wraps) * own.length;
    own.end = own.begin + length;
    float most = 0;
    for (std::uint32_t k = 0; k < sides_; ++k)
        most = std::max(most, std::abs(ring_v(tube, 0, k) - own.begin));
    const float share = most > 0 ? std::max(0.0f, 1 - kMaxDecrease * length / most) : 0;
    for (std::uint32_t k = 0; k < sides_; ++k)
        ring_v(tube, 1, k) = own.end + share * (ring_v(tube, 0, k) - own.begin);
}

void TubeTexture::set_sides(NodeId tube) {
    const Tube& own = at(tube);
    const CageRun side = faces_[tube.index()].side;
    const float share = 1 / static_cast<float>(side.count);
    for (std::uint32_t k = 0; k < side.count; ++k) {
        const auto column = static_cast<float>((own.column + k) % side.count);
        patch_[side.first + k] = {
            own.axis,
            own.wraps,
            column * share,
            (column + 1) * share,
            {ring_v(tube, 0, k), ring_v(tube, 0, k + 1), ring_v(tube, 1, k + 1), ring_v(tube, 1, k)},
            tube.index() * (size_ + 1),
            tiles_per_metre(own),
            own.zone,
            tube,
            {0, 1}};
    }
}

// The quads between the tubes at a branch node are faces of the stem, or rows between a lateral and the face
// of the stem through which it leaves. Others, as in ramifications, are left without coordinates.
void TubeTexture::set_forks(NodeId node) {
    if (!tube_rows_.is_fork(node)) return;
    const NodeId owner = tube_rows_.fork_tube(node);
    const CageRun fork = faces_[owner.index()].fork[owner == node ? 1 : 0];
    std::vector<Collar> collars;
    for (std::uint32_t f = fork.first; f < fork.first + fork.count; ++f) {
        if (!set_stem_face(f, node)) find_collar(f, node, collars);
    }
    for (const Collar& c : collars) {
        float along = 0, around = 0;
        for (const Collar& other : collars) {
            if (other.lateral != c.lateral) continue;
            along += column_length(other.cage_quad);
            around += row_length(other.cage_quad) * static_cast<float>(sides_);
        }
        set_collar(c, around > 0 ? along / around : 0);
    }
    if (!options_.blend) return;
    tube_rows_.for_each_tube_at(node, [&](NodeId tube) {
        if (tube != node && tube_rows_.end_at(tube, node) == 0) set_rim(node, tube, collars);
    });
}

bool TubeTexture::set_stem_face(std::uint32_t cage_quad, NodeId node) {
    const NodeId leader = build_.tubes.leader(node);
    if (build_.tubes.is_root(node) || !leader || at(leader).axis != at(node).axis) return false;
    const Quad& q = cage_.quads[cage_quad];
    const std::uint32_t k = find_edge(ring(node, 1), q[0], q[1]);
    const std::uint32_t next = find_edge(ring(leader, 0), q[3], q[2]);
    if (k == kNoIndex || next == kNoIndex) return false;
    const auto column = static_cast<float>((at(node).column + k) % sides_);
    set_rectangle(
        cage_quad, node, 1, {column, column + 1},
        {ring_v(node, 1, k), ring_v(node, 1, k + 1), ring_v(leader, 0, next + 1), ring_v(leader, 0, next)});
    return true;
}

// Finds the lateral at the inner edge of a quad, if there is one.
void TubeTexture::find_collar(std::uint32_t cage_quad, NodeId node, std::vector<Collar>& collars) const {
    const Quad& q = cage_.quads[cage_quad];
    tube_rows_.for_each_tube_at(node, [&](NodeId tube) {
        if (tube == node || faces_[tube.index()].side.count == 0) return;
        const int end = tube_rows_.end_at(tube, node);
        const std::uint32_t k =
            end == 0 ? find_edge(ring(tube, 0), q[3], q[2]) : find_edge(ring(tube, 1), q[2], q[3]);
        if (k != kNoIndex) collars.push_back({cage_quad, tube, k, end});
    });
}

// `length`: of the collar, in its circumferences.
void TubeTexture::set_collar(const Collar& c, float length) {
    const Tube& own = at(c.lateral);
    const float rise = static_cast<float>(own.wraps) * length;
    const auto column = static_cast<float>((own.column + c.edge) % sides_);
    const float left = ring_v(c.lateral, c.end, c.edge), right = ring_v(c.lateral, c.end, c.edge + 1);
    if (c.end == 0) {
        set_rectangle(c.cage_quad, c.lateral, c.end, {column, column + 1},
                      {left - rise, right - rise, right, left});
    } else {  // seen along the lateral, which ends here, the quad is upside down
        set_rectangle(c.cage_quad, c.lateral, c.end, {column + 1, column},
                      {right + rise, left + rise, left, right});
    }
}

// Sets a quad at an end of a tube.
void TubeTexture::set_rectangle(std::uint32_t cage_quad, NodeId tube, int end, std::array<float, 2> columns,
                                const std::array<float, 4>& v) {
    const float share = 1 / static_cast<float>(sides_);
    const auto place = static_cast<float>(end);
    patch_[cage_quad] = {at(tube).axis,
                         at(tube).wraps,
                         columns[0] * share,
                         columns[1] * share,
                         v,
                         static_cast<std::uint32_t>(rows_.size() - 1 - size_),
                         tiles_per_metre(at(tube)),
                         at(tube).zone,
                         tube,
                         {place, place}};
}

// [m] Returns the mean length of the columns of a cage quad.
float TubeTexture::column_length(std::uint32_t cage_quad) const {
    float sum = 0;
    for (const std::uint32_t column : {0u, size_}) {
        for (std::uint32_t row = 0; row < size_; ++row) {
            sum += distance(position(vertex(cage_quad, column, row)),
                            position(vertex(cage_quad, column, row + 1)));
        }
    }
    return sum / 2;
}

// [m] Returns the mean length of the rows of a cage quad.
float TubeTexture::row_length(std::uint32_t cage_quad) const {
    float sum = 0;
    for (std::uint32_t row = 0; row <= size_; ++row) {
        for (std::uint32_t column = 0; column < size_; ++column) {
            sum += distance(position(vertex(cage_quad, column, row)),
                            position(vertex(cage_quad, column + 1, row)));
        }
    }
    return sum / static_cast<float>(size_ + 1);
}

}  // namespace coppice::pipeline_internal
