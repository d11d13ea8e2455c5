#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/progress.h"
#include "coppice/scene/animation/animation.h"
#include "coppice/scene/drawn_material.h"
#include "coppice/scene/mesh_memory.h"
#include "coppice/studio/session_internal.h"

namespace coppice::studio_internal {
namespace {

namespace fs = std::filesystem;

constexpr float kShareOfMesh = 0.1f;  // fraction of the progress of an animation
constexpr double kReusedShare = 2;    // memory of a deformed surface, relative to that of computing it

/// Returns prefixed names of members: "wind_speed".
template <class Options>
std::map<std::string, std::string> prefixed(const std::string& path, const std::string& prefix) {
    std::map<std::string, std::string> names;
    Options options;
    visit_members(option_fields(options), path, [&](const std::string& at, const OptionField& member) {
        names[at] = fmt::format("{}_{}", prefix, member.field.name);
    });
    return names;
}

/// Returns the options of `coppice animate` as a scene command.
SceneCommand animation_command() {
    SceneCommand c{.name = "animate"};
    c.arguments = {{.name = "grow",
                    .help = "Let the tree grow from its root.",
                    .type = ArgumentType::flag,
                    .initial = "false"}};
    add_options(c.arguments, AnimateOptions{}, "run");
    add_options(c.arguments, GrowingOptions{}, "growing", {}, prefixed<GrowingOptions>("growing", "grow"));
    add_options(c.arguments, WindOptions{}, "wind", {}, prefixed<WindOptions>("wind", "wind"));
    add_options(c.arguments, MeshOptions{}, "mesh", {},
                {{"mesh.project.method", "project_method"}, {"mesh.project.tolerance", "project_tolerance"}});
    add_options(c.arguments, RenderOptions{}, "picture");
    return c;
}

std::vector<SceneWord> to_words(const Json& options) {
    std::vector<SceneWord> words;
    for (const auto& [name, value] : options.items())
        words.push_back({name, value.is_string() ? value.get<std::string>() : value.dump()});
    return words;
}

/// The motion that a request describes.
class MotionRequest {
  public:
    MotionRequest(const Studio& studio, const Request& request)
        : studio_(studio),
          ctx_(request.ctx),
          name_(request.text("name")),
          object_(studio.object(ObjectKind::skeleton, name_)),
          keys_(request.text("keys", "")),
          words_(to_words(request.fields.value("options", Json::object()))),
          call_(bind_command(table(), words_, studio.document.scene().state(),
                             studio.document.scene().settings(), ctx_)) {
        options_.grow = call_.flag("grow");
        options_.run = call_.options<AnimateOptions>("run");
        options_.growing = call_.options<GrowingOptions>("growing");
        options_.wind = call_.options<WindOptions>("wind");
        options_.mesh = call_.options<MeshOptions>("mesh");
        options_.picture = call_.options<RenderOptions>("picture");
        if (const std::string material = request.text("material", ""); !material.empty())
            use(studio.object(ObjectKind::material, material));
        check_animation(options_, has_keys());
    }

    const std::string& name() const { return name_; }
    const ObjectPtr& object() const { return object_; }
    const ObjectPtr& material() const { return material_; }  ///< null without one
    const Skeleton& tree() const { return std::get<Skeleton>(object_->value); }
    const AnimationOptions& options() const { return options_; }
    /// Equal for two requests of the same motion of equal trees.
    std::string text() const { return call_.typed() + "\n" + keys_; }
    void reserve(double bytes) const { call_.reserve(bytes); }
    /// Returns the material of the surface; none without one.
    std::vector<SurfaceMaterial> materials() const {
        if (!material_) return {};
        return {std::get<SurfaceMaterial>(material_->value)};
    }
    /// Returns the images of the material for a file; none without a material.
    MaterialFiles images(const fs::path& file) const {
        if (!material_) return {};
        const auto& material = std::get<SurfaceMaterial>(material_->value);
        if (material.bark) reserve(kBytesOfDrawnTexel * static_cast<double>(material.bark->size()));
        return write_images(material, file, ctx_);
    }

