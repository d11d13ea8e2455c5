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
#include "coppice/io/jail.h"
#include "coppice/studio/document/document.h"
#include "coppice/studio/document/prefix_internal.h"
#include "coppice/studio/growth_relay_internal.h"
#include "coppice/studio/menu/menu.h"
#include "coppice/studio/menu/programs_internal.h"
#include "coppice/studio/scratch_internal.h"
#include "coppice/studio/session.h"
#include "coppice/studio/shares.h"
#include "coppice/studio/show/blob_store.h"
#include "coppice/studio/show/geometry.h"
#include "coppice/studio/show/live_surfaces.h"

namespace coppice::studio_internal {

/// What is known of objects as long as they are held anywhere.
class ObjectNotes {
  public:
    /// Of one object.
    struct Note {
        std::uint64_t version;                          ///< a number that no other object has
        std::optional<std::pair<Vec3d, Vec3d>> bounds;  ///< least and greatest corner; none: it is empty
    };
    const Note& of(const ObjectPtr& object);  ///< until the next call

  private:
    std::map<std::weak_ptr<const SceneObject>, Note, std::owner_less<>> known_;
    std::uint64_t last_ = 0;
    std::size_t tidy_at_ = 1024;
};

class KeptMotion;

/// All that requests work on.
struct Studio {
    Studio(StudioOptions given, BlobStore& store, StudioSession::Frames send)
        : options(std::move(given)),
          shares(options.scene.max_memory),
          blobs(store),
          frames(std::move(send)),
          document(scene_settings(), {.states = shares.states, .texts = shares.texts}),
          surfaces(shares.surfaces) {}

    StudioOptions options;
    StudioShares shares;
    BlobStore& blobs;
    StudioSession::Frames frames;
    Document document;
    LiveSurfaces surfaces;
    ObjectNotes notes;
    Menu menu;  ///< as it was sent last
    Scratch scratch;
    Programs programs;
    std::map<std::string, std::uint64_t> saved;  ///< hashes of texts as saved or opened, by names of files
    std::uint64_t saves = 0;                     ///< how often the text was saved
    std::string by;                              ///< client of the last change
    bool recovered = false;                      ///< the text came from the journal
    std::set<Document::Name> previewed;          ///< objects that a client sees otherwise than they are
    std::shared_ptr<KeptMotion> motion;          ///< the last one that moments of were asked for

    bool is_saved() const {  ///< whether the file of the text holds the text
        const auto found = saved.find(document.file());
        return found != saved.end() && found->second == hash_of_text();
    }
    void note_saved() { saved[document.file()] = hash_of_text(); }  ///< the file of the text holds it now
    std::uint64_t hash_of_text() const {
        const std::string text = document.text();
        return Hash().add(std::span<const char>(text)).value();
    }
    const Jail& jail() const { return *options.scene.jail; }  ///< of the folder that is open
    /// The object that a request names by `kind` and `name`; throws InvalidInput when there is none.
    ObjectPtr object(ObjectKind kind, const std::string& name) const;
    /// Those of the one scene, which has its share of the memory.
    SceneSettings scene_settings() const {
        SceneSettings settings = options.scene;
        settings.max_memory = std::max(1, static_cast<int>(shares.scene >> 20));
        return settings;
    }
    /// Throws InvalidInput where so many bytes more than the objects of the document are too many.
    void reserve(double bytes) const;
};

/// A request, and who asks.
struct Request {
    const std::string& client;
    const Json& fields;
    const Context& ctx;

    /// A field; throws InvalidInput naming it when it is missing or no such value.
    const std::string& text(const char* field) const;
    std::string text(const char* field, const char* otherwise) const;   ///< the same, where it may be missing
    double number(const char* field) const;                             ///< as text()
    std::size_t count(const char* field, std::size_t otherwise) const;  ///< a whole number >= 0
    bool flag(const char* field) const;                                 ///< false where it is missing
    ObjectKind kind() const;                                            ///< of "kind"
    std::optional<Document::Name> about() const;                        ///< of "about"
};

/// Does one type of request; what it returns belongs to the answer.
using Handler = Json (*)(Studio& studio, const Request& request);

/// The types of requests by where they are done.
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
/// @}

/// Where a file of that name may be written. Throws IoError where the jail refuses it, or where it is there
/// and the request does not say `overwrite`.
std::filesystem::path path_to_write(const Studio& studio, const Request& request, const std::string& name);

/// What is answered of a file that was written.
Json written(const std::filesystem::path& path, const std::string& name);

/// An object to write, and how.
struct ExportWish {
    ObjectKind kind = ObjectKind::skeleton;
    std::string name;
    std::filesystem::path path;  ///< of the file
    /// Of a skeleton: its surface, or itself; none: what the file's ending is for.
    std::optional<bool> as_surface = {};
    std::string surface = {};  ///< options of mesh, as they are typed behind it
};
/// Writes it, and returns what was written. Throws what the writers throw.
ObjectPtr export_to(const Studio& studio, const ExportWish& wish, const Context& ctx);

/// The options in a field of the request as they are typed behind a command, with a blank before each.
std::string typed_options(const Request& request, const char* field);
/// The same of `surface`, which has options of mesh.
inline std::string surface_options(const Request& request) { return typed_options(request, "surface"); }

/// The surface of a skeleton or solid, made beside the document, or the object itself where it is of another
/// kind. `options` are those of mesh, as they are typed.
ObjectPtr surface_of(const Studio& studio, const Document::Name& object, const std::string& options,
                     const Context& ctx);

/// Runs a command beside the document: in a scene like that behind what ran, of which nothing is kept.
/// Returns what it says.
std::string run_beside(const Studio& studio, const std::string& line, const Context& ctx);

}  // namespace coppice::studio_internal
