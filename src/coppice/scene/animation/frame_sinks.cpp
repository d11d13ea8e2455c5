#include "coppice/scene/animation/frame_sinks.h"

#include <fmt/format.h>

#include <optional>

#include "coppice/base/error.h"
#include "coppice/io_mesh/motion_writer.h"
#include "coppice/io_mesh/writer.h"
#include "coppice/render/gif.h"
#include "coppice/render/png.h"
#include "coppice/scene/animation/film_internal.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/system/file.h"

namespace coppice {
namespace {

/// Output formats of frames.
enum class FrameForm { pictures, gif, film, meshes, moving_mesh };

std::optional<FrameForm> find_form(const std::filesystem::path& path) {
    if (is_png_name(path)) return FrameForm::pictures;
    if (path.extension() == ".gif" || path.extension() == ".GIF") return FrameForm::gif;
    if (is_film_name(path)) return FrameForm::film;
    const auto format = mesh_format_of_name(path);
    if (!format || *format == MeshFormat::off) return std::nullopt;
    const bool moves = *format == MeshFormat::glb || *format == MeshFormat::usda;
    return moves ? FrameForm::moving_mesh : FrameForm::meshes;
}

FrameForm known_form(const std::filesystem::path& path) {
    if (const auto form = find_form(path)) return *form;
    throw InvalidInput(
        fmt::format("'{}' is not a valid file name for frames; use .png, .ply, .obj or .stl for a file each, "
                    ".gif for one that moves, or .glb or .usda for all in one",
                    path.string()));
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t frame) {
    return path.parent_path() /
           fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string());
}

/// Draws frames with their material.
class Painter {
  public:
    explicit Painter(const FrameSeries& series)
        : series_(series), materials_(load_face_materials(series.materials, series.face_materials)) {}

    Image draw(const SurfaceFrame& frame, const Context& ctx) const {
        PolygonMesh mesh = to_polygons(frame.mesh);
        const auto& [points, blends] = frame.texture;
        mesh.texture.assign(points.begin(), points.end());
        mesh.texture_blends.assign(blends.begin(), blends.end());
        RenderScene scene{.mesh = &mesh, .framed = series_.framed};
        if (!mesh.texture.empty()) {
            scene.materials = materials_.materials;
            scene.face_materials = materials_.of_face;
        }
        return render(scene, series_.picture, ctx);
    }
    const FrameSeries& series() const { return series_; }

  private:
    FrameSeries series_;
    FaceMaterials materials_;
};

class MeshFiles : public FrameSink {
  public:
    MeshFiles(std::filesystem::path path, const FrameSeries& series)
        : path_(std::move(path)), materials_(series.materials), face_materials_(series.face_materials) {}
    void add(const SurfaceFrame& frame, const Context& ctx) override {
        const MeshWriteOptions options{.texture = frame.texture.points,
                                       .texture_blends = frame.texture.blends,
                                       .materials = materials_,
                                       .face_materials = face_materials_};
        write_mesh(numbered(path_, next_++), frame.mesh, options, ctx);
    }
    void finish(const Context&) override {}

  private:
    std::filesystem::path path_;
    std::vector<MaterialFiles> materials_;
    std::span<const std::uint32_t> face_materials_;
    std::size_t next_ = 0;
};

class PictureFiles : public FrameSink {
  public:
    PictureFiles(std::filesystem::path path, const FrameSeries& series)
        : path_(std::move(path)), painter_(series) {}
    void add(const SurfaceFrame& frame, const Context& ctx) override {
        write_file(numbered(path_, next_++), encode_png(painter_.draw(frame, ctx)));
    }
    void finish(const Context&) override {}

  private:
    std::filesystem::path path_;
    Painter painter_;
    std::size_t next_ = 0;
};

class GifFile : public FrameSink {
  public:
    GifFile(const std::filesystem::path& path, const FrameSeries& series) : file_(path), painter_(series) {}
    void add(const SurfaceFrame& frame, const Context& ctx) override {
        const Image picture = painter_.draw(frame, ctx);
        if (!encoder_) {
            encoder_.emplace(picture, 1 / painter_.series().rate, painter_.series().gif_colors);
            file_.write(encoder_->head());
        }
        file_.write(encoder_->add(picture));
    }
    void finish(const Context&) override {
        file_.write(GifEncoder::tail());
        file_.commit();
    }

