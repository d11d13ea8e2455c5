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

/// A statement of the language: let, for, repeat, if, else, end. All other lines are commands.
struct SceneStatement {
    std::string_view name;     ///< "for"
    std::string_view usage;    ///< "for NAME in FIRST..LAST [step STEP]"
    std::string_view help;     ///< one sentence with a capital and a full stop
    std::string_view example;  ///< valid lines
};

/// Returns all statements, in the order of the reference page.
std::span<const SceneStatement> scene_statements();

/// Returns the statement in a line; null for a command.
const SceneStatement* find_statement(std::string_view line);

/// Splits the lines of a scene into steps: a single command, or a block with the lines that open and close
/// it. Throws InvalidInput naming `source` and the line that opens a block which is not closed. O(n).
std::vector<std::span<const SceneLine>> scene_steps(std::span<const SceneLine> lines,
                                                    const std::string& source);

/// Returns the names of the variables that `let` sets in the lines, in order, without duplicates.
std::vector<std::string> find_variables(std::span<const SceneLine> lines);

/// Interpreter of the lines of a scene: stores its variables, and passes every command on with its variables
/// expanded; commands in a block are passed when it is closed. A line without ${ is passed on unchanged.
class SceneScript {
  public:
    /// Runs one command; `place` is the location of its line.
    using Run = std::function<void(std::string_view command, const std::string& place)>;

    /// `given` contains values as entered that replace those of the first `let` of each name; a block may run
    /// at most `max_lines` lines, counted for every execution.
    explicit SceneScript(std::map<std::string, std::string> given = {}, int max_lines = 100'000)
        : given_(given.begin(), given.end()), max_lines_(max_lines) {}

    /// Processes a line; `place` is the prefix of messages. Throws InvalidInput for a statement that cannot
    /// be parsed, an expression without a value, or too many lines; Cancelled; and as `run` does. A block
    /// that fails is aborted; an open block remains open if one of its lines is invalid.
    void take(std::string_view line, const std::string& place, const Run& run, const Context& ctx);

    bool open() const { return !opened_.empty(); }  ///< whether a block is not closed yet
    /// If a block is open, discards it and throws InvalidInput naming the line that opened it.
    void finish();

    const SceneVariables& variables() const { return variables_; }  ///< current values
    void set_seed(int seed);  ///< sets the seed of random() and restarts its sequence; >= 0

  private:
    struct Line {
        const SceneStatement* statement;  ///< null: a command
        std::string text, place;
        std::string name, rest;     ///< name of a variable, and the remaining text
        std::size_t otherwise = 0;  ///< for if: the line of its else or end
        std::size_t end = 0;        ///< for a line that opens a block: its end
    };
    struct Running {
        const std::vector<Line>& lines;
        const Run& run;
        const Context& ctx;
        int left;  ///< number of lines that may still run
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
    Turns compute_turns(const Line& line);

    std::map<std::string, std::string, std::less<>> given_;
    std::set<std::string, std::less<>> declared_;
    int max_lines_;
    SceneVariables variables_;
    std::vector<Line> block_;
    std::vector<std::size_t> opened_;  ///< lines of block_ without an end yet
};

}  // namespace coppice
