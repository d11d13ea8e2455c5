#include "coppice/io_mesh/motion_internal.h"
#include "coppice/io_mesh/usda_parts_internal.h"

namespace coppice {
namespace io_internal {
namespace {

std::string time_lines(std::size_t frames, double rate) {
    return fmt::format(
        "    startTimeCode = 0\n    endTimeCode = {}\n    timeCodesPerSecond = {}\n    framesPerSecond = "
        "{}\n",
        frames - 1, rate, rate);
}

void put_points(AtomicFile& file, std::span<const Vec3> points, const Context& ctx) {
    write_list(file, points.size(), {0, 1}, ctx,
               [&](std::size_t v, Chunk& chunk) { put_tuple(chunk, points[v]); });
}

void put_face_sizes(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    write_list(file, mesh.face_count, {0, 1}, ctx, [&](std::size_t f, Chunk& chunk) {
        chunk.reserve(Chunk::kNumber);
        chunk.put_number(mesh.face(f).size());
    });
}

void put_corners(AtomicFile& file, const MeshView& mesh, const Context& ctx) {
    write_list(file, mesh.first_corner(mesh.face_count), {0, 1}, ctx, [&](std::size_t i, Chunk& chunk) {
        chunk.reserve(Chunk::kNumber);
        chunk.put_number(mesh.corners[i]);
    });
}

/// Writes `name`.timeSamples = { 0: ..., 1: ... }
template <class Put>
void write_samples(AtomicFile& file, std::string_view name, std::size_t frames, const Put& put) {
    file.write(fmt::format("        {}.timeSamples = {{\n", name));
    for (std::size_t i = 0; i < frames; ++i) {
        file.write(fmt::format("            {}: ", i));
        put(i);
        file.write(",\n");
    }
    file.write("        }\n");
}

/// Writes the texture coordinates of each frame.
void write_textures(AtomicFile& file, std::span<const Texture> textures, const Context& ctx) {
    const auto write = [&](std::string_view name, const auto& put) {
        file.write(
            fmt::format("        {} (\n            interpolation = \"faceVarying\"\n        )\n", name));
        write_samples(file, name, textures.size(), [&](std::size_t frame) {
            const Texture& texture = textures[frame];
            write_list(file, texture.points.size(), {0, 1}, ctx,
                       [&](std::size_t i, Chunk& chunk) { put(texture, i, chunk); });
        });
    };
    write("texCoord2f[] primvars:st",
          [](const Texture& t, std::size_t i, Chunk& chunk) { put_tuple(chunk, t.points[i]); });
    if (textures.front().blends.empty()) return;
    write("texCoord2f[] primvars:st1",
          [](const Texture& t, std::size_t i, Chunk& chunk) { put_tuple(chunk, t.blends[i].second); });
    write("float[] primvars:blend",
          [](const Texture& t, std::size_t i, Chunk& chunk) { put_weight(chunk, t.blends[i]); });
}

class UsdaMotion : public MotionWriter::Format {
  public:
    UsdaMotion(const MeshView& rest, std::size_t frames, double rate)
        : file_(rest.path), rest_(rest), frames_(frames), rate_(rate) {}

    void add(std::span<const Vec3> positions, const Context& ctx) override {
        if (extents_.empty()) write_faces(ctx);
        file_.write(fmt::format("            {}: ", extents_.size()));
        put_points(file_, positions, ctx);
        file_.write(",\n");
        extents_.push_back(extent_text(positions));
    }
    void finish(const Context& ctx) override {
        file_.write("        }\n");
        write_samples(file_, "float3[] extent", extents_.size(),
                      [&](std::size_t i) { file_.write(extents_[i]); });
        write_tail(file_, rest_, Subdivision::none, ctx);
        file_.commit();
    }

  private:
    void write_faces(const Context& ctx) {
        write_head(file_, rest_, time_lines(frames_, rate_));
        file_.write("        int[] faceVertexCounts = ");
        put_face_sizes(file_, rest_, ctx);
        file_.write("\n        int[] faceVertexIndices = ");
        put_corners(file_, rest_, ctx);
        file_.write("\n");
        write_texture(file_, rest_, ctx);
        file_.write("        point3f[] points.timeSamples = {\n");
    }

    AtomicFile file_;
    MeshView rest_;
    std::size_t frames_;
    double rate_;
    std::vector<std::string> extents_;
};

}  // namespace

std::unique_ptr<MotionWriter::Format> usda_motion(const MeshView& rest, std::size_t frames, double rate) {
    return std::make_unique<UsdaMotion>(rest, frames, rate);
}

}  // namespace io_internal

void write_changing_mesh(const std::filesystem::path& path, std::span<const QuadMesh> frames, double rate,
                         std::span<const Texture> textures, const MaterialFiles& material,
                         const Context& ctx) {
    using namespace io_internal;
    if (frames.empty())
        throw InvalidInput(fmt::format("cannot write {}: there are no frames", path.string()));
    COPPICE_ASSERT(textures.empty() || textures.size() == frames.size());
    MeshView first(frames.front());
    first.path = path;
    if (!textures.empty() && !material.empty()) first.materials = {&material, 1};
    AtomicFile file(path);
    write_head(file, first, time_lines(frames.size(), rate));
    write_samples(file, "int[] faceVertexCounts", frames.size(),
                  [&](std::size_t i) { put_face_sizes(file, MeshView(frames[i]), ctx); });
    write_samples(file, "int[] faceVertexIndices", frames.size(),
                  [&](std::size_t i) { put_corners(file, MeshView(frames[i]), ctx); });
    write_samples(file, "point3f[] points", frames.size(),
                  [&](std::size_t i) { put_points(file, frames[i].positions, ctx); });
    write_samples(file, "float3[] extent", frames.size(),
                  [&](std::size_t i) { file.write(extent_text(frames[i].positions)); });
    if (!textures.empty()) write_textures(file, textures, ctx);
    write_tail(file, first, Subdivision::none, ctx);
    file.commit();
}

}  // namespace coppice
