#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/edit/anchor.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/pipeline/json.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/scene/scene.h"

namespace coppice {

/// Edits of one tree by commands: those that scenes write as `edit NAME TREE ...`, here without these words.
/// It keeps the tree between them, and every edit as a command that can be taken back, saved, and made again
/// on another growth or extraction of the plant. docs/user/editing.md explains it.
class EditSession {
  public:
    /// A node that a command names, as it was before the edit.
    struct Named {
        Anchor anchor;  ///< where it lay
        std::size_t maker =
            0;  ///< number of the edit that had added it, from 1; 0: it was there from the beginning
        std::size_t added = 0;  ///< which of the nodes that this had added
    };
    /// An edit as it was made.
    struct Made {
        std::string command;       ///< with every option spelled out
        std::vector<Named> named;  ///< the nodes that it names by their ids
        EditChange change;         ///< what it did
    };
    /// An edit that was not made again, and why.
    struct Unbound {
        std::size_t index = 0;  ///< of the saved edit, from 0
        std::string command;    ///< as it was saved
        std::string reason;     ///< one sentence, with the nearest candidate where there is one
    };
    /// What became of saved edits.
    struct Replayed {
        std::size_t edits = 0;         ///< saved ones
        std::size_t made = 0;          ///< made again
        std::vector<Unbound> unbound;  ///< not made
    };

    /// Throws what EditableTree throws. Solids that selections name are made by scene commands.
    explicit EditSession(const Skeleton& tree, SceneSettings settings = {});

    /// Runs one command; `place` begins messages, as in Scene::run. Edits; `select`; `undo [COUNT]`, `redo
    /// [COUNT]`, `history`; and any command of scenes that makes no tree and has not the name of an edit,
    /// which finds the tree under the name `tree`. Returns what it has to say, and throws what Scene::run
    /// throws; then nothing has changed.
    std::string run(std::string_view line, const std::string& place = {}, const Context& ctx = {});

    /// Runs commands one a line, or several with semicolons between them.
    std::string run_text(std::string_view text, const std::string& source, const Context& ctx = {});

    /// Runs the scene commands of a file, as Scene::run_text.
    std::string run_scene(std::string_view text, const std::string& source, const Context& ctx = {}) {
        return scene_.run_text(text, source, ctx);
    }

    const EditableTree& tree() const { return tree_; }          ///< as it is now
    const std::vector<Made>& history() const { return made_; }  ///< edits that `undo` can take back, in order
    EditChange last_change() const { return last_change_; }     ///< by the last run()

    /// Makes a surface that follows every edit from now on. Throws what LiveSurface throws. An edit of which
    /// no surface can be made stays made; run() throws, and the surface follows with the next that can be.
    void keep_surface(const MeshOptions& options, const Context& ctx = {});
    /// That surface as it is now; nullptr where none is kept.
    const LiveSurface* surface() const { return surface_ ? &*surface_ : nullptr; }
    /// What the last run() wrote of it.
    const SurfaceChange& last_surface_change() const { return last_surface_change_; }

    /// The history as a file of edits (JSON): each command, and for every node that it names where that lay.
    std::string saved() const;

    /// Makes saved edits, in order, on this tree. Nodes are found by their anchors, those that edits had made
    /// by these edits. An edit that does not bind, or that the tree refuses, is told of and left out. Throws
    /// InvalidInput naming source and field where this is no file of edits, Unsupported for a later version.
    Replayed replay(std::string_view json, const std::string& source, const Context& ctx = {});

  private:
    std::string edit(const SceneCall& call);
    std::string history_command(const std::vector<SceneWord>& words);
    std::string history_text() const;
    std::string run_one(std::string_view line, const std::string& place, const Context& ctx);
    void note(const EditChange& change);
    void follow(const Context& ctx);
    SceneCall bind(std::vector<SceneWord> words, const Context& ctx);
    Named named(StableId n) const;
    SceneCall bind_edit(const std::string& command, const std::string& where, const Context& ctx);
    StableId find_again(const Named& node, const std::vector<std::size_t>& made_as) const;
    void make_again(SceneCall call, const std::vector<Named>& named, const std::vector<std::size_t>& made_as);

    Scene scene_;
    EditableTree tree_;
    AnchorFrame frame_;
    std::uint32_t first_slots_;  ///< ids below were there from the beginning
    std::vector<Made> made_, undone_;
    EditChange last_change_;
    std::optional<LiveSurface> surface_;
    SurfaceChange last_surface_change_;
    NodeSet unfollowed_;  ///< nodes that changed since the surface followed
    bool held_ = true;    ///< the scene has the tree as it is now
};

}  // namespace coppice
