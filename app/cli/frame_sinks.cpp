#include "frame_sinks.h"

#include <fmt/format.h>

#include <optional>

#include "coppice/io/file.h"
#include "coppice/io/mesh/motion_writer.h"
#include "coppice/io/mesh/writer.h"
#include "coppice/render/gif.h"
#include "files.h"
#include "film.h"
#include "options.h"
#include "pictures.h"

namespace coppice::cli {
namespace {

bool is_gif_name(const std::filesystem::path& path) {
    return path.extension() == ".gif" || path.extension() == ".GIF";
}

std::filesystem::path numbered(const std::filesystem::path& path, std::size_t frame) {
    return path.parent_path() /
           fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string());
}

Image drawn(const QuadMesh& frame, const FrameSeries& series, const Context& ctx) {
    const PolygonMesh mesh = to_polygons(frame);
    return render({.mesh = &mesh, .framed = series.framed}, series.picture, ctx);
}

class MeshFiles : public FrameSink {
  public:
    explicit MeshFiles(std::filesystem::path path) : path_(std::move(path)) {}
    void add(const QuadMesh& frame, const Context& ctx) override {
        write_mesh(numbered(path_, next_++), frame, {}, ctx);
    }
    void finish(const Context&) override {}

  private:
    std::filesystem::path path_;
    std::size_t next_ = 0;
};

class PictureFiles : public FrameSink {
  public:
    PictureFiles(std::filesystem::path path, const FrameSeries& series)
        : path_(std::move(path)), series_(series) {}
    void add(const QuadMesh& frame, const Context& ctx) override {
        write_picture(numbered(path_, next_++), drawn(frame, series_, ctx));
    }
    void finish(const Context&) override {}

  private:
    std::filesystem::path path_;
    FrameSeries series_;
    std::size_t next_ = 0;
};

class GifFile : public FrameSink {
  public:
    GifFile(const std::filesystem::path& path, const FrameSeries& series) : file_(path), series_(series) {}
    void add(const QuadMesh& frame, const Context& ctx) override {
        const Image picture = drawn(frame, series_, ctx);
        if (!encoder_) {
            encoder_.emplace(picture, 1 / series_.rate, series_.gif_colors);
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
    FrameSeries series_;
    std::optional<GifEncoder> encoder_;
};

class FilmFile : public FrameSink {
  public:
    FilmFile(const std::filesystem::path& path, const FrameSeries& series)
        : film_(path, series.rate), series_(series) {}
    void add(const QuadMesh& frame, const Context& ctx) override { film_.add(drawn(frame, series_, ctx)); }
    void finish(const Context&) override { film_.finish(); }

  private:
    Film film_;
    FrameSeries series_;
};

class MovingMeshFile : public FrameSink {
  public:
    MovingMeshFile(const std::filesystem::path& path, const FrameSeries& series)
        : writer_(path, *series.rest, series.count, series.rate) {}
    void add(const QuadMesh& frame, const Context& ctx) override { writer_.add(frame.positions, ctx); }
    void finish(const Context& ctx) override { writer_.finish(ctx); }

  private:
    MotionWriter writer_;
};

class ChangingMeshFile : public FrameSink {
  public:
    ChangingMeshFile(std::filesystem::path path, const FrameSeries& series)
        : path_(std::move(path)), rate_(series.rate) {}
    void add(const QuadMesh& frame, const Context&) override { frames_.push_back(frame); }
    void finish(const Context& ctx) override { write_changing_mesh(path_, frames_, rate_, ctx); }

  private:
    std::filesystem::path path_;
    double rate_;
    std::vector<QuadMesh> frames_;
};

}  // namespace

bool is_drawn(const std::filesystem::path& path) {
    return is_picture_name(path) || is_gif_name(path) || is_film_name(path);
}

void check_frames_output(const std::filesystem::path& path, bool same_faces) {
    if (is_film_name(path)) check_film_program();
    if (is_drawn(path)) return check_output_folder(path);
    if (!mesh_format_of_name(path)) {
        throw UsageError(
            fmt::format("'{}' is no name for frames; use .png, .ply, .obj or .stl for a file each, .gif for "
                        "one that moves, or .glb or "
                        ".usda for all in one",
                        path.string()));
    }
    if (!same_faces && mesh_format_of_name(path) == MeshFormat::glb) {
        throw UsageError(
            fmt::format("'{}': a GLB has the same faces in all frames, which growing trees have not; write "
                        ".usda, or .ply for a file each",
                        path.string()));
    }
    check_output_folder(path);
}

std::unique_ptr<FrameSink> open_sink(const std::filesystem::path& path, const FrameSeries& series) {
    if (is_gif_name(path)) return std::make_unique<GifFile>(path, series);
    if (is_film_name(path)) return std::make_unique<FilmFile>(path, series);
    if (is_picture_name(path)) return std::make_unique<PictureFiles>(path, series);
    const auto format = mesh_format_of_name(path);
    if (format != MeshFormat::glb && format != MeshFormat::usda) return std::make_unique<MeshFiles>(path);
    if (series.rest == nullptr) return std::make_unique<ChangingMeshFile>(path, series);
    return std::make_unique<MovingMeshFile>(path, series);
}

}  // namespace coppice::cli