    Motion motion() const {
        std::optional<Keyframes> keys;
        if (has_keys()) keys.emplace(tree(), keys_, "key", studio_.options.scene, ctx_);
        return Motion(tree(), std::move(keys), options_);
    }
    SkinnedMesh carried(const Context& ctx) const {
        reserve(kReusedShare * memory_of_mesh(tree(), options_.mesh));
        return SkinnedMesh(tree(), options_.mesh, ctx);
    }
    MeshResult grown(const Skeleton& tree, const Context& ctx) const {
        reserve(memory_of_mesh(tree, options_.mesh));
        return mesh_skeleton(tree, options_.mesh, ctx);
    }

  private:
    static const SceneCommand& table() {
        static const SceneCommand command = animation_command();
        return command;
    }
    /// Gives the surface the bark of a material.
    void use(ObjectPtr material) {
        material_ = std::move(material);
        TextureOptions& texture = options_.mesh.texture;
        texture.coordinates = TextureCoordinates::bark;
        if (const auto tile = std::get<SurfaceMaterial>(material_->value).tile) {
            texture.tile = tile->width;
            texture.tile_height = tile->height;
        }
    }
    bool has_keys() const { return keys_.find_first_not_of(" \t\r\n") != std::string::npos; }

    const Studio& studio_;
    const Context& ctx_;
    std::string name_;
    ObjectPtr object_, material_;  ///< `material_` may be null
    std::string keys_;
    std::vector<SceneWord> words_;
    SceneCall call_;
    AnimationOptions options_;
};

/// The files of frames. Files that did not exist before are removed if the frames are not completed.
class FrameFiles {
  public:
    FrameFiles(const Studio& studio, const Request& request, std::size_t count)
        : names_(frame_files(request.text("file"), count)),
          path_(studio.sandbox().to_write(request.text("file"))) {
        std::error_code ignored;
        for (const fs::path& name : names_) {
            paths_.push_back(path_to_write(studio, request, name.generic_string()));
            if (!fs::exists(paths_.back(), ignored)) new_.push_back(paths_.back());
        }
    }
    ~FrameFiles() {
        std::error_code ignored;
        for (const fs::path& path : new_) fs::remove(path, ignored);
    }
    FrameFiles(const FrameFiles&) = delete;
    FrameFiles& operator=(const FrameFiles&) = delete;

    const fs::path& path() const { return path_; }  ///< name passed to the sink
    Json written() {
        new_.clear();
        Json names = Json::array();
        std::uintmax_t bytes = 0;
        std::error_code ignored;
        for (std::size_t i = 0; i < names_.size(); ++i) {
            names.push_back(names_[i].generic_string());
            bytes += fs::file_size(paths_[i], ignored);
        }
        return {{"files", names}, {"file", names.front()}, {"bytes", bytes}};
    }

  private:
    std::vector<fs::path> names_;
    fs::path path_;
    std::vector<fs::path> paths_, new_;
};

FrameSinks sinks_to(const FrameFiles& files, FrameSeries series, const QuadMesh& frame,
                    const MotionRequest& motion_request) {
    series.materials = {motion_request.images(files.path())};
    motion_request.reserve(memory_of_sink(files.path(), series, frame));
    FrameSinks sinks;
    sinks.push_back(open_sink(files.path(), series));
    return sinks;
}

Json animate_growth(const Studio& studio, const Request& request, const MotionRequest& motion_request) {
    const GrowthFrames frames = growth_frames(motion_request.options().run);
    FrameFiles files(studio, request, frames.frames);
    const MeshResult last =
        motion_request.grown(motion_request.tree(), narrow_progress(request.ctx, 0, kShareOfMesh));
    const QuadMesh& surface = last.quads().mesh;
    const FrameSeries series = make_series(surface, frames, motion_request.options());
    const FrameSinks sinks = sinks_to(files, series, surface, motion_request);
    make_frames(motion_request.tree(), frames, motion_request.options(), sinks,
                narrow_progress(request.ctx, kShareOfMesh, 1));
    Json out = files.written();
    out["frames"] = frames.frames;
    out["frozen"] = 0;
    out["message"] = text_of_growth(frames.frames, surface.quads.size());
    return out;
}

Json animate_motion(const Studio& studio, const Request& request, const MotionRequest& motion_request) {
    const Motion motion = motion_request.motion();
    FrameFiles files(studio, request, motion.frames());
    SkinnedMesh mesh = motion_request.carried(narrow_progress(request.ctx, 0, kShareOfMesh));
    const FrameSeries series = make_series(mesh, motion, motion_request.options());
    const FrameSinks sinks = sinks_to(files, series, *series.rest, motion_request);
    const MotionReport report =
        make_frames(mesh, motion, sinks, narrow_progress(request.ctx, kShareOfMesh, 1));
    Json out = files.written();
    out["frames"] = motion.frames();
    out["frozen"] = report.frozen;
    out["message"] = to_text(report, motion.frames(), series.rest->quads.size());
    return out;
}

/// Writes an animation of a tree, as `coppice animate` does.
Json animate(Studio& studio, const Request& request) {
    const MotionRequest motion_request(studio, request);
    const bool grows = motion_request.options().grow;
    check_frames_name(request.text("file"), !grows);
    return grows ? animate_growth(studio, request, motion_request)
                 : animate_motion(studio, request, motion_request);
}

}  // namespace

/// A motion for display, ready to evaluate at any time.
class CachedMotion {
  public:
    CachedMotion(const MotionRequest& motion_request, const Context& ctx)
        : object_(motion_request.object()),
          material_(motion_request.material()),
          text_(motion_request.text()) {
        if (motion_request.options().grow) {
            const GrowthFrames frames = growth_frames(motion_request.options().run);
            seconds_ = frames.seconds;
            frames_ = frames.frames;
            growing_.emplace(motion_request.tree(), motion_request.options().growing);
        } else {
            motion_ = motion_request.motion();
            seconds_ = motion_->seconds();
            frames_ = motion_->frames();
            mesh_ = motion_request.carried(ctx);
        }
    }

