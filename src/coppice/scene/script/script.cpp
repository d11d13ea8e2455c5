#include "coppice/scene/script/script.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/base/quote.h"
#include "coppice/options/quantity.h"
#include "coppice/scene/place_internal.h"

namespace coppice {

using scene_internal::placed;

namespace {

constexpr std::size_t kDeepest = 32;  // maximum depth of nested blocks
constexpr std::size_t kMaxVariables = 10'000;
constexpr double kSameTurn = 1e-9;  // [steps] tolerance of the end of a range for rounding errors

constexpr std::array<SceneStatement, 6> kStatements{{
    {"let", "let NAME = EXPRESSION", "Set a variable, which ${NAME} inserts into the following lines.",
     "let height = 4\nlet name = \"oak\"\nsphere ${name} radius=${height / 2} center=0,0,${height}"},
    {"for", "for NAME in FIRST..LAST [step STEP]",
     "Run the lines up to the end for each number from the first to the last, which is stored in a variable.",
     "for i in 1..3\n  sphere ball${i} center=${2 * i},0,0\nend"},
    {"repeat", "repeat COUNT", "Run the lines up to the end a number of times.",
     "sphere pile\nrepeat 3\n  translate pile 0 0 ${random(0.5, 1)}\nend"},
    {"if", "if CONDITION", "Run the lines up to the else or end if the condition is not 0.",
     "let thick = 1\nif thick > 0.5\n  sphere trunk radius=${thick}\nelse\n  sphere trunk radius=0.5\nend"},
    {"else", "else", "Begin the lines that run if the condition of the if above is 0.",
     "if 2 < 1\n  sphere small\nelse\n  sphere large radius=2\nend"},
    {"end", "end", "Close the for, repeat or if above.", "repeat 2\n  sphere again\nend"},
}};

enum StatementIndex { kLet, kFor, kRepeat, kIf, kElse, kEnd };

bool is(const SceneStatement* statement, StatementIndex index) { return statement == &kStatements[index]; }
bool opens(const SceneStatement* s) { return is(s, kFor) || is(s, kRepeat) || is(s, kIf); }

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view without_blanks(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

/// Removes a comment, which begins with a # at the start of a word outside quotes.
std::string_view without_comment(std::string_view line) {
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quoted && line[i] == '\\') {
            ++i;
        } else if (line[i] == '"') {
            quoted = !quoted;
        } else if (!quoted && line[i] == '#' && (i == 0 || is_blank(line[i - 1]))) {
            return line.substr(0, i);
        }
    }
    return line;
}

std::string_view taken_word(std::string_view& text) {
    text = without_blanks(text);
    const auto end = std::ranges::find_if(text, is_blank);
    const std::string_view word = text.substr(0, static_cast<std::size_t>(end - text.begin()));
    text.remove_prefix(word.size());
    return word;
}

[[noreturn]] void refuse(const SceneStatement& s) {
    throw InvalidInput(fmt::format("the syntax of this line is: {}", s.usage));
}

/// Reads the name of a variable at the beginning of the text.
std::string taken_name(const SceneStatement& statement, std::string_view& text) {
    text = without_blanks(text);
    const auto end = std::ranges::find_if(text, [](char c) { return is_blank(c) || c == '='; });
    std::string name(text.substr(0, static_cast<std::size_t>(end - text.begin())));
    if (name.empty()) refuse(statement);
    if (!is_variable_name(name)) {
        throw InvalidInput(
            fmt::format("{} is not a valid name of a variable: letters, digits and _ after a letter, and no "
                        "word of the language",
                        quote(name)));
    }
    text.remove_prefix(name.size());
    return name;
}

struct Head {
    std::string name, rest;
};

/// Returns the variable of a statement and the remaining text.
Head parse_head(const SceneStatement& statement, std::string_view line) {
    std::string_view rest = without_comment(line);
    taken_word(rest);
    Head head;
    if (is(&statement, kLet)) {
        head.name = taken_name(statement, rest);
        rest = without_blanks(rest);
        if (!rest.starts_with('=')) refuse(statement);
        rest.remove_prefix(1);
    } else if (is(&statement, kFor)) {
        head.name = taken_name(statement, rest);
        if (taken_word(rest) != "in") refuse(statement);
    }
    head.rest = without_blanks(rest);
    const bool alone = is(&statement, kElse) || is(&statement, kEnd);
    if (head.rest.empty() != alone) refuse(statement);
    return head;
}

std::string with_name(const std::string& place, const SceneStatement& statement) {
    return place.empty() ? std::string(statement.name) : fmt::format("{}: {}", place, statement.name);
}

/// Returns the line with its variables expanded.
std::string find_command(const std::string& line, SceneVariables& variables) {
    if (line.find("${") == line.npos) return line;
    std::string out;
    for (const SceneWord& word : scene_words(line)) {
        if (!out.empty()) out += ' ';
        if (!word.key.empty()) out += word.key + "=";
        out += quoted_word(expanded(word.text, variables));
        if (out.size() > kLongestLine)
            throw InvalidInput(
                fmt::format("with its variables the line is longer than {} bytes", kLongestLine));
    }
    return out;
}

/// Restores the previous value of a variable after a loop, also after an exception.
class Restored {
  public:
    Restored(SceneVariables& variables, const std::string& name) : variables_(variables), name_(name) {
        const auto found = variables.values.find(name);
        known_ = found != variables.values.end();
        if (known_) before_ = found->second;
    }
    ~Restored() {
        if (known_) {
            variables_.values.insert_or_assign(name_, std::move(before_));
        } else {
            variables_.values.erase(name_);
        }
    }
    Restored(const Restored&) = delete;
    Restored& operator=(const Restored&) = delete;

