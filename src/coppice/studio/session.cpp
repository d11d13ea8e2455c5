#include "coppice/studio/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>
#include <system_error>

#include "coppice/base/error.h"
#include "coppice/studio/session_internal.h"
#include "coppice/system/file.h"

namespace coppice {
namespace studio_internal {

namespace {

constexpr std::size_t kMaxNames = 100;  // maximum number of listed undo steps
constexpr double kMaxCount = 1e9;

const Json* find_field(const Json& fields, const char* name) {
    const auto found = fields.find(name);
    return found == fields.end() || found->is_null() ? nullptr : &*found;
}

ObjectKind kind_called(const std::string& name) {
    const auto found = std::ranges::find(EnumNames<ObjectKind>::names, name);
    if (found == EnumNames<ObjectKind>::names.end())
        throw InvalidInput(fmt::format("'{}' is not a kind of object", name.substr(0, 40)));
    return static_cast<ObjectKind>(found - EnumNames<ObjectKind>::names.begin());
}

}  // namespace

const ObjectNotes::Note& ObjectNotes::of(const ObjectPtr& object) {
    if (known_.size() > tidy_at_) {
        std::erase_if(known_, [](const auto& entry) { return entry.first.expired(); });
        tidy_at_ = 2 * known_.size() + 1024;
    }
    const auto found = known_.find(object);
    if (found != known_.end()) return found->second;
    return known_.emplace(object, Note{++last_, compute_bounds(*object)}).first->second;
}

ObjectPtr Studio::object(ObjectKind kind, const std::string& name) const {
    const SceneObjects& objects = document.scene().state().objects;
    const auto found = objects.find({kind, name});
    if (found == objects.end())
        throw InvalidInput(fmt::format("there is no {} '{}'", name_of(kind), name.substr(0, 80)));
    return found->second;
}

void Studio::reserve(double bytes) const {
    constexpr double kMebibyte = 1 << 20;
    const Scene& scene = document.scene();
    const double held = static_cast<double>(scene.state().bytes);
    if (held + bytes <= scene.settings().max_memory * kMebibyte) return;
    throw InvalidInput(
        fmt::format("this may take {:.1f} MiB in addition to the current {:.1f}, and {} are allowed; reduce "
                    "the request, or give the studio more with --max-memory",
                    bytes / kMebibyte, held / kMebibyte, scene.settings().max_memory));
}

void Studio::check_size(std::uint64_t bytes, const std::string& name) const {
    constexpr std::uint64_t kAtOnce = 4;  // two that are computed, and as much that is stored
    constexpr double kMebibyte = 1 << 20;
    const std::uint64_t most = shares.blobs / kAtOnce;
    if (bytes <= most) return;
    throw InvalidInput(
        fmt::format("showing '{}' would take {:.1f} MiB, and {:.1f} are available; give the studio more with "
                    "--max-memory",
                    name, static_cast<double>(bytes) / kMebibyte, static_cast<double>(most) / kMebibyte));
}

const std::string& Request::text(const char* field) const {
    const Json* found = find_field(fields, field);
    if (found == nullptr || !found->is_string())
        throw InvalidInput(fmt::format("the request requires a text '{}'", field));
    return found->get_ref<const std::string&>();
}

std::string Request::text(const char* field, const char* otherwise) const {
    return find_field(fields, field) == nullptr ? otherwise : text(field);
}

double Request::number(const char* field) const {
    const Json* found = find_field(fields, field);
    if (found == nullptr || !found->is_number())
        throw InvalidInput(fmt::format("the request requires a number '{}'", field));
    return found->get<double>();
}

std::size_t Request::count(const char* field, std::size_t otherwise) const {
    if (find_field(fields, field) == nullptr) return otherwise;
    const double n = number(field);
    if (!(n >= 0 && n <= kMaxCount) || n != std::floor(n))
        throw InvalidInput(fmt::format("'{}' must be a whole number", field));
    return static_cast<std::size_t>(n);
}

bool Request::flag(const char* field) const {
    const Json* found = find_field(fields, field);
    return found != nullptr && found->is_boolean() && found->get<bool>();
}

ObjectKind Request::kind() const { return kind_called(text("kind")); }

std::optional<Document::Name> Request::about() const {
    const Json* found = find_field(fields, "about");
    if (found == nullptr) return std::nullopt;
    const Request inner{client, *found, ctx};
    return Document::Name{inner.kind(), inner.text("name")};
}

std::string run_alongside(const Studio& studio, const std::string& line, const Context& ctx) {
    Scene scene = studio.document.scene();
    return scene.run(line, {}, ctx);
}

namespace {

Json make_state(Studio& studio) {
    const Document& document = studio.document;
    Json statements = Json::array();
    for (const Document::Statement& s : document.statements())
        statements.push_back({{"text", s.text}, {"line", s.line}, {"message", s.message}});
    const auto makers = document.makers();
    Json objects = Json::array();
    for (const auto& [name, object] : document.scene().state().objects) {
        const ObjectNotes::Note& note = studio.notes.of(object);
        const auto [low, high] = note.bounds.value_or(std::pair(Vec3d{}, Vec3d{-1, -1, -1}));
        const ObjectCount count = count_elements(*object);
        const auto maker = makers.find(name);
        objects.push_back({{"kind", name_of(name.first)},
                           {"name", name.second},
                           {"version", note.version},
                           {"statement", maker == makers.end() ? 0 : maker->second},
                           {"bounds", {low.x, low.y, low.z, high.x, high.y, high.z}},
                           {"count", count.count},
                           {"unit", count.unit}});
    }
    Json error = nullptr;
    if (const auto& failure = document.failure())
        error = {{"statement", failure->statement}, {"line", failure->line}, {"message", failure->message}};
    return {{"revision", document.revision()},
            {"by", studio.by},
            {"statements", statements},
            {"ran", document.ran()},
            {"running", nullptr},
            {"doing", ""},
            {"error", error},
            {"objects", objects},
            {"undo", document.undo_names(kMaxNames)},
            {"redo", document.redo_names(kMaxNames)},
            {"file", document.file()},
            {"saved", studio.is_saved()},
            {"recovered", studio.recovered}};
}

Json make_json(const StudioGrown& grown) {
    return {{"statement", grown.statement}, {"nodes", grown.nodes}, {"until", grown.until}};
}

/// Messages may quote names of the request, which must stay on one line.
Json refusal(const char* kind, std::string error) {
    std::ranges::replace_if(
        error, [](unsigned char c) { return c < ' '; }, ' ');
    return {{"ok", false}, {"error", error}, {"kind", kind}};
}

}  // namespace
}  // namespace studio_internal

using studio_internal::Handler;
using studio_internal::Request;
using studio_internal::Studio;

namespace {

/// Restricts files to the folder for every session; connects growth to the relay.
StudioOptions settled(StudioOptions options, studio_internal::GrowthRelay& relay) {
    SceneSettings& scene = options.scene;
    if (scene.folder.empty()) scene.folder = ".";
    if (!scene.sandbox) scene.sandbox = std::make_shared<const FolderSandbox>(scene.folder);
    scene.watch = [&relay](const GrowthSoFar& so_far) { relay.take(so_far); };
    return options;
}

}  // namespace

class StudioSession::State {
  public:
    State(const StudioOptions& options, BlobStore& blobs, Frames frames)
        : relay_(blobs, MemoryBudget(options.scene.max_memory).growth),
          studio_(settled(options, relay_), blobs, std::move(frames)) {
        for (const auto& requests :
             {studio_internal::document_requests(), studio_internal::view_requests(),
              studio_internal::preview_requests(), studio_internal::check_requests(),
              studio_internal::picture_requests(), studio_internal::file_requests(),
              studio_internal::menu_requests(), studio_internal::sketch_requests(),
              studio_internal::motion_requests(), studio_internal::material_requests()})
            handlers_.insert(requests.begin(), requests.end());
        open();
    }

