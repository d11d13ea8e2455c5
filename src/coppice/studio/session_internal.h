#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/hash.h"
#include "coppice/studio/document/document.h"
#include "coppice/studio/document/prefix_internal.h"
#include "coppice/studio/growth_relay_internal.h"
#include "coppice/studio/memory_budget_internal.h"
#include "coppice/studio/menu/menu_internal.h"
#include "coppice/studio/menu/programs_internal.h"
#include "coppice/studio/scratch_internal.h"
#include "coppice/studio/session.h"
#include "coppice/studio/show/blob_store.h"
#include "coppice/studio/show/geometry_internal.h"
#include "coppice/studio/show/live_surfaces_internal.h"
#include "coppice/system/folder_sandbox.h"

namespace coppice::studio_internal {

/// Cached properties of objects, for the lifetime of the objects.
class ObjectNotes {
  public:
    /// Properties of one object.
    struct Note {
        std::uint64_t version;                          ///< unique number of the object
        std::optional<std::pair<Vec3d, Vec3d>> bounds;  ///< minimum and maximum corner; nullopt: it is empty
    };
    const Note& of(const ObjectPtr& object);  ///< valid until the next call

  private:
    std::map<std::weak_ptr<const SceneObject>, Note, std::owner_less<>> known_;
    std::uint64_t last_ = 0;
    std::size_t tidy_at_ = 1024;
};

class CachedMotion;

/// The data of all requests.
struct Studio {
    Studio(StudioOptions given, BlobStore& store, StudioSession::Frames send)
        : options(std::move(given)),
          shares(options.scene.max_memory),
          blobs(store),
          frames(std::move(send)),
          document(scene_settings(), {.states = shares.states, .texts = shares.texts}),
          surfaces(shares.surfaces) {}

    StudioOptions options;
    MemoryBudget shares;
    BlobStore& blobs;
    StudioSession::Frames frames;
    Document document;
    LiveSurfaces surfaces;
    ObjectNotes notes;
    Menu menu;  ///< as last sent
    Scratch scratch;
    Programs programs;
    std::map<std::string, std::uint64_t> saved;  ///< hashes of texts as saved or opened, by file name
    std::uint64_t saves = 0;                     ///< number of times the text was saved
    std::string by;                              ///< client of the last change
    bool recovered = false;                      ///< the text came from the journal
    std::set<Document::Name> previewed;          ///< objects that a client shows with changes by a preview
    std::shared_ptr<CachedMotion> motion;        ///< the last one that was requested

    bool is_saved() const {  ///< whether the file contains the current text
        const auto found = saved.find(document.file());
        return found != saved.end() && found->second == hash_of_text();
    }
    void note_saved() {
        saved[document.file()] = hash_of_text();
    }  ///< records that the file contains the current text
    std::uint64_t hash_of_text() const {
        const std::string text = document.text();
        return Hash().add(std::span<const char>(text)).value();
    }
    const FolderSandbox& sandbox() const { return *options.scene.sandbox; }  ///< of the opened folder
    /// Returns the object that a request names by `kind` and `name`; throws InvalidInput if there is none.
    ObjectPtr object(ObjectKind kind, const std::string& name) const;
    /// Returns the settings of the scene, with its share of the memory.
    SceneSettings scene_settings() const {
        SceneSettings settings = options.scene;
        settings.max_memory = std::max(1, static_cast<int>(shares.scene >> 20));
        return settings;
    }
    /// Throws InvalidInput if the objects of the document and that many bytes together exceed the limit.
    void reserve(double bytes) const;
    /// Throws InvalidInput if a blob of that many bytes would leave no room for others.
    void check_size(std::uint64_t bytes, const std::string& name) const;
};

/// A request and its client.
struct Request {
    const std::string& client;
    const Json& fields;
    const Context& ctx;

    /// Returns a field; throws InvalidInput with its name if it is missing or has an invalid value.
    const std::string& text(const char* field) const;
    std::string text(const char* field,
                     const char* otherwise) const;  ///< the same with a default for a missing field
    double number(const char* field) const;         ///< as text()
    std::size_t count(const char* field, std::size_t otherwise) const;  ///< a whole number >= 0
    bool flag(const char* field) const;                                 ///< false if missing
    ObjectKind kind() const;                                            ///< from "kind"
    std::optional<Document::Name> about() const;                        ///< from "about"
};

/// Processes one type of request; returns the fields of the answer.
using Handler = Json (*)(Studio& studio, const Request& request);

/// The types of requests by the file that implements them.
/// @{
std::map<std::string, Handler> document_requests();
std::map<std::string, Handler> view_requests();
std::map<std::string, Handler> preview_requests();
std::map<std::string, Handler> check_requests();
std::map<std::string, Handler> picture_requests();
std::map<std::string, Handler> file_requests();
std::map<std::string, Handler> menu_requests();
std::map<std::string, Handler> sketch_requests();
std::map<std::string, Handler> motion_requests();
std::map<std::string, Handler> material_requests();
/// Offers the images of the materials of a surface; returns their keys by slot. Equal images have equal keys,
/// so that clients can keep them.
Json offer_images(Studio& studio, std::span<const SurfaceMaterial> materials);
/// @}

/// Returns the path for writing a file of that name. Throws IoError if the folder sandbox refuses it, or if
/// it exists and the request has no `overwrite`.
std::filesystem::path path_to_write(const Studio& studio, const Request& request, const std::string& name);

/// Returns the fields of the answer for a file that was written.
Json written(const std::filesystem::path& path, const std::string& name);

/// An object to export, with the options.
struct ExportRequest {
    ObjectKind kind = ObjectKind::skeleton;
    std::string name;
    std::filesystem::path path;  ///< path of the file
    /// Whether a skeleton is exported as surface; nullopt: as the format of the file requires.
    std::optional<bool> as_surface = {};
    std::string surface = {};  ///< options of mesh, in the syntax of a command
};
/// Exports an object and returns it as written. Throws as the writers.
ObjectPtr export_to(const Studio& studio, const ExportRequest& export_request, const Context& ctx);

/// Returns the options in a field of the request in the syntax of a command, with a blank before each.
std::string typed_options(const Request& request, const char* field);
/// The same for `surface`, which contains options of mesh.
inline std::string surface_options(const Request& request) { return typed_options(request, "surface"); }

/// Returns the surface of a skeleton or solid, computed outside the document, or an object of another kind
/// itself. `options` are those of mesh, in the syntax of a command.
ObjectPtr make_surface(const Studio& studio, const Document::Name& object, const std::string& options,
                       const Context& ctx);

/// Runs a command in a copy of the current scene that is discarded afterwards. Returns its output.
std::string run_alongside(const Studio& studio, const std::string& line, const Context& ctx);

}  // namespace coppice::studio_internal
