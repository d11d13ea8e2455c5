#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coppice/scene/object.h"
#include "coppice/scene/scene.h"

namespace coppice::studio_internal {

/// The result of running a statement.
struct Record {
    std::string message;  ///< its output
    std::vector<std::pair<ObjectKind, std::string>>
        changed;         ///< objects that were created, changed or removed
    double seconds = 0;  ///< run time
};

/// The text of a statement, shared by all lists that contain it, and the edition of the files that it reads.
struct StatementText {
    std::shared_ptr<const std::string> text;
    std::uint32_t edition = 0;

    friend bool operator==(const StatementText& a, const StatementText& b) {
        return a.edition == b.edition && (a.text == b.text || *a.text == *b.text);
    }
};

/// A prefix of a document: a statement and all before it. Versions of a document with a common beginning
/// share its prefixes and their results; together the prefixes form a tree with the empty document as root.
class Prefix : public std::enable_shared_from_this<Prefix> {
  public:
    using Ptr = std::shared_ptr<Prefix>;  ///< shared by all versions with this prefix

    Prefix() : tree_bytes_(std::make_shared<std::uint64_t>(0)) {}  ///< the empty document
    ~Prefix();  ///< iterative, because documents can be long
    Prefix(const Prefix&) = delete;
    Prefix& operator=(const Prefix&) = delete;

    /// Returns this prefix with one more statement: the same object for the same statement.
    Ptr with(const StatementText& next);

    /// Returns all prefixes from the first statement to this one.
    std::vector<Ptr> path();

    const std::string& text() const { return *statement.text; }  ///< of the last statement
    void note(Record made);                                      ///< stores the result of the last statement
    std::uint64_t tree_bytes() const {
        return *tree_bytes_;
    }  ///< approximate size of all prefixes in the tree

    Ptr before;                    ///< prefix without the last statement; null: the empty document
    StatementText statement;       ///< the last statement
    std::size_t depth = 0;         ///< number of statements
    std::uint32_t lines = 0;       ///< number of lines of all statements
    std::uint64_t list_bytes = 0;  ///< approximate size of all statements

    std::optional<Record> record;  ///< result of the last statement; nullopt: it was not run
    std::shared_ptr<const Scene>
        state;               ///< scene after the last statement; may be released and computed again
    std::uint64_t used = 0;  ///< time of the last use of the state

  private:
    /// refers to the text of a statement that the prefix owns
    using Key = std::pair<std::uint32_t, std::string_view>;

    void leave_tree();
    void count(std::int64_t bytes);

    std::map<Key, std::weak_ptr<Prefix>> next_;
    std::shared_ptr<std::uint64_t> tree_bytes_;
    std::int64_t bytes_ = 0;
};

/// Returns whether a text contains a name, delimited by characters that names cannot contain.
bool mentions(std::string_view text, std::string_view name);

/// Returns the names of objects that differ between both, or exist in only one of them.
std::vector<std::pair<ObjectKind, std::string>> changed_objects(const SceneObjects& before,
                                                                const SceneObjects& after);

}  // namespace coppice::studio_internal
