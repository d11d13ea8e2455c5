#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/io_mesh/material.h"
#include "coppice/mesh/mesh.h"
#include "coppice/mesh/texture.h"

namespace coppice {

/// The bark of an animated surface.
struct MotionTexture {
    TextureView coordinates;                        ///< may be empty
    std::vector<MaterialFiles> materials;           ///< as in MeshWriteOptions
    std::span<const std::uint32_t> face_materials;  ///< as in MeshWriteOptions
};

/// Writes an animated surface, with the same faces in all frames, to one file atomically:
///
/// * USDA: the points as time samples, one time code for each frame; without normals. Each frame is written
/// immediately.
/// * GLB: a morph target with normals, and with tangents if there is a normal map, for each frame, and an
/// animation that plays them in sequence. All frames are stored until the end: 12 bytes for each vertex and
/// frame.
///
/// Otherwise like write_mesh().
class MotionWriter {
  public:
    /// `rest` provides the faces and the rest shape; it and the texture must outlive this object. `rate`:
    /// frames per second. Throws IoError if the file cannot be written, Unsupported for other extensions.
    MotionWriter(const std::filesystem::path& path, const QuadMesh& rest, std::size_t frames, double rate,
                 MotionTexture texture = {});
    ~MotionWriter();                                        ///< removes the file unless finish() was called
    MotionWriter(const MotionWriter&) = delete;             ///< represents one file
    MotionWriter& operator=(const MotionWriter&) = delete;  ///< represents one file

    /// Adds the next frame: a position for every vertex. Throws InvalidInput for positions that are not
    /// finite.
    void add(std::span<const Vec3> positions, const Context& ctx = {});
    /// Completes the file after the specified number of frames. Throws Unsupported for a GLB of more than 4
    /// GiB.
    void finish(const Context& ctx = {});

    /// Interface of the writers of the formats.
    class Format;

  private:
    std::filesystem::path path_;
    const QuadMesh& rest_;
    MotionTexture texture_;
    std::size_t missing_;  ///< number of remaining frames
    std::unique_ptr<Format> format_;
};

/// Writes frames with different faces as USDA, with the faces as time samples like the points. `textures` are
/// the texture coordinates of each frame, or empty. Throws as above.
void write_changing_mesh(const std::filesystem::path& path, std::span<const QuadMesh> frames, double rate,
                         std::span<const Texture> textures = {}, const MaterialFiles& material = {},
                         const Context& ctx = {});

}  // namespace coppice
