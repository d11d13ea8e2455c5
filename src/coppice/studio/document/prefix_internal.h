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

/// What running a statement did.
struct Record {
    std::string says;                                         ///< what it said
    std::vector<std::pair<ObjectKind, std::string>> changed;  ///< objects that came, changed or went
    double seconds = 0;                                       ///< that it took
};

/// The text of a statement, shared by all lists that have it, and the edition of the files that it reads.
struct Piece {
    std::shared_ptr<const std::string> text;
    std::uint32_t edition = 0;

    friend bool operator==(const Piece& a, const Piece& b) {
        return a.edition == b.edition && (a.text == b.text || *a.text == *b.text);
    }
};

/// The beginning of a document: a statement and all before it. Versions of a document that begin alike share
/// their beginnings, and so what was computed for these: together they are a tree with the empty document at
/// the root.
class Prefix : public std::enable_shared_from_this<Prefix> {
  public:
    using Ptr = std::shared_ptr<Prefix>;  ///< shared by all versions that begin so

    Prefix() : tree_bytes_(std::make_shared<std::uint64_t>(0)) {}  ///< the empty document
    ~Prefix();                                                     ///< without recursion: documents are long
    Prefix(const Prefix&) = delete;
    Prefix& operator=(const Prefix&) = delete;

    /// This one and one statement more: always the same one for the same piece.
    Ptr with(const Piece& next);

    /// All from the first statement to this one.
    std::vector<Ptr> path();

    const std::string& text() const { return *piece.text; }    ///< of the last statement
    void note(Record made);                                    ///< what running the last statement did
    std::uint64_t tree_bytes() const { return *tree_bytes_; }  ///< of all beginnings in the tree, about

    Ptr before;                    ///< without the last statement; none: the empty document
    Piece piece;                   ///< the last statement
    std::size_t depth = 0;         ///< number of statements
    std::uint32_t lines = 0;       ///< of all statements
    std::uint64_t list_bytes = 0;  ///< of all statements, about

    std::optional<Record> record;        ///< of running the last statement; none: it was not run
    std::shared_ptr<const Scene> state;  ///< behind the last statement; may be forgotten and made again
    std::uint64_t used = 0;              ///< when the state was used last

  private:
    using Key = std::pair<std::uint32_t, std::string_view>;  ///< of a piece whose text the prefix holds

    void leave_tree();
    void count(std::int64_t bytes);

    std::map<Key, std::weak_ptr<Prefix>> next_;
    std::shared_ptr<std::uint64_t> tree_bytes_;
    std::int64_t bytes_ = 0;
};

/// Whether a name stands in a text as a word, or as a part of one between signs that names do not have.
bool mentions(std::string_view text, std::string_view name);

/// The names of objects that only one of them has, or has otherwise.
std::vector<std::pair<ObjectKind, std::string>> changed_objects(const SceneObjects& before,
                                                                const SceneObjects& after);

}  // namespace coppice::studio_internal
