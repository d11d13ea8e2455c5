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

/// A scene: named objects and the commands that create them in sequence. See docs/user/scenes.md for the
/// language and docs/user/scene-reference.md for its commands.
///
/// Objects are immutable: a command that "changes" one assigns its name to a new one, and objects made from
/// the old one are unchanged. A command that fails leaves the scene unchanged. The same commands create
/// bit-identical objects for any number of threads.
class Scene {
  public:
    explicit Scene(SceneSettings settings = {});  ///< creates an empty scene

    /// Runs one line: a command, with its variables expanded, or a statement (see SceneScript). The lines of
    /// a block run when it is closed. `place` is the prefix of messages ("crown.coppice:3", may be empty).
    /// Returns the output of the commands, which is usually empty.
    ///
    /// Throws as the library functions of the command do, with one sentence "PLACE: COMMAND: ...":
    /// InvalidInput for an unknown word (with the closest valid spelling), a value out of range, an object
    /// that does not exist, more than 10,000 objects, or more memory than the settings allow, by an estimate
    /// before the work begins; IoError; Cancelled. If a line of a block fails, the effects of the previous
    /// lines remain.
    std::string run(std::string_view line, const std::string& place = {}, const Context& ctx = {});

    /// Returns whether a block is open, so that lines are queued until its end.
    bool waits() const { return script_.open(); }
    /// If a block is open, discards it and throws InvalidInput naming the line that opened it.
    void finish() { script_.finish(); }

    /// Runs all lines of a text; returns their output. `source` names the text in messages. Throws before the
    /// first line if a block is not closed.
    std::string run_text(std::string_view text, const std::string& source, const Context& ctx = {});

    /// Adds an external skeleton to the scene, replacing one of that name. It is not recorded as a command,
    /// so that `undo` and recipes ignore it.
    void hold_tree(const std::string& name, Skeleton tree);

    const SceneState& state() const { return state_; }                       ///< current state
    const SceneSettings& settings() const { return settings_; }              ///< as passed to the constructor
    const SceneVariables& variables() const { return script_.variables(); }  ///< current values
    /// sets the folder of input files
    void set_folder(std::filesystem::path folder) { settings_.folder = std::move(folder); }
    /// Makes save and render check their arguments without writing.
    void forbid_outputs() { settings_.outputs = false; }

    /// Returns the number of commands that can be undone: the last 1,000, or fewer if the objects that they
    /// replaced use more than a quarter of the memory.
    std::size_t undo_depth() const { return undo_.size(); }

  private:
    /// State that a command replaced.
    struct Step {
        std::vector<SceneOutcome::Change> before;
        std::size_t history = 0, made = 0;
        std::string last_grown;
        int seed = 0;
        std::uint64_t bytes = 0;  ///< memory of the replaced objects
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

/// Counts the memory of scenes that are copies of each other; shared memory counts once.
class SceneMemory {
  public:
    /// Returns the approximate memory [bytes] of a scene in addition to those added before. All scenes must
    /// outlive this object.
    std::uint64_t add(const Scene& scene);

  private:
    bool is_new(const void* part) { return seen_.insert(part).second; }
    std::uint64_t count_bytes(const Scene::Step& step);

    std::unordered_set<const void*> seen_;
};

}  // namespace coppice
