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
struct Piece;
}  // namespace studio_internal

/// How much a document may keep.
struct DocumentLimits {
    std::uint64_t states = std::uint64_t{1} << 30;  ///< [bytes] of states that are kept beside the newest one
    std::uint64_t texts = std::uint64_t{256}
                          << 20;  ///< [bytes] of texts, undo's too; a quarter of one document
};

/// A scene that is being worked on: a list of statements, of which the first so many have been run. Whatever
/// is done gives another list, so that the text is all there is to save, and running it makes the same
/// objects with the same bits. What each change did to the text is kept, the oldest only as long as there is
/// room: undo has no other end.
///
/// What statements made is kept behind those that took long and the last ones, as far as there is room: a
/// change runs again only what stands after it, and going back hardly anything.
class Document {
  public:
    /// A statement as it stands in the document.
    struct Statement {
        std::string text;        ///< a line, or several where it is a block
        std::uint32_t line = 1;  ///< of its first line in the whole text
        std::string says;        ///< what running it said
    };
    /// Why the rest was not run.
    struct Failure {
        std::size_t statement = 0;  ///< that failed
        std::uint32_t line = 1;     ///< in the text
        std::string message;        ///< one sentence
    };
    /// What an object is called.
    using Name = std::pair<ObjectKind, std::string>;
    /// A statement that runs.
    struct Running {
        std::size_t statement = 0;  ///< its number in the list that is being made
        std::string_view text;      ///< of it
    };
    /// Told of statements that begin to run, and with none when nothing runs any more, however it ended. Must
    /// not throw.
    using Watch = std::function<void(const std::optional<Running>& running)>;

    explicit Document(SceneSettings settings = {}, DocumentLimits limits = {});  ///< without statements
    ~Document();
    Document(Document&&) noexcept;             ///< leaves nothing
    Document& operator=(Document&&) noexcept;  ///< leaves nothing

    /// Puts a line, or several, behind what ran, or where what it is about has to be changed: behind the last
    /// statement that made that object, if a later one names it. Returns the number of the statement. Throws
    /// what Scene::run throws where the line itself fails; then nothing has changed. A later statement that
    /// fails with it is a Failure, and stays in the text. Throws Cancelled, and nothing has changed.
    std::size_t run(const std::string& line, const std::optional<Name>& about, const Context& ctx);

    /// How a text is taken.
    struct TextChange {
        std::optional<std::size_t> count = {};    ///< runs to behind so many statements; none: all
        std::string name = "change of the text";  ///< what undo calls it
        std::string by = {};                      ///< who makes it
        /// Where the newest change has the same name and is by the same one, both become one change.
        bool joins = false;
    };
    /// Another text in place of this one, run as far as it can be. Throws Cancelled, and nothing has changed;
    /// InvalidInput for more than 100,000 lines, or more text than there is room for.
    void set_text(std::string_view text, const TextChange& how, const Context& ctx);
    void set_text(std::string_view text, const Context& ctx) { set_text(text, {}, ctx); }  ///< all of it

    /// The text of another file, as a change: undo brings back this one and what it is called.
    void open(std::string_view text, const std::string& file, const Context& ctx);
    /// Begins with the text of a file, of which nothing has been run: undo does not go behind it. Throws as
    /// set_text().
    void begin_with(std::string_view text, const std::string& file);

    /// Runs to behind that many statements, or goes back to there. Not a change that undo knows.
    void run_to(std::size_t count, const Context& ctx);

    /// Goes back by changes, or forth again. Throws InvalidInput where there are not so many.
    void undo(std::size_t count, const Context& ctx);
    void redo(std::size_t count, const Context& ctx);  ///< as undo()

    /// A file changed: runs again from the first statement that names it. Returns whether there is one. Not a
    /// change that undo knows: other versions read the file as it is now too.
    bool rerun(const std::string& file, const Context& ctx);

