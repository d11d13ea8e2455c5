#include "coppice/io_mesh/motion_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/io_mesh/format.h"
#include "coppice/io_mesh/material_internal.h"
#include "coppice/io_mesh/motion_internal.h"

namespace coppice {

MotionWriter::MotionWriter(const std::filesystem::path& path, const QuadMesh& rest, std::size_t frames,
                           double rate, MotionTexture texture)
    : path_(path), rest_(rest), texture_(std::move(texture)), missing_(frames) {
    const auto& [points, blends] = texture_.coordinates;
    COPPICE_ASSERT(points.empty() || points.size() == 4 * rest.quads.size());
    COPPICE_ASSERT(blends.empty() || blends.size() == points.size());
    io_internal::MeshView view(rest);
    view.path = path;
    view.texture = points;
    view.texture_blends = blends;
    io_internal::set_materials(view, texture_.materials, texture_.face_materials);
    const auto format = mesh_format_of_name(path);
    if (format == MeshFormat::glb) {
        format_ = io_internal::glb_motion(view, frames, rate);
    } else if (format == MeshFormat::usda) {
        format_ = io_internal::usda_motion(view, frames, rate);
    } else {
        throw Unsupported(fmt::format(
            "cannot write {}: an animated mesh must have the extension .glb or .usda", path.string()));
    }
    if (rest.quads.empty() || frames == 0)
        throw InvalidInput(fmt::format("cannot write {}: there are no faces, or no frames", path.string()));
}

MotionWriter::~MotionWriter() = default;

void MotionWriter::add(std::span<const Vec3> positions, const Context& ctx) {
    COPPICE_ASSERT(missing_ > 0 && positions.size() == rest_.positions.size());
    if (!std::ranges::all_of(positions, [](Vec3 p) { return is_finite(p); }))
        throw InvalidInput(fmt::format("cannot write {}: a vertex is not finite", path_.string()));
    --missing_;
    format_->add(positions, ctx);
}

void MotionWriter::finish(const Context& ctx) {
    COPPICE_ASSERT(missing_ == 0);
    try {
        format_->finish(ctx);
    } catch (const Unsupported& e) {
        throw Unsupported(fmt::format("cannot write {}: {}", path_.string(), e.what()));
    }
}

}  // namespace coppice
