#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"
#include "coppice/render/render.h"

namespace coppice {

/// What all frames of an animation have in common.
struct FrameSeries {
    std::size_t count = 0;           ///< of frames
    double rate = 24;                ///< [1/s]
    const QuadMesh* rest = nullptr;  ///< whose faces all frames have; null where each has its own
    int gif_colors = 255;            ///< of a GIF at most
    RenderOptions picture;           ///< how frames are drawn
    std::vector<Vec3d> framed;       ///< [m] points that all pictures show
};

/// A place that frames go to, in order. Without finish() nothing is left of those that are one file.
class FrameSink {
  public:
    virtual ~FrameSink() = default;
    virtual void add(const QuadMesh& frame, const Context& ctx) = 0;  ///< the next one; throws IoError
    virtual void finish(const Context& ctx) = 0;                      ///< after the last one; throws IoError
};

using FrameSinks = std::vector<std::unique_ptr<FrameSink>>;  ///< all of which get every frame

/// Throws InvalidInput when the name is none that frames can be written to, Unsupported for a film where
/// there is no program that makes films.
void check_frames_name(const std::filesystem::path& path, bool same_faces);

/// The files that so many frames are written to: one, or one for each frame.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& path, std::size_t count);

/// .png, .ply, .obj and .stl: a file for each frame, NAME_0000.png and so on; .gif: one picture that moves;
/// .mp4, .mov, .mkv and .webm: a film by ffmpeg; .glb and .usda: one mesh that moves. Of the series `rest`
/// must outlive the sink. Throws IoError.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const FrameSeries& series);

/// [bytes] that such a sink takes at most beside the frame that it is given.
double memory_of_sink(const std::filesystem::path& path, const FrameSeries& series, const QuadMesh& frame);

}  // namespace coppice
