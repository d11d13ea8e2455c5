#pragma once

#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/scene/scene.h"

namespace coppice {

namespace studio_internal {
class Prefix;
struct StatementText;
}  // namespace studio_internal

/// Memory limits of a document.
struct DocumentLimits {
    std::uint64_t states = std::uint64_t{1}
                           << 30;  ///< [bytes] of stored states in addition to the newest one
    std::uint64_t texts =
        std::uint64_t{256}
        << 20;  ///< [bytes] of texts, including those of undo; one document may use a quarter
};

/// A scene that is being edited: a list of statements, of which the first ran() have been run. Every
/// operation produces another list, so that only the text is saved, and running it produces bit-identical
/// objects. The changes of the text are stored for undo, limited only by the memory.
///
/// Scenes are stored after slow statements and after the last ones, within the memory limit: a change runs
/// only the statements after it, and undo runs hardly any.
class Document {
  public:
    /// A statement of the document.
    struct Statement {
        std::string text;        ///< a line, or the lines of a block
        std::uint32_t line = 1;  ///< number of its first line in the whole text
        std::string message;     ///< output of running it
    };
    /// The reason why the remaining statements were not run.
    struct Failure {
        std::size_t statement = 0;  ///< index of the failed statement
        std::uint32_t line = 1;     ///< in the text
        std::string message;        ///< one sentence
    };
    /// The identity of an object.
    using Name = std::pair<ObjectKind, std::string>;
    /// A statement that is running.
    struct Running {
        std::size_t statement = 0;  ///< its index in the new list
        std::string_view text;      ///< text of the statement
    };
    /// Called when a statement starts, and with nullopt when the run ends for any reason. Must not throw.
    using Watch = std::function<void(const std::optional<Running>& running)>;

    explicit Document(SceneSettings settings = {}, DocumentLimits limits = {});  ///< without statements
    ~Document();
    Document(Document&&) noexcept;             ///< leaves an empty object
    Document& operator=(Document&&) noexcept;  ///< leaves an empty object

    /// Inserts one or several lines after the last statement that was run; or, for a line about an object,
    /// after the last statement that changed it, if a later statement names it. Returns the index of the last
    /// inserted statement. Throws the exceptions of Scene::run if the line itself fails, and Cancelled; the
    /// document is then unchanged. If a later statement fails because of the line, that is a Failure, and the
    /// line stays in the text.
    std::size_t run(const std::string& line, const std::optional<Name>& about, const Context& ctx);

    /// Options of a change of the text.
    struct TextChange {
        std::optional<std::size_t> count = {};    ///< number of statements to run; nullopt: all
        std::string name = "change of the text";  ///< name in the undo list
        std::string by = {};                      ///< client that makes the change
        /// Whether the change is merged with the previous one, if that has the same name and client.
        bool joins = false;
    };
    /// Replaces the text and runs as much of it as possible. Throws Cancelled, or InvalidInput for more than
    /// 100,000 lines or a text that exceeds the memory limit; the document is then unchanged.
    void set_text(std::string_view text, const TextChange& how, const Context& ctx);
    void set_text(std::string_view text, const Context& ctx) { set_text(text, {}, ctx); }  ///< runs all of it

    /// Replaces the text by that of another file, as a change: undo restores the previous text and file name.
    void open(std::string_view text, const std::string& file, const Context& ctx);
    /// Starts with the text of a file without running it, and clears undo. Throws as set_text().
    void begin_with(std::string_view text, const std::string& file);

    /// Runs up to that many statements, or returns to the state after them. Not recorded for undo.
    void run_to(std::size_t count, const Context& ctx);

    /// Undoes or redoes changes. Throws InvalidInput if there are fewer.
    void undo(std::size_t count, const Context& ctx);
    void redo(std::size_t count, const Context& ctx);  ///< as undo()

    /// Runs again from the first statement that names a changed file. Returns whether there is one. Not
    /// recorded for undo: earlier versions also read the current file.
    bool rerun(const std::string& file, const Context& ctx);

