#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/render/render.h"

namespace coppice::cli {

/// What all frames of an animation have in common.
struct FrameSeries {
    std::size_t count = 0;           ///< of frames
    double rate = 24;                ///< [1/s]
    const QuadMesh* rest = nullptr;  ///< whose faces all frames have; null where each has its own
    int gif_colors = 255;
    RenderOptions picture;      ///< how frames are drawn
    std::vector<Vec3d> framed;  ///< [m] points that all pictures show
};

/// A place that frames go to, in order.
class FrameSink {
  public:
    virtual ~FrameSink() = default;
    virtual void add(const QuadMesh& frame, const Context& ctx) = 0;  ///< the next one
    virtual void finish(const Context& ctx) = 0;                      ///< after the last one
};

/// Throws UsageError when the name is none that frames can be written to, IoError when its folder is not
/// there.
void check_frames_output(const std::filesystem::path& path, bool same_faces);

/// Whether the name is that of pictures, which are drawn.
bool is_drawn(const std::filesystem::path& path);

/// .png, .ply, .obj and .stl: a file for each frame, NAME_0000.png and so on; .gif: one picture that moves;
/// .glb and .usda: one mesh that moves.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const FrameSeries& series);

}  // namespace coppice::cli
