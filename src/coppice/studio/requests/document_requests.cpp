#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/edit/anchor.h"
#include "coppice/scene/reference.h"
#include "coppice/scene/words.h"
#include "coppice/studio/requests/new_names_internal.h"
#include "coppice/studio/session_internal.h"

namespace coppice::studio_internal {
namespace {

Json run(Studio& studio, const Request& request) {
    studio.previewed.clear();
    const NamedLine named = with_new_names(request.text("line"), studio.document.scene().state().objects);
    const std::size_t at = studio.document.run(named.line, request.about(), request.ctx);
    return {{"statement", at}, {"message", studio.document.statements()[at].message}, {"names", named.names}};
}

Json text(Studio& studio, const Request& request) {
    if (request.count("revision", 0) != studio.document.revision())
        throw InvalidInput("the document has changed since then; load it again and repeat your changes");
    studio.previewed.clear();
    Document::TextChange how;
    if (request.fields.contains("count")) how.count = request.count("count", 0);
    how.name = request.text("name", how.name.c_str());
    how.by = request.client;
    how.joins = request.flag("joins");
    studio.document.set_text(request.text("text"), how, request.ctx);
    return Json::object();
}

Json ran(Studio& studio, const Request& request) {
    studio.previewed.clear();
    studio.document.run_to(request.count("count", studio.document.size()), request.ctx);
    return Json::object();
}

Json undo(Studio& studio, const Request& request) {
    studio.previewed.clear();
    studio.document.undo(request.count("count", 1), request.ctx);
    return Json::object();
}

Json redo(Studio& studio, const Request& request) {
    studio.previewed.clear();
    studio.document.redo(request.count("count", 1), request.ctx);
    return Json::object();
}

Json rerun(Studio& studio, const Request& request) {
    studio.previewed.clear();
    return {{"found", studio.document.rerun(request.text("file"), request.ctx)}};
}

Json aside(Studio& studio, const Request& request) {
    return {{"message", run_alongside(studio, request.text("line"), request.ctx)}};
}

Json schema(Studio&, const Request&) { return {{"schema", scene_schema()}}; }

Json help(Studio&, const Request& request) {
    const std::vector<SceneWord> words = scene_words(request.text("words", ""));
    return {{"text", words.empty() ? help_overview() : format_help(words)}};
}

Json complete(Studio& studio, const Request& request) {
    const std::size_t count = request.count("count", studio.document.ran());
    const std::string& line = request.text("line");
    if (count >= studio.document.ran())
        return {{"words", completions(line, studio.document.scene().state())}};
    return {{"words", completions(line, studio.document.scene_behind(count, request.ctx)->state())}};
}

Json describe(Studio& studio, const Request& request) {
    return {{"text", describe_object(*studio.object(request.kind(), request.text("name")))}};
}

/// Returns selections of nodes that remain valid when the tree is computed again.
Json anchor(Studio& studio, const Request& request) {
    constexpr std::size_t kMaxNodes = 1000;
    const ObjectPtr object = studio.object(ObjectKind::skeleton, request.text("name"));
    const EditableTree tree(std::get<Skeleton>(object->value));
    const Json& nodes = request.fields.at("nodes");
    if (nodes.size() > kMaxNodes) throw InvalidInput("these are too many nodes to list");
    Json out = Json::array();
    for (const Json& number : nodes) {
        const StableId node(number.get<std::uint32_t>());
        if (!tree.contains(node)) throw InvalidInput(fmt::format("the tree has no node {}", node.index()));
        out.push_back(anchor_text(tree, node));
    }
    return {{"selections", out}};
}

Json ping(Studio&, const Request& request) {
    const auto time = request.fields.find("time");
    return time == request.fields.end() ? Json::object() : Json{{"time", *time}};
}

}  // namespace

std::map<std::string, Handler> document_requests() {
    return {{"run", run},   {"text", text},         {"ran", ran},           {"undo", undo},
            {"redo", redo}, {"rerun", rerun},       {"aside", aside},       {"schema", schema},
            {"help", help}, {"complete", complete}, {"describe", describe}, {"anchor", anchor},
            {"ping", ping}};
}

}  // namespace coppice::studio_internal
