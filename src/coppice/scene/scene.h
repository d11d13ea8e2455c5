#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/scene/command.h"
#include "coppice/scene/script/script.h"
#include "coppice/scene/words.h"

namespace coppice {

/// A scene: named objects, and the commands that make them one after the other. docs/user/scenes.md explains
/// the language, docs/user/scene-reference.md its commands.
///
/// Objects never change: a command that "changes" one gives its name to a new one, and whatever was made of
/// the old one stays as it is. A command that fails leaves the scene as it was. The same commands give the
/// same bits for any number of threads.
class Scene {
  public:
    explicit Scene(SceneSettings settings = {});  ///< without objects

    /// Runs one line: a command, with its variables put in, or a statement (see SceneScript). What stands in
    /// a block runs when its end comes. `place` begins messages ("crown.coppice:3", empty for none). Returns
    /// what the commands have to say: nothing for most.
    ///
    /// Throws what the command's library functions throw, as one sentence "PLACE: COMMAND: ...": InvalidInput
    /// for a word that is not understood (with the nearest valid spelling), a value out of range, an object
    /// that does not exist, more than 10,000 objects, or more memory than the settings allow, by estimate and
    /// before work begins; IoError; Cancelled. What a block did before a line of it fails stays.
    std::string run(std::string_view line, const std::string& place = {}, const Context& ctx = {});

    /// Whether a block is open, so that lines wait for its end.
    bool waits() const { return script_.open(); }
    /// Throws InvalidInput naming the line that opens the open block, if there is one, and forgets the block.
    void finish() { script_.finish(); }

    /// Runs all lines of a file's text; returns what they have to say. `source` names it in messages. Throws
    /// before the first line where a block is not closed.
    std::string run_text(std::string_view text, const std::string& source, const Context& ctx = {});

    /// Gives a skeleton to the scene from outside, in place of one of that name. No command made it, so that
    /// neither `undo` nor a recipe knows of it.
    void hold_tree(const std::string& name, Skeleton tree);

    const SceneState& state() const { return state_; }                       ///< what it holds now
    const SceneSettings& settings() const { return settings_; }              ///< as given
    const SceneVariables& variables() const { return script_.variables(); }  ///< as they are now
    /// where files to read are looked for
    void set_folder(std::filesystem::path folder) { settings_.folder = std::move(folder); }
    /// From now on save and render write nothing, and only check.
    void forbid_outputs() { settings_.outputs = false; }

    /// Commands that `undo` can take back: the last 1,000, fewer when what they replaced takes more than a
    /// quarter of the memory.
    std::size_t undo_depth() const { return undo_.size(); }

  private:
    /// What a command replaced.
    struct Step {
        std::vector<SceneOutcome::Change> before;
        std::size_t history = 0, made = 0;
        std::string last_grown;
        int seed = 0;
        std::uint64_t bytes = 0;  ///< of what was replaced
    };
    using StepPtr = std::shared_ptr<const Step>;  ///< shared by copies of the scene
    friend class SceneMemory;

    std::string run_command(std::string_view line, const std::string& place, const Context& ctx);

    void apply(const SceneCall& call, const SceneOutcome& outcome);
    void put(ObjectKind kind, const std::string& name, const ObjectPtr& object);
    void take_back(int count);
    void forget_old_steps();

    SceneSettings settings_;
    SceneScript script_;
    SceneState state_;
    std::deque<StepPtr> undo_;
    std::uint64_t undo_bytes_ = 0;
    std::uint64_t history_bytes_ = 0;
};

/// Counts what scenes take that were copied from each other, what they share only once.
class SceneMemory {
  public:
    /// Bytes that a scene takes beside those that were added before, about. They must outlive this.
    std::uint64_t add(const Scene& scene);

  private:
    bool is_new(const void* part) { return seen_.insert(part).second; }
    std::uint64_t bytes_of(const Scene::Step& step);

    std::unordered_set<const void*> seen_;
};

}  // namespace coppice