    std::vector<Statement> statements() const;  ///< all statements; O(n)
    std::string text() const;                   ///< the whole text, as in a scene file
    std::size_t size() const;                   ///< number of statements
    std::size_t ran() const { return ran_; }    ///< number of statements that have been run
    const std::optional<Failure>& failure() const { return failure_; }  ///< the reason if not all were run
    const Scene& scene() const { return *scene_; }                      ///< the scene after ran() statements
    std::uint64_t revision() const { return revision_; }                ///< changes after every change
    std::vector<std::string> undo_names(
        std::size_t most) const;  ///< names of the changes that undo reverts, the newest last
    std::vector<std::string> redo_names(
        std::size_t most) const;  ///< names of the changes that redo repeats, the next one last

    /// Returns the last statements that created or changed the objects. O(n).
    std::map<Name, std::size_t> makers() const;
    /// Returns the index at which a line about an object is inserted.
    std::size_t place_for(const std::optional<Name>& about) const;
    /// Returns the scene after the first `count` statements; `count` <= ran().
    std::shared_ptr<const Scene> scene_behind(std::size_t count, const Context& ctx) const;

    void watch(Watch watch) { watch_ = std::move(watch); }  ///< sets the callback
    /// Sets the file in which this text and all its versions are saved; empty: none yet.
    void call(const std::string& file) { *file_ = file; }
    const std::string& file() const { return *file_; }  ///< the file of this text; empty: none yet

  private:
    using Prefix = studio_internal::Prefix;
    using PrefixPtr = std::shared_ptr<Prefix>;
    using File = std::shared_ptr<std::string>;  ///< shared by all versions of a text
    using StatementText = studio_internal::StatementText;
    /// The difference to another version of the text.
    struct Version {
        std::size_t first = 0;                  ///< index of the first statement that differs
        std::size_t count = 0;                  ///< number of statements to remove
        std::vector<StatementText> statements;  ///< statements to insert
        File file;
        std::string name;
        std::string by;

        std::uint64_t bytes() const;
        Version back(const std::vector<StatementText>& from) const;
        std::vector<StatementText> applied_to(const std::vector<StatementText>& from) const;
    };
    struct Reached {
        std::size_t ran = 0;
        std::shared_ptr<const Scene> scene;
        std::optional<Failure> failure;
        std::exception_ptr error;  ///< cause of the failure
    };

    static Version difference(const std::vector<StatementText>& from, const std::vector<StatementText>& to);
    std::uint32_t find_edition(const std::string& text) const;
    StatementText find_statement(const std::string& text) const;
    std::vector<StatementText> texts() const;
    PrefixPtr find_prefix(const std::vector<StatementText>& statements) const;
    PrefixPtr find_prefix(std::string_view text) const;
    void check_room(const Prefix& last) const;
    Reached reach(const std::vector<PrefixPtr>& path, std::size_t count, const Context& ctx) const;
    std::size_t known(const std::vector<PrefixPtr>& path, std::size_t count) const;
    void run_one(Prefix& prefix, Scene& scene, const Context& ctx) const;
    void keep(const PrefixPtr& prefix, std::shared_ptr<const Scene> state) const;
    void forget_old_states(const Scene& now) const;
    void forget_old_versions();
    void show(PrefixPtr last, Reached reached);
    void change(PrefixPtr last, Reached reached, TextChange how);
    void step(std::deque<Version>& from, std::deque<Version>& to, std::size_t count, const char* subject,
              const Context& ctx);
    std::size_t goal() const { return failure_ ? size() : ran_; }

    SceneSettings settings_;
    DocumentLimits limits_;
    PrefixPtr root_, last_;
    std::shared_ptr<const Scene> scene_;
    std::size_t ran_ = 0;
    std::optional<Failure> failure_;
    std::deque<Version> done_, undone_;  ///< undo and redo stack; the next change is the last one
    std::uint64_t revision_ = 1;
    std::map<std::string, std::uint32_t> files_;  ///< changed files with their newest editions
    std::uint32_t edition_ = 0, oldest_edition_ = 0;
    File file_ = std::make_shared<std::string>();
    bool joinable_ = false;  ///< the newest change may be merged with the next one
    Watch watch_;
    mutable std::deque<PrefixPtr> kept_;  ///< prefixes with a stored state
    mutable std::uint64_t clock_ = 0;
    mutable std::uint64_t counted_ = 0;    ///< [bytes] of the states at the last count
    mutable std::uint64_t uncounted_ = 0;  ///< [bytes] upper bound of the states added since
};

}  // namespace coppice
