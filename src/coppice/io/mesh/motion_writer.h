#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "coppice/base/context.h"
#include "coppice/mesh/mesh.h"

namespace coppice {

/// Writes a surface that moves, with the same faces in all frames, to one file, which appears whole or not at
/// all:
///
/// * USDA: the points as time samples, a time code for each frame; without normals. Frames go to the file one
/// by one.
/// * GLB: a morph target with normals for each frame, and an animation that plays them one after the other.
/// All frames
///   are held until the end: 12 bytes for each vertex of each.
///
/// For the rest as write_mesh().
class MotionWriter {
  public:
    /// `rest` gives the faces, and the shape before the motion; it must outlive this. `rate`: frames a
    /// second. Throws IoError for trouble with the file, Unsupported for names of other kinds.
    MotionWriter(const std::filesystem::path& path, const QuadMesh& rest, std::size_t frames, double rate);
    ~MotionWriter();                                        ///< without finish() nothing is left
    MotionWriter(const MotionWriter&) = delete;             ///< a file is one
    MotionWriter& operator=(const MotionWriter&) = delete;  ///< a file is one

    /// The next frame: a place for every vertex. Throws InvalidInput for places that are not finite.
    void add(std::span<const Vec3> positions, const Context& ctx = {});
    /// After the last of as many frames as were said. Throws Unsupported for a GLB of more than 4 GiB.
    void finish(const Context& ctx = {});

    /// What the writers of the formats have in common.
    class Format;

  private:
    std::filesystem::path path_;
    const QuadMesh& rest_;
    std::size_t missing_;  ///< frames to come
    std::unique_ptr<Format> format_;
};

/// Writes frames that each have faces of their own as USDA, in which they are time samples as the points are.
/// Errors as above.
void write_changing_mesh(const std::filesystem::path& path, std::span<const QuadMesh> frames, double rate,
                         const Context& ctx = {});

}  // namespace coppice
