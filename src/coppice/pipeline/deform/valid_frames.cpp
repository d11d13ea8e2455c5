#include "coppice/pipeline/deform/valid_frames.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace coppice {
namespace {

constexpr std::uint32_t kRounds = 12;
constexpr int kMaxUnchangedFrames = 7;  // number of attempts after which the frozen set is extended

// Marks the nodes that move faces with faults.
void freeze_faults(const SkinnedMesh& mesh, const SkinnedFrame& frame, std::span<std::uint8_t> is_frozen) {
    for (const std::uint32_t f : frame.folded) mesh.mark_movers(f, is_frozen);
    for (const FacePair& p : frame.crossings) {
        mesh.mark_movers(p.first, is_frozen);
        mesh.mark_movers(p.second, is_frozen);
        freeze_between(mesh.skeleton(), mesh.mover(p.first), mesh.mover(p.second), is_frozen);
    }
}

// Adds the neighbours of all frozen nodes because freezing these did not help.
void freeze_more(const Skeleton& s, std::span<std::uint8_t> is_frozen) {
    const std::vector<std::uint8_t> before(is_frozen.begin(), is_frozen.end());
    for (const NodeId n : nodes(s)) {
        const NodeId parent = s.parent(n);
        if (!parent) continue;
        if (before[n.index()] != 0) is_frozen[parent.index()] = 1;
        if (before[parent.index()] != 0) is_frozen[n.index()] = 1;
    }
}

using Vertices = std::vector<std::uint32_t>;

template <class Operation>
Vertices combined(const Operation& operation, const Vertices& a, const Vertices& b) {
    Vertices out;
    operation(a, b, std::back_inserter(out));
    return out;
}

// Repairs the faults of one frame, round by round.
class FrameRepair {
  public:
    FrameRepair(const SkinnedMesh& mesh, const Vertices& last_stiff)
        : mesh_(mesh), last_stiff_(last_stiff), is_frozen_(mesh.skeleton().size()) {}

    void answer(const SkinnedFrame& frame) {
        const Vertices bad = mesh_.at_fault(frame);
        ++answers_;
        // First, faces with faults are not projected: another branch may have come close, and its field moves
        // them in a way that they cannot follow.
        if (answers_ == 1) {
            stiff_ = bad;
            return;
        }
        // If that did not help, branches are frozen as they were before, with the same unprojected vertices.
        if (answers_ == 2) {
            stiff_ = combined(std::ranges::set_union, combined(std::ranges::set_difference, stiff_, bad),
                              combined(std::ranges::set_intersection, last_stiff_, bad));
        }
        const std::vector<std::uint8_t> before = is_frozen_;
        freeze_faults(mesh_, frame, is_frozen_);
        if (is_frozen_ == before) {
            stiff_ = combined(std::ranges::set_symmetric_difference, stiff_, bad);
            if (turned_) freeze_more(mesh_.skeleton(), is_frozen_);
            turned_ = !turned_;
        } else if (answers_ > kMaxUnchangedFrames) {
            freeze_more(mesh_.skeleton(), is_frozen_);
        }
    }

    const Vertices& stiff() const { return stiff_; }
    std::span<const std::uint8_t> is_frozen() const { return is_frozen_; }
    std::uint32_t frozen_nodes() const {
        return static_cast<std::uint32_t>(std::ranges::count(is_frozen_, std::uint8_t{1}));
    }

  private:
    const SkinnedMesh& mesh_;
    const Vertices& last_stiff_;
    std::vector<std::uint8_t> is_frozen_;
    Vertices stiff_;
    int answers_ = 0;
    bool turned_ = false;  // projected and unprojected vertices were exchanged because holding did not help
};

}  // namespace

ValidFrames::ValidFrames(SkinnedMesh& mesh)
    : mesh_(mesh), last_(rest_pose(mesh.skeleton())), positions_(mesh.made().quads().mesh.positions) {}

ValidFrame ValidFrames::next(const Pose& wanted, const Context& ctx) {
    constexpr int kSteps = 8;
    if (std::exchange(is_at_rest_, false)) {
        const Pose rest = last_;
        for (int i = 1; i < kSteps && !(wanted == rest); ++i)
            step(on_the_way(mesh_.skeleton(), rest, wanted, static_cast<double>(i) / kSteps), ctx);
    }
    return step(wanted, ctx);
}

ValidFrame ValidFrames::step(const Pose& wanted, const Context& ctx) {
    ValidFrame out;
    FrameRepair remedy(mesh_, last_stiff_);
    Pose pose = wanted;
    for (out.rounds = 1;; ++out.rounds) {
        ctx.throw_if_cancelled();
        SkinnedFrame frame = mesh_.deform(pose, remedy.stiff(), ctx);
        if (out.rounds == 1) {
            out.folded = frame.folded.size();
            out.crossings = frame.crossings.size();
        }
        out.not_converged = frame.projected.not_converged;
        if (frame.is_sound()) {
            last_ = std::move(pose);
            last_stiff_ = remedy.stiff();
            positions_ = std::move(frame.positions);
            out.frozen_nodes = remedy.frozen_nodes();
            break;
        }
        if (out.rounds == kRounds) {
            out.whole_tree_frozen = true;
            out.frozen_nodes = mesh_.skeleton().size();
            break;
        }
        remedy.answer(frame);
        if (remedy.frozen_nodes() > 0) pose = freeze(mesh_.skeleton(), wanted, last_, remedy.is_frozen());
    }
    out.positions = positions_;
    out.pose = last_;
    return out;
}

}  // namespace coppice