  private:
    SceneVariables& variables_;
    const std::string& name_;
    SceneValue before_;
    bool known_ = false;
};

}  // namespace

std::span<const SceneStatement> scene_statements() { return kStatements; }

const SceneStatement* find_statement(std::string_view line) {
    const std::string_view first = taken_word(line);
    const auto found = std::ranges::find(kStatements, first, &SceneStatement::name);
    return found == kStatements.end() ? nullptr : &*found;
}

std::vector<std::span<const SceneLine>> scene_steps(std::span<const SceneLine> lines,
                                                    const std::string& source) {
    std::vector<std::span<const SceneLine>> steps;
    std::vector<std::size_t> opened;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const SceneStatement* statement = find_statement(lines[i].text);
        if (opens(statement)) opened.push_back(i);
        const std::size_t first = opened.empty() ? i : opened.front();
        if (is(statement, kEnd) && !opened.empty()) opened.pop_back();
        if (opened.empty()) steps.push_back(lines.subspan(first, i + 1 - first));
    }
    if (opened.empty()) return steps;
    const SceneLine& line = lines[opened.back()];
    throw InvalidInput(
        fmt::format("{}:{}: no end closes this {}", source, line.number, find_statement(line.text)->name));
}

std::vector<std::string> find_variables(std::span<const SceneLine> lines) {
    std::vector<std::string> names;
    std::set<std::string, std::less<>> known;
    for (const SceneLine& line : lines) {
        const SceneStatement* statement = find_statement(line.text);
        if (!is(statement, kLet)) continue;
        try {
            std::string name = parse_head(*statement, line.text).name;
            if (known.insert(name).second) names.push_back(std::move(name));
        } catch (const InvalidInput&) {
            continue;  // running the scene reports the error
        }
    }
    return names;
}

void SceneScript::take(std::string_view line, const std::string& place, const Run& run, const Context& ctx) {
    Line taken{.statement = find_statement(line), .text = std::string(line), .place = place};
    if (taken.statement != nullptr) {
        const Head head =
            placed(with_name(place, *taken.statement), [&] { return parse_head(*taken.statement, line); });
        taken.name = head.name;
        taken.rest = head.rest;
    }
    std::vector<Line> lines;
    if (open() || opens(taken.statement) || is(taken.statement, kElse) || is(taken.statement, kEnd)) {
        gather(std::move(taken));
        if (open()) return;
        lines = std::exchange(block_, {});
    } else {
        lines.push_back(std::move(taken));
    }
    Running running{.lines = lines, .run = run, .ctx = ctx, .left = max_lines_};
    execute(running, 0, lines.size());
}

void SceneScript::finish() {
    if (!open()) return;
    const Line opener = block_[opened_.back()];
    opened_.clear();
    block_.clear();
    placed(opener.place,
           [&]() { throw InvalidInput(fmt::format("no end closes this {}", opener.statement->name)); });
}

void SceneScript::set_seed(int seed) {
    variables_.seed = seed;
    variables_.draws = 0;
}

/// Adds a line to the block, or closes the block with it.
void SceneScript::gather(Line line) {
    const std::size_t at = block_.size();
    placed(line.statement ? with_name(line.place, *line.statement) : line.place, [&] {
        if (at >= kMaxLines) throw InvalidInput(fmt::format("the block has more than {} lines", kMaxLines));
        if (opens(line.statement) && opened_.size() >= kDeepest)
            throw InvalidInput(fmt::format("blocks may be nested at most {} deep", kDeepest));
        if (!is(line.statement, kElse) && !is(line.statement, kEnd)) return;
        if (opened_.empty()) throw InvalidInput("there is no open block to which it could belong");
        Line& opener = block_[opened_.back()];
        if (is(line.statement, kElse)) {
            if (!is(opener.statement, kIf) || opener.otherwise > 0)
                throw InvalidInput("there is no open if to which it could belong");
            opener.otherwise = at;
        } else {
            if (opener.otherwise == 0) opener.otherwise = at;
            opener.end = at;
        }
    });
    if (opens(line.statement)) opened_.push_back(at);
    if (is(line.statement, kEnd)) opened_.pop_back();
    block_.push_back(std::move(line));
}

