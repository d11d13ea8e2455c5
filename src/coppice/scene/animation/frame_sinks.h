#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/mesh.h"
#include "coppice/render/render.h"

namespace coppice {

/// Properties that all frames of an animation share.
struct FrameSeries {
    std::size_t count = 0;  ///< number of frames
    double rate = 24;       ///< [1/s] frame rate
    /// surface with the faces of all frames; null if each frame has its own faces
    const QuadMesh* rest = nullptr;
    TextureView texture;                   ///< of its corners; may be empty
    std::vector<MaterialFiles> materials;  ///< of frames with texture coordinates; may be empty
    /// index in `materials` of each face; empty: the first for all, as without `rest`
    std::span<const std::uint32_t> face_materials;
    int gif_colors = 255;       ///< maximum number of colours of a GIF
    RenderOptions picture;      ///< render options
    std::vector<Vec3d> framed;  ///< [m] points that all images show
};

/// The surface of a frame; refers to values of its maker.
struct SurfaceFrame {
    const QuadMesh& mesh;  ///< with the faces of the series, or its own
    TextureView texture;   ///< of its corners; may be empty
};

/// A consumer of frames, in order. Without finish(), a sink that writes one file leaves none.
class FrameSink {
  public:
    virtual ~FrameSink() = default;
    virtual void add(const SurfaceFrame& frame,
                     const Context& ctx) = 0;  ///< adds the next frame; throws IoError
    virtual void finish(
        const Context& ctx) = 0;  ///< completes the output after the last frame; throws IoError
};

using FrameSinks = std::vector<std::unique_ptr<FrameSink>>;  ///< each of them receives every frame

/// Throws InvalidInput if frames cannot be written to a file of this name, Unsupported for a video if there
/// is no program to encode it.
void check_frames_name(const std::filesystem::path& path, bool same_faces);

/// Returns the files to which `count` frames are written: one, or one per frame.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& path, std::size_t count);

/// Creates the sink for a file name. .png, .ply, .obj and .stl: a file per frame, NAME_0000.png and so on;
/// .gif: an animated image; .mp4, .mov, .mkv and .webm: a video encoded by ffmpeg; .glb and .usda: an
/// animated mesh. All but .ply and .stl show the materials. `rest`, `texture` and `face_materials` of the
/// series must outlive the sink. Throws IoError.
std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const FrameSeries& series);

/// Returns the maximum memory [bytes] of such a sink in addition to the frame passed to it.
double memory_of_sink(const std::filesystem::path& path, const FrameSeries& series, const QuadMesh& frame);

}  // namespace coppice
