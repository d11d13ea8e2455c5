#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/edit/animate/animate_options.h"
#include "coppice/edit/animate/growing.h"
#include "coppice/edit/animate/wind.h"
#include "coppice/pipeline/deform/skinned_mesh.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/render.h"
#include "coppice/scene/animation/frame_sinks.h"
#include "coppice/scene/keyframes.h"

namespace coppice {

/// Options of an animation: motion, surface and images.
struct AnimationOptions {
    bool grow = false;       ///< the tree grows from its root, with a separate surface in every frame
    AnimateOptions run;      ///< duration and frame rate
    GrowingOptions growing;  ///< used with `grow`
    WindOptions wind;        ///< used if the speed is positive
    MeshOptions mesh;        ///< options of the surface
    /// by MaterialSlot, of surfaces with texture coordinates; may be empty
    std::vector<MaterialFiles> materials;
    RenderOptions picture;  ///< options of rendered frames
};

/// Throws InvalidInput if nothing moves, or if growth is combined with options that it does not support.
void check_animation(const AnimationOptions& options, bool has_keys);

/// Motion of a tree by keys, wind, or both.
class Motion {
  public:
    /// Throws InvalidInput for options out of range, and if the number of frames is 0 or more than 10,000.
    Motion(const Skeleton& tree, std::optional<Keyframes> keys, const AnimationOptions& options);

    double seconds() const {
        return seconds_;
    }                                      ///< [s] duration: as specified, otherwise that of the keys, or 4
    double rate() const { return rate_; }  ///< [1/s] frame rate
    std::size_t frames() const {
        return frames_;
    }  ///< number of frames; with keys, including the last moment
    std::size_t keys() const { return keys_ ? keys_->size() : 0; }  ///< number of keys
    double time(std::size_t frame) const {
        return static_cast<double>(frame) / rate_;
    }                            ///< [s] time of a frame
    Pose at(double time) const;  ///< pose at a time [s]; O(n) for each active edit

  private:
    Pose rest_;
    std::optional<Keyframes> keys_;
    double seconds_ = 0, rate_ = 1;
    std::size_t frames_ = 0;
    std::optional<Wind> wind_;
};

/// Duration and number of frames of a tree that grows.
struct GrowthFrames {
    double seconds = 0;      ///< [s] duration: as specified, or 4
    std::size_t frames = 0;  ///< number of frames; the last one shows the complete tree
};
GrowthFrames growth_frames(const AnimateOptions& options);  ///< throws InvalidInput as Motion does

/// Returns the properties of the frames of a motion that sinks require; refers to the mesh.
FrameSeries make_series(const SkinnedMesh& mesh, const Motion& motion, const AnimationOptions& options);
/// The same for growth that ends with this surface.
FrameSeries make_series(const QuadMesh& last, const GrowthFrames& frames, const AnimationOptions& options);

/// A frame that differs from the requested pose, to avoid folded or crossing faces.
struct FrozenFrame {
    std::size_t frame = 0;  ///< index of the frame
    double time = 0;        ///< [s]
    /// number of nodes with the same position relative to their parents as in the previous frame
    std::uint32_t nodes = 0;
    bool whole_tree = false;      ///< whether no node moved
    std::uint64_t folded = 0;     ///< number of faces that would have folded
    std::uint64_t crossings = 0;  ///< number of pairs of faces that would have crossed
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const FrozenFrame& r, Visitor&& visit) {
    visit("frame", r.frame);
    visit("time", r.time);
    visit("frozen_nodes", r.nodes);
    visit("whole_tree", r.whole_tree);
    visit("folded", r.folded);
    visit("crossings", r.crossings);
}

/// Statistics of the frames of a motion.
struct MotionReport {
    std::uint64_t frozen = 0;         ///< number of frozen frames
    std::uint64_t wholly_frozen = 0;  ///< number of frames in which no node moved
    std::uint64_t folded = 0;         ///< number of faces that would have folded, in all frames
    std::uint64_t crossings = 0;      ///< number of pairs of faces that would have crossed
    std::uint64_t not_converged = 0;  ///< number of vertices that did not converge to the field
    std::vector<FrozenFrame> first;   ///< the first 100 frozen frames
    double carrying = 0;              ///< [s] time without rendering and writing
};

/// Calls visit(name, value) for every figure, in order.
template <class Visitor>
void visit_figures(const MotionReport& r, Visitor&& visit) {
    visit("frames_frozen", r.frozen);
    visit("frames_wholly_frozen", r.wholly_frozen);
    visit("folds_avoided", r.folded);
    visit("crossings_avoided", r.crossings);
    visit("not_converged", r.not_converged);
    if (!r.first.empty()) visit("frozen", r.first);
}

/// Deforms the surface for all frames, each valid (see ValidFrames), passes them to every sink, and finishes
/// the sinks. Throws IoError, Cancelled.
MotionReport make_frames(SkinnedMesh& mesh, const Motion& motion, const FrameSinks& sinks,
                         const Context& ctx);

/// The same for a tree that grows. Returns the total number of pairs of crossing faces in all frames.
std::uint64_t make_frames(const Skeleton& tree, const GrowthFrames& frames, const AnimationOptions& options,
                          const FrameSinks& sinks, const Context& ctx);

/// "48 frames of 37,376 quads; 3 with frozen branches that would fold or intersect"
std::string to_text(const MotionReport& report, std::size_t frames, std::size_t quads);
/// "48 frames of a tree that grows to 37,376 quads"
std::string text_of_growth(std::size_t frames, std::size_t quads);

}  // namespace coppice
