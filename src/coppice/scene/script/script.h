#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/scene/script/expression.h"
#include "coppice/scene/words.h"

namespace coppice {

/// A line of the language itself: let, for, repeat, if, else, end. All others are commands.
struct SceneStatement {
    std::string_view name;     ///< "for"
    std::string_view usage;    ///< "for NAME in FIRST..LAST [step STEP]"
    std::string_view help;     ///< one sentence without a full stop
    std::string_view example;  ///< lines that work
};

/// All statements, in the order of the reference page.
std::span<const SceneStatement> scene_statements();

/// The statement that a line is; none for a command.
const SceneStatement* statement_of(std::string_view line);

/// The lines of a scene in steps: a command by itself, and what stands in a block together with the lines
/// that open and close it. Throws InvalidInput naming `source` and the line that opens a block which is not
/// closed. O(n).
std::vector<std::span<const SceneLine>> scene_steps(std::span<const SceneLine> lines,
                                                    const std::string& source);

/// The names of the variables that `let` sets in the lines, in order, each once.
std::vector<std::string> variables_of(std::span<const SceneLine> lines);

/// Takes the lines of a scene one after the other: keeps its variables, and hands every command on with its
/// variables put in, those in a block as soon as that is closed. A line without ${ is handed on as it is.
class SceneScript {
  public:
    /// Runs one command; `place` is that of its line.
    using Run = std::function<void(std::string_view command, const std::string& place)>;

    /// `given` has values that go before those of the first `let` of each name, as they were typed; one block
    /// may run `most_lines`, counted as often as they run.
    explicit SceneScript(std::map<std::string, std::string> given = {}, int most_lines = 100'000)
        : given_(given.begin(), given.end()), most_lines_(most_lines) {}

    /// Takes a line; `place` begins messages. Throws InvalidInput for a statement that is not understood, an
    /// expression that has no value, more lines than are allowed; Cancelled; what `run` throws. A block that
    /// fails is given up where it stands; an open one stays open when a line of it is refused.
    void take(std::string_view line, const std::string& place, const Run& run, const Context& ctx);

    bool open() const { return !opened_.empty(); }  ///< whether a block waits for its end
    /// Throws InvalidInput naming the line that opened the block, if one is open, and forgets it.
    void finish();

    const SceneVariables& variables() const { return variables_; }  ///< as they are now
    void set_seed(int seed);                                        ///< of random(), which begins anew; >= 0

  private:
    struct Line {
        const SceneStatement* statement;  ///< none: a command
        std::string text, place;
        std::string name, rest;     ///< of a variable, and what follows it
        std::size_t otherwise = 0;  ///< of if: the line of its else, or of its end
        std::size_t end = 0;        ///< of what opens a block
    };
    struct Running {
        const std::vector<Line>& lines;
        const Run& run;
        const Context& ctx;
        int left;  ///< lines that may still run
    };
    struct Turns {
        double first = 0, step = 0;
        int count = 0;
    };

    void gather(Line line);
    void execute(Running& running, std::size_t first, std::size_t last);
    std::size_t execute_line(Running& running, std::size_t at);
    void run_command(const Running& running, const Line& line);
    void let(const Line& line);
    void loop(Running& running, std::size_t at);
    Turns turns_of(const Line& line);

    std::map<std::string, std::string, std::less<>> given_;
    std::set<std::string, std::less<>> declared_;
    int most_lines_;
    SceneVariables variables_;
    std::vector<Line> block_;
    std::vector<std::size_t> opened_;  ///< lines of block_ that wait for their end
};

}  // namespace coppice