  private:
    AtomicFile file_;
    Painter painter_;
    std::optional<GifEncoder> encoder_;
};

class FilmFile : public FrameSink {
  public:
    FilmFile(const std::filesystem::path& path, const FrameSeries& series)
        : film_(path, series.rate), painter_(series) {}
    void add(const SurfaceFrame& frame, const Context& ctx) override { film_.add(painter_.draw(frame, ctx)); }
    void finish(const Context&) override { film_.finish(); }

  private:
    Film film_;
    Painter painter_;
};

class MovingMeshFile : public FrameSink {
  public:
    MovingMeshFile(const std::filesystem::path& path, const FrameSeries& series)
        : writer_(path, *series.rest, series.count, series.rate,
                  {series.texture, series.materials, series.face_materials}) {}
    void add(const SurfaceFrame& frame, const Context& ctx) override {
        writer_.add(frame.mesh.positions, ctx);
    }
    void finish(const Context& ctx) override { writer_.finish(ctx); }

  private:
    MotionWriter writer_;
};

class ChangingMeshFile : public FrameSink {
  public:
    ChangingMeshFile(std::filesystem::path path, const FrameSeries& series)
        : path_(std::move(path)), rate_(series.rate) {
        if (!series.materials.empty()) material_ = series.materials.front();
    }
    void add(const SurfaceFrame& frame, const Context&) override {
        frames_.push_back(frame.mesh);
        const auto& [points, blends] = frame.texture;
        if (points.empty()) return;
        Texture& texture = textures_.emplace_back();
        texture.points.assign(points.begin(), points.end());
        texture.blends.assign(blends.begin(), blends.end());
    }
    void finish(const Context& ctx) override {
        write_changing_mesh(path_, frames_, rate_, textures_, material_, ctx);
    }

  private:
    std::filesystem::path path_;
    MaterialFiles material_;
    double rate_;
    std::vector<QuadMesh> frames_;
    std::vector<Texture> textures_;
};

}  // namespace

void check_frames_name(const std::filesystem::path& path, bool same_faces) {
    if (known_form(path) == FrameForm::film) check_film_program();
    if (!same_faces && mesh_format_of_name(path) == MeshFormat::glb) {
        throw InvalidInput(
            fmt::format("'{}': a GLB has the same faces in all frames, which growing trees do not; write "
                        ".usda, or .ply for a file each",
                        path.string()));
    }
}

std::vector<std::filesystem::path> frame_files(const std::filesystem::path& path, std::size_t count) {
    const FrameForm form = known_form(path);
    if (form != FrameForm::pictures && form != FrameForm::meshes) return {path};
    std::vector<std::filesystem::path> files;
    for (std::size_t i = 0; i < count; ++i) files.push_back(numbered(path, i));
    return files;
}

std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const FrameSeries& series) {
    switch (known_form(path)) {
        case FrameForm::pictures:
            return std::make_unique<PictureFiles>(path, series);
        case FrameForm::gif:
            return std::make_unique<GifFile>(path, series);
        case FrameForm::film:
            return std::make_unique<FilmFile>(path, series);
        case FrameForm::meshes:
            return std::make_unique<MeshFiles>(path, series);
        case FrameForm::moving_mesh:
            break;
    }
    if (series.rest == nullptr) return std::make_unique<ChangingMeshFile>(path, series);
    return std::make_unique<MovingMeshFile>(path, series);
}

double memory_of_sink(const std::filesystem::path& path, const FrameSeries& series, const QuadMesh& frame) {
    constexpr double kBytesOfPixel = 32, kBytesOfDrawnFace = 250;  // including the ray-casting structures
    const double vertices = static_cast<double>(frame.positions.size()),
                 faces = static_cast<double>(frame.quads.size()), count = static_cast<double>(series.count);
    const FrameForm form = known_form(path);
    if (form == FrameForm::meshes) return 0;
    if (form != FrameForm::moving_mesh)
        return kBytesOfPixel * series.picture.camera.width * series.picture.camera.height +
               kBytesOfDrawnFace * faces;
    if (series.rest == nullptr) return count * (sizeof(Vec3) * vertices + sizeof(Quad) * faces);
    return mesh_format_of_name(path) == MeshFormat::glb ? count * sizeof(Vec3) * vertices : 0;
}

}  // namespace coppice
