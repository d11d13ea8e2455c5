#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "coppice/base/random.h"
#include "coppice/edit/editable_tree.h"
#include "coppice/skeleton/skeleton.h"
#include "program.h"

namespace coppice::bench {

/// Generates random numbers in sequence.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : random_(seed, 0) {}
    double uniform(double low, double high) { return random_.uniform(next_++, low, high); }
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_.bits(next_++) % n); }
    StableId node(const EditableTree& tree) {
        for (;;) {
            const StableId n(static_cast<std::uint32_t>(below(tree.slots())));
            if (tree.contains(n) && !tree.is_root(n)) return n;
        }
    }

  private:
    CounterRandom random_;
    std::uint64_t next_ = 0;
};

/// A kind of edit at random positions, and the costs of its edits.
struct Kind {
    const char* name;
    std::function<EditChange(EditableTree&, Dice&)> edit;
    std::vector<double> seconds;
    double nodes = 0, max_nodes = 0;
};

std::vector<Kind> all_kinds();

/// Common flags of the programs that edit a tree.
struct EditFlags {
    ProgramFlags program;
    std::string tree;
    unsigned segments = 0;
    int edits = 0;
    unsigned seed = 1;

    Skeleton skeleton() const;  ///< the given tree, or a synthetic one
};

/// Adds --tree, --segments, --edits, --seed and --markdown.
void add_edit_flags(CLI::App& app, EditFlags& flags);

}  // namespace coppice::bench