    bool matches(const MotionRequest& motion_request) const {
        return object_ == motion_request.object() && material_ == motion_request.material() &&
               text_ == motion_request.text();
    }
    double seconds() const { return seconds_; }
    std::size_t frames() const { return frames_; }

    /// Folds and crossings of branches are not prevented: that requires all previous frames, as in a film.
    Surface at(double time, const MotionRequest& motion_request, const Context& ctx) {
        if (growing_) {
            MeshResult made = motion_request.grown(growing_->at(time / seconds_), ctx);
            return make_surface(std::move(made.quads().mesh), made, motion_request);
        }
        QuadMesh moved = mesh_->made().quads().mesh;
        moved.positions = mesh_->deform(motion_->at(time), {}, ctx).positions;
        return make_surface(std::move(moved), mesh_->made(), motion_request);
    }

  private:
    static Surface make_surface(QuadMesh mesh, const MeshResult& made, const MotionRequest& motion_request) {
        Surface out{.mesh = std::move(mesh), .materials = motion_request.materials()};
        if (made.texture) out.texture = made.texture->points;
        return out;
    }

    ObjectPtr object_, material_;  ///< `material_` may be null
    std::string text_;
    double seconds_ = 0;
    std::size_t frames_ = 0;
    std::optional<Motion> motion_;
    std::optional<SkinnedMesh> mesh_;
    std::optional<GrowingTree> growing_;
};

namespace {

/// Returns the surface of an animated tree at one time, and the images of its bark.
Json frame(Studio& studio, const Request& request) {
    const MotionRequest motion_request(studio, request);
    if (!studio.motion || !studio.motion->matches(motion_request)) {
        studio.motion.reset();  // released before the next one allocates memory
        studio.motion = std::make_shared<CachedMotion>(motion_request, request.ctx);
    }
    CachedMotion& motion = *studio.motion;
    const double time = std::clamp(request.number("time"), 0.0, motion.seconds());
    const SceneObject object{motion.at(time, motion_request, request.ctx), 0};
    const GeometryHead head{
        ObjectKind::skeleton, motion_request.name(), studio.notes.of(motion_request.object()).version, {}};
    std::string blob = encode_object(object, head, 1, StudioColor::plain, request.ctx);
    return {{"key", studio.blobs.offer(std::move(blob))},
            {"images", offer_images(studio, motion_request.materials())},
            {"time", time},
            {"duration", motion.seconds()},
            {"frames", motion.frames()}};
}

}  // namespace

std::map<std::string, Handler> motion_requests() { return {{"animate", animate}, {"frame", frame}}; }

}  // namespace coppice::studio_internal
