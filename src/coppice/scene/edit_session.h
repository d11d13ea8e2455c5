#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/edit/anchor.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/options/json.h"
#include "coppice/pipeline/live_surface.h"
#include "coppice/scene/scene.h"

namespace coppice {

/// Interactive editing of one tree by commands: those that scenes write as `edit NAME TREE ...`, here without
/// the first and third word. Keeps the tree between commands, and every edit as a command that can be undone,
/// saved, and repeated on another growth or extraction of the plant; see docs/user/editing.md.
class EditSession {
  public:
    /// A node in a command, as it was before the edit.
    struct Named {
        Anchor anchor;          ///< its position
        std::size_t maker = 0;  ///< number of the edit that added it, from 1; 0: part of the original tree
        std::size_t added = 0;  ///< its index among the nodes added by that edit
    };
    /// An executed edit.
    struct Made {
        std::string command;       ///< with all options
        std::vector<Named> named;  ///< nodes that it refers to by id
        EditChange change;         ///< changed nodes
    };
    /// A saved edit that could not be repeated.
    struct Unbound {
        std::size_t index = 0;  ///< index of the saved edit, from 0
        std::string command;    ///< as saved
        std::string reason;     ///< one sentence, with the closest candidate if there is one
    };
    /// Result of repeating saved edits.
    struct Replayed {
        std::size_t edits = 0;         ///< number of saved edits
        std::size_t made = 0;          ///< number of repeated edits
        std::vector<Unbound> unbound;  ///< edits that could not be repeated
    };

    /// Throws as EditableTree does. Solids used by selections are created by scene commands.
    explicit EditSession(const Skeleton& tree, SceneSettings settings = {});

    /// Runs one command; `place` is the prefix of messages, as in Scene::run. Supports edits; `select`; `undo
    /// [COUNT]`, `redo [COUNT]`, `history`; and any scene command that does not create a tree and does not
    /// have the name of an edit, which sees the tree under the name `tree`. Returns its output, and throws as
    /// Scene::run does; in this case nothing has changed.
    std::string run(std::string_view line, const std::string& place = {}, const Context& ctx = {});

    /// Runs commands, one per line or several separated by semicolons.
    std::string run_text(std::string_view text, const std::string& source, const Context& ctx = {});

    /// Runs the scene commands of a file, as Scene::run_text does.
    std::string run_scene(std::string_view text, const std::string& source, const Context& ctx = {}) {
        return scene_.run_text(text, source, ctx);
    }

    const EditableTree& tree() const { return tree_; }          ///< the current tree
    const std::vector<Made>& history() const { return made_; }  ///< edits that `undo` can undo, in order
    EditChange last_change() const { return last_change_; }     ///< change by the last run()

    /// Creates a surface that follows every later edit. Throws as LiveSurface does. If the surface of an edit
    /// cannot be created, the edit is kept and run() throws; the surface follows with the next edit for which
    /// it can be created.
    void keep_surface(const MeshOptions& options, const Context& ctx = {});
    /// Returns the current surface; nullptr if there is none.
    const LiveSurface* surface() const { return surface_ ? &*surface_ : nullptr; }

    /// Returns the history as a file of edits (JSON): each command, and the position of every node that it
    /// refers to.
    std::string saved() const;

    /// Repeats saved edits, in order, on this tree. Nodes are found by their anchors, and nodes added by
    /// edits by these edits. An edit with a node that is not found, or that is invalid for the tree, is
    /// reported and skipped. Throws InvalidInput naming source and field if the text is not a file of edits,
    /// Unsupported for a later version.
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
    std::uint32_t first_slots_;  ///< smaller ids belong to the original tree
    std::vector<Made> made_, undone_;
    EditChange last_change_;
    std::optional<LiveSurface> surface_;
    NodeSet unfollowed_;  ///< nodes changed since the last update of the surface
    bool held_ = true;    ///< whether the scene has the current tree
};

}  // namespace coppice