    Json answer(const std::string& client, const Json& request, const Context& ctx) {
        using studio_internal::refusal;
        try {
            const Request parsed{client, request, ctx};
            const auto handler = handlers_.find(parsed.text("type"));
            if (handler == handlers_.end())
                throw InvalidInput(
                    fmt::format("there is no request '{}'", parsed.text("type").substr(0, 40)));
            relay_.begin_request();
            const std::uint64_t before = studio_.document.revision();
            Json out = handler->second(studio_, parsed);
            if (studio_.document.revision() != before) studio_.by = client;
            out["ok"] = true;
            return out;
        } catch (const Cancelled& error) {
            Json out = refusal("cancelled", error.what());
            if (const auto& grown = relay_.last()) out["grown"] = studio_internal::make_json(*grown);
            return out;
        } catch (const IoError& error) {
            return refusal("files", error.what());
        } catch (const Error& error) {
            return refusal("input", error.what());
        } catch (const std::bad_alloc&) {
            return refusal(
                "memory",
                "there is not enough memory for this; reduce the request, or allow more by --max-memory");
        } catch (const Json::exception&) {
            return refusal("input", "a field of the request has an invalid type");
        } catch (const std::exception& error) {
            return refusal("internal", error.what());
        }
    }

    void keep_journal() {
        if (studio_.options.journal.empty()) return;
        const std::string text = studio_.document.text();
        const bool is_saved = studio_.is_saved();
        if (text == journal_ && is_saved == journal_saved_) return;
        if (is_saved) {
            std::error_code ignored;
            std::filesystem::remove(studio_.options.journal, ignored);
        } else {
            write_file(studio_.options.journal, text);
        }
        journal_ = text;
        journal_saved_ = is_saved;
    }

