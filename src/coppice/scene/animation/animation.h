#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "coppice/animate/animate_options.h"
#include "coppice/animate/growing.h"
#include "coppice/animate/wind.h"
#include "coppice/base/context.h"
#include "coppice/pipeline/carry/carried_mesh.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/render/render.h"
#include "coppice/scene/animation/frame_sinks.h"
#include "coppice/scene/keyframes.h"

namespace coppice {

/// How a tree moves, and what its surface and its pictures are like.
struct AnimationOptions {
    bool grow = false;       ///< grows up from its root, with a surface of its own in every frame
    AnimateOptions run;      ///< how long, and how many frames
    GrowingOptions growing;  ///< for `grow`
    WindOptions wind;        ///< sways it where it has a speed
    MeshOptions mesh;        ///< the surface
    RenderOptions picture;   ///< of frames that are drawn
};

/// Throws InvalidInput where nothing would move, or where a tree that grows is to do what it cannot.
void check_animation(const AnimationOptions& options, bool has_keys);

/// A motion of a tree by keys, in the wind, or both.
class Motion {
  public:
    /// Throws InvalidInput for options out of range, for no frame at all and for more than 10,000.
    Motion(const Skeleton& tree, std::optional<Keyframes> keys, const AnimationOptions& options);

    double seconds() const { return seconds_; }  ///< that it lasts: as asked, else as long as its keys, or 4
    double rate() const { return rate_; }        ///< [1/s] frames
    std::size_t frames() const { return frames_; }                  ///< of keys the last moment is one, too
    std::size_t keys() const { return keys_ ? keys_->size() : 0; }  ///< number of them
    double time(std::size_t frame) const { return static_cast<double>(frame) / rate_; }  ///< [s]
    Pose at(double time) const;  ///< the pose at a time [s]; O(n) for each edit that is on its way

  private:
    Pose rest_;
    std::optional<Keyframes> keys_;
    double seconds_ = 0, rate_ = 1;
    std::size_t frames_ = 0;
    std::optional<Wind> wind_;
};

/// Frames of a tree that grows, and how long that takes.
struct GrowthFrames {
    double seconds = 0;      ///< as asked, or 4
    std::size_t frames = 0;  ///< the last one shows the whole tree
};
GrowthFrames growth_frames(const AnimateOptions& options);  ///< throws InvalidInput as Motion

/// What sinks need to know of the frames of a motion; refers to the mesh.
FrameSeries series_of(const CarriedMesh& mesh, const Motion& motion, const AnimationOptions& options);
/// The same of growth that ends in this surface.
FrameSeries series_of(const QuadMesh& last, const GrowthFrames& frames, const AnimationOptions& options);

/// A frame that is not as it was wanted.
struct HeldFrame {
    std::size_t frame = 0;        ///< number of it
    double time = 0;              ///< [s]
    std::uint32_t nodes = 0;      ///< that stand to their parents as in the frame before
    bool whole_tree = false;      ///< nothing moved
    std::uint64_t folded = 0;     ///< faces that would have folded
    std::uint64_t crossings = 0;  ///< pairs of faces that would have crossed
};

/// What became of the frames of a motion.
struct MotionReport {
    std::uint64_t held = 0;           ///< frames
    std::uint64_t wholly_held = 0;    ///< frames
    std::uint64_t folded = 0;         ///< faces that would have folded, in all frames
    std::uint64_t crossings = 0;      ///< pairs of faces that would have crossed
    std::uint64_t not_converged = 0;  ///< vertices that did not reach the field
    std::vector<HeldFrame> first;     ///< the first 100 that were held
    double carrying = 0;              ///< [s] without drawing and writing
};

/// Carries the surface through all frames, every one sound (see SoundFrames), to every sink, and finishes
/// these. Throws IoError, Cancelled.
MotionReport make_frames(CarriedMesh& mesh, const Motion& motion, const FrameSinks& sinks,
                         const Context& ctx);

/// The same of a tree that grows. Returns how many pairs of faces cross in all frames together.
std::uint64_t make_frames(const Skeleton& tree, const GrowthFrames& frames, const AnimationOptions& options,
                          const FrameSinks& sinks, const Context& ctx);

/// "48 frames of 37,376 quads; 3 held back where branches would fold or cross"
std::string text_of(const MotionReport& report, std::size_t frames, std::size_t quads);
/// "48 frames of a tree that grows to 37,376 quads"
std::string text_of_growth(std::size_t frames, std::size_t quads);

}  // namespace coppice