void SceneScript::execute(Running& running, std::size_t first, std::size_t last) {
    for (std::size_t at = first; at < last;) at = execute_line(running, at);
}

/// Executes a line and returns the index of the next one.
std::size_t SceneScript::execute_line(Running& running, std::size_t at) {
    const Line& line = running.lines[at];
    running.ctx.throw_if_cancelled();
    if (--running.left < 0) {
        placed(line.place, [&] {
            throw InvalidInput(fmt::format(
                "the block has run {} lines, which is the maximum; make its loops shorter", max_lines_));
        });
    }
    if (line.statement == nullptr) {
        run_command(running, line);
        return at + 1;
    }
    if (is(line.statement, kLet)) {
        placed(with_name(line.place, *line.statement), [&] { let(line); });
        return at + 1;
    }
    if (is(line.statement, kIf)) {
        const bool holds = placed(with_name(line.place, *line.statement),
                                  [&] { return number_in(evaluate(line.rest, variables_), "if") != 0; });
        if (holds) execute(running, at + 1, line.otherwise);
        if (!holds && line.otherwise < line.end) execute(running, line.otherwise + 1, line.end);
        return line.end + 1;
    }
    if (is(line.statement, kEnd)) return at + 1;
    loop(running, at);
    return line.end + 1;
}

void SceneScript::run_command(const Running& running, const Line& line) {
    const std::uint64_t draws = variables_.draws;
    try {
        const std::string command = placed(line.place, [&] { return find_command(line.text, variables_); });
        running.run(command, line.place);
    } catch (...) {
        variables_.draws = draws;  // a failed line has no effects
        throw;
    }
}

void SceneScript::let(const Line& line) {
    SceneValue value = evaluate(line.rest, variables_);
    const auto given = given_.find(line.name);
    if (given != given_.end() && declared_.insert(line.name).second) {
        if (std::holds_alternative<double>(value)) {
            const auto number = parse_finite(given->second);
            if (!number) {
                throw InvalidInput(
                    fmt::format("{} is a number, and is set to {}", line.name, quote(given->second)));
            }
            value = *number;
        } else {
            value = given->second;
        }
    }
    if (variables_.values.size() >= kMaxVariables && !variables_.values.contains(line.name))
        throw InvalidInput(fmt::format("a scene has at most {} variables", kMaxVariables));
    variables_.values.insert_or_assign(line.name, std::move(value));
}

SceneScript::Turns SceneScript::compute_turns(const Line& line) {
    std::string_view rest = line.rest;
    const std::string subject(line.statement->name);
    if (is(line.statement, kRepeat)) {
        const double count = number_in(evaluate(rest, variables_), subject);
        if (count < 0 || count != std::floor(count))
            throw InvalidInput(fmt::format("it needs a whole number of turns, not {}", count));
        return {.first = 1, .step = 1, .count = static_cast<int>(std::min(count, 1.0 + max_lines_))};
    }
    const double first = number_in(evaluate_front(rest, variables_), subject);
    if (!rest.starts_with("..")) refuse(*line.statement);
    rest.remove_prefix(2);
    const double last = number_in(evaluate_front(rest, variables_), subject);
    double step = 1;
    if (rest.starts_with("step")) {
        rest.remove_prefix(4);
        step = number_in(evaluate_front(rest, variables_), subject);
    }
    if (!rest.empty()) refuse(*line.statement);
    if (step == 0) throw InvalidInput("the step is 0, and would never reach the last number");
    const double count = std::floor((last - first) / step + kSameTurn) + 1;
    return {
        .first = first, .step = step, .count = static_cast<int>(std::clamp(count, 0.0, 1.0 + max_lines_))};
}

void SceneScript::loop(Running& running, std::size_t at) {
    const Line& line = running.lines[at];
    const Turns turns = placed(with_name(line.place, *line.statement), [&] { return compute_turns(line); });
    if (line.name.empty()) {
        for (int i = 0; i < turns.count; ++i) execute(running, at + 1, line.end + 1);
        return;
    }
    const Restored restored(variables_, line.name);
    for (int i = 0; i < turns.count; ++i) {
        variables_.values.insert_or_assign(line.name, turns.first + turns.step * i);
        execute(running, at + 1, line.end + 1);
    }
}

}  // namespace coppice