    void watch(StudioWatch watch) {
        relay_.tell(std::move(watch.grown));
        studio_.document.watch(
            [this, runs = std::move(watch.runs)](const std::optional<Document::Running>& running) {
                relay_.runs(running ? std::optional(running->statement) : std::nullopt);
                if (runs) runs(running);
            });
    }

    Studio& studio() { return studio_; }

  private:
    void open() {
        const std::string& file = studio_.options.file;
        std::string text;
        if (!file.empty()) text = read_file(studio_.sandbox().to_read(file));
        // Texts are compared in the form that the document writes: with a line end after the last line.
        studio_.document.begin_with(text, file);
        studio_.note_saved();
        std::error_code ignored;
        if (!studio_.options.journal.empty() && std::filesystem::exists(studio_.options.journal, ignored)) {
            studio_.document.begin_with(read_file(studio_.options.journal), file);
            studio_.recovered = true;
        }
        journal_ = studio_.document.text();
        journal_saved_ = !studio_.recovered;
    }

    studio_internal::GrowthRelay relay_;  ///< the text before the running growth
    Studio studio_;
    std::map<std::string, Handler> handlers_;
    std::string journal_;        ///< the text in the journal
    bool journal_saved_ = true;  ///< removed, because the text is saved
};

StudioSession::StudioSession(const StudioOptions& options, BlobStore& blobs, Frames frames)
    : state_(std::make_unique<State>(options, blobs, std::move(frames))) {}
StudioSession::~StudioSession() = default;

Json StudioSession::answer(const std::string& client, const Json& request, const Context& ctx) {
    return state_->answer(client, request, ctx);
}

Json StudioSession::state() const { return studio_internal::make_state(state_->studio()); }
std::uint64_t StudioSession::revision() const {
    return state_->studio().document.revision() + state_->studio().saves;
}
std::string StudioSession::folder() const {
    return std::filesystem::absolute(state_->studio().options.scene.folder).lexically_normal().string();
}
void StudioSession::watch(StudioWatch watch) { state_->watch(std::move(watch)); }
void StudioSession::keep_journal() { state_->keep_journal(); }

}  // namespace coppice
