#include <algorithm>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/scene/script/statements.h"
#include "coppice/scene/words.h"
#include "coppice/studio/requests/new_names_internal.h"
#include "coppice/studio/requests/surface_request_internal.h"

namespace coppice::studio_internal {
namespace {

// maximum number of nodes of a skeleton that is sent with every preview
constexpr std::uint32_t kMaxAxes = 40'000;

bool is_shape(ObjectKind kind) {
    return kind == ObjectKind::solid || kind == ObjectKind::path || kind == ObjectKind::profile;
}

/// Returns whether every command of a statement creates or changes only solids and their inputs.
bool shapes_solids(const std::string& text) {
    const std::vector<SceneLine> lines = scene_lines(text, "preview");
    const auto commands = find_commands(lines);
    return commands && !commands->empty() && std::ranges::all_of(*commands, [](const SceneCommand* c) {
               return c->makes && is_shape(*c->makes);
           });
}

/// The result of a line that is not in the document.
struct Preview {
    Scene scene;
    std::set<Document::Name> changed;  ///< objects that the line changed, or that depend on these
};

/// Runs the solid commands after the line again.
void follow_solids(const Studio& studio, std::size_t from, Preview& preview, const Context& ctx) {
    const auto statements = studio.document.statements();
    for (std::size_t k = from; k < studio.document.ran(); ++k) {
        const std::string& text = statements[k].text;
        if (!shapes_solids(text)) continue;
        const SceneObjects before = preview.scene.state().objects;
        const bool follows = std::ranges::any_of(
            preview.changed, [&](const Document::Name& name) { return mentions(text, name.second); });
        try {
            run_section(preview.scene, text, 1, "preview", ctx);
        } catch (const InvalidInput&) {
            continue;  // shown as far as it succeeds: running the line reports the error
        }
        if (!follows) continue;
        for (const Document::Name& name : changed_objects(before, preview.scene.state().objects))
            preview.changed.insert(name);
    }
}

Preview previewed(const Studio& studio, const Request& request) {
    const std::size_t at = studio.document.place_for(request.about());
    const auto before = studio.document.scene_behind(at, request.ctx);
    Preview preview{*before, {}};
    preview.scene.forbid_outputs();
    const NamedLine named = with_new_names(request.text("line"), studio.document.scene().state().objects);
    run_section(preview.scene, named.line, 1, "preview", request.ctx);
    for (const Document::Name& name : changed_objects(before->state().objects, preview.scene.state().objects))
        preview.changed.insert(name);
    follow_solids(studio, at, preview, request.ctx);
    return preview;
}

void send(Studio& studio, const Request& request, std::string frame) {
    studio.frames(request.client, std::make_shared<const std::string>(std::move(frame)));
}

void send_skeleton(Studio& studio, const Request& request, const std::string& name, const ObjectPtr& object,
                   std::optional<std::uint64_t> seq) {
    // The axes first: they need no time, however slow the surface is.
    if (std::get<Skeleton>(object->value).size() <= kMaxAxes) {
        const GeometryHead head{ObjectKind::skeleton, name, studio.notes.of(object).version, seq};
        send(studio, request, encode_object(*object, head, kCoarseCells, StudioColor::plain, request.ctx));
    }
    if (!request.fields.contains("surface")) return;
    const LiveSurfaces::Shown& shown = follow(studio, name, object, surface_request(request), request.ctx);
    auto frame = encode_since(shown, get_known_version(request), seq, StudioColor::plain, request.ctx);
    if (frame) send(studio, request, std::move(*frame));
}

void send_object(Studio& studio, const Request& request, const Document::Name& name, const ObjectPtr& object,
                 std::optional<std::uint64_t> seq) {
    if (name.first == ObjectKind::skeleton) return send_skeleton(studio, request, name.second, object, seq);
    const GeometryHead head{name.first, name.second, studio.notes.of(object).version, seq};
    send(studio, request, encode_object(*object, head, kCoarseCells, StudioColor::plain, request.ctx));
}

Json preview(Studio& studio, const Request& request) {
    const auto seq = static_cast<std::uint64_t>(request.count("seq", 0));
    const Preview preview = previewed(studio, request);
    const SceneObjects& made = preview.scene.state().objects;
    for (const Document::Name& name : preview.changed) {
        const auto found = made.find(name);
        if (found == made.end() || name.first == ObjectKind::mesh || name.first == ObjectKind::material)
            continue;  // removed, made from shown objects, or without a shape
        send_object(studio, request, name, found->second, seq);
        studio.previewed.insert(name);
    }
    return {{"seq", seq}};
}

/// Restores the objects that previews changed.
Json endpreview(Studio& studio, const Request& request) {
    const SceneObjects& now = studio.document.scene().state().objects;
    for (const Document::Name& name : std::exchange(studio.previewed, {})) {
        const auto found = now.find(name);
        if (found != now.end()) send_object(studio, request, name, found->second, std::nullopt);
    }
    return Json::object();
}

}  // namespace

std::map<std::string, Handler> preview_requests() {
    return {{"preview", preview}, {"endpreview", endpreview}};
}

}  // namespace coppice::studio_internal