    std::vector<Statement> statements() const;  ///< all of them; O(n)
    std::string text() const;                   ///< of all of them, as a scene file holds it
    std::size_t size() const;                   ///< number of statements
    std::size_t ran() const { return ran_; }    ///< so many have been run
    const std::optional<Failure>& failure() const { return failure_; }  ///< why not more
    const Scene& scene() const { return *scene_; }                      ///< behind what ran
    std::uint64_t revision() const { return revision_; }                ///< another one after every change
    std::vector<std::string> undo_names(std::size_t most) const;  ///< what undo takes back, the newest last
    std::vector<std::string> redo_names(
        std::size_t most) const;  ///< what redo makes again, the next one last

    /// The statements that made or changed objects last. O(n).
    std::map<Name, std::size_t> makers() const;
    /// Where a line about an object is put.
    std::size_t place_for(const std::optional<Name>& about) const;
    /// The scene behind the first so many statements; `count` <= ran().
    std::shared_ptr<const Scene> scene_behind(std::size_t count, const Context& ctx) const;

    void watch(Watch watch) { watch_ = std::move(watch); }  ///< from now on
    /// The file that this text is saved in from now on, and all versions of it; empty: none yet.
    void call(const std::string& file) { *file_ = file; }
    const std::string& file() const { return *file_; }  ///< that this text is saved in; empty: none yet

  private:
    using Prefix = studio_internal::Prefix;
    using PrefixPtr = std::shared_ptr<Prefix>;
    using File = std::shared_ptr<std::string>;  ///< shared by all versions of a text
    using Piece = studio_internal::Piece;
    /// What leads to another version of the text.
    struct Version {
        std::size_t first = 0;      ///< statement from which on it is another one
        std::size_t count = 0;      ///< of the statements that go
        std::vector<Piece> pieces;  ///< that come in their place
        File file;
        std::string name;
        std::string by;

        std::uint64_t bytes() const;
        Version back(const std::vector<Piece>& from) const;
        std::vector<Piece> applied_to(const std::vector<Piece>& from) const;
    };
    struct Reached {
        std::size_t ran = 0;
        std::shared_ptr<const Scene> scene;
        std::optional<Failure> failure;
        std::exception_ptr error;  ///< that the failure tells of
    };

    static Version difference(const std::vector<Piece>& from, const std::vector<Piece>& to);
    std::uint32_t edition_of(const std::string& text) const;
    Piece piece_of(const std::string& text) const;
    std::vector<Piece> pieces() const;
    PrefixPtr list_of(const std::vector<Piece>& pieces) const;
    PrefixPtr list_of(std::string_view text) const;
    void check_room(const Prefix& last) const;
    Reached reach(const std::vector<PrefixPtr>& path, std::size_t count, const Context& ctx) const;
    std::size_t known(const std::vector<PrefixPtr>& path, std::size_t count) const;
    void run_one(Prefix& prefix, Scene& scene, const Context& ctx) const;
    void keep(const PrefixPtr& prefix, std::shared_ptr<const Scene> state) const;
    void forget_old_states(const Scene& now) const;
    void forget_old_versions();
    void show(PrefixPtr last, Reached reached);
    void change(PrefixPtr last, Reached reached, TextChange how);
    void step(std::deque<Version>& from, std::deque<Version>& to, std::size_t count, const char* what,
              const Context& ctx);
    std::size_t goal() const { return failure_ ? size() : ran_; }

    SceneSettings settings_;
    DocumentLimits limits_;
    PrefixPtr root_, last_;
    std::shared_ptr<const Scene> scene_;
    std::size_t ran_ = 0;
    std::optional<Failure> failure_;
    std::deque<Version> done_, undone_;  ///< back, by what was done, and forth again; the next one last
    std::uint64_t revision_ = 1;
    std::map<std::string, std::uint32_t> files_;  ///< that changed, with the newest editions of them
    std::uint32_t edition_ = 0, oldest_edition_ = 0;
    File file_ = std::make_shared<std::string>();
    bool joinable_ = false;  ///< the newest change was just made
    Watch watch_;
    mutable std::deque<PrefixPtr> kept_;  ///< that have a state
    mutable std::uint64_t clock_ = 0;
    mutable std::uint64_t counted_ = 0;    ///< [bytes] of the states when they were counted last
    mutable std::uint64_t uncounted_ = 0;  ///< [bytes] that came since, at most
};

}  // namespace coppice
