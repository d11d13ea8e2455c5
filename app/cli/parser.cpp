#include "parser.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "coppice/base/quote.h"
#include "coppice/options/renamed.h"
#include "coppice/options/spelling.h"
#include "coppice/version.h"

namespace coppice::cli {
namespace {

std::string list_names(const Option& option) {
    return option.letter.empty() ? option.name : option.letter + "," + option.name;
}

/// Returns whether a switch can be turned on and off: only members of option structs.
bool is_two_way(const Option& option) {
    return std::holds_alternative<bool*>(option.target) && !option.field.empty();
}

/// "--flat" -> "--no-flat"
std::string off_name(const Option& option) { return "--no-" + option.name.substr(2); }

/// For a switch that can be turned on and off, the help shows only the flag that changes the default.
void add_switch(CLI::App& app, const Option& option, bool* value) {
    if (!is_two_way(option)) {
        CLI::Option* const added = app.add_flag(list_names(option), *value, option.help);
        if (!option.group.empty()) added->group(option.group);
        return;
    }
    const auto turn_on = [value](std::int64_t) { *value = true; };
    const auto turn_off = [value](std::int64_t) { *value = false; };
    CLI::Option* const on_option =
        app.add_flag_function(option.name, turn_on, option.help + " [default off]")->group(option.group);
    CLI::Option* const off_option =
        app.add_flag_function(off_name(option), turn_off, "Turn off: " + option.help + " [default on]")
            ->group(option.group);
    (*value ? on_option : off_option)->group("");
}

void add_option(CLI::App& app, const Option& option) {
    if (bool* const* value = std::get_if<bool*>(&option.target)) return add_switch(app, option, *value);
    const bool many = std::holds_alternative<std::vector<std::filesystem::path>*>(option.target) ||
                      std::holds_alternative<std::vector<std::string>*>(option.target);
    const bool positional = !option.name.starts_with("-");
    const auto take = [&option](const std::vector<std::string>& words) {
        for (const std::string& word : words) store(option, word);
        return true;
    };
    CLI::Option* const added = app.add_option(list_names(option), take, help_text(option));
    added->type_name(option.type);
    if (!option.group.empty()) added->group(option.group);
    if (!many) return;
    added->expected(1, positional ? CLI::detail::expected_max_vector_size : 1)->take_all();
    added->allow_extra_args(positional);
}

std::vector<std::string> list_names(std::span<const Command> commands) {
    std::vector<std::string> names;
    for (const Command& command : commands) names.push_back(command.name);
    names.emplace_back("help");
    return names;
}

std::vector<std::string> flag_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

/// Removes rarely used options from the help.
void hide_uncommon(CLI::App& app, const Command& command) {
    for (const Option& option : command.options.all()) {
        if (option.common) continue;
        app.get_option(option.name)->group("");
        if (is_two_way(option)) app.get_option(off_name(option))->group("");
    }
}

/// Returns the words of a command line with present flags in place of former ones, where the command has the
/// present flag and no other option of the former name.
std::vector<std::string> with_present_flags(std::span<const char* const> arguments, const Command* command) {
    std::vector<std::string> words(arguments.begin(), arguments.end());
    if (command == nullptr) return words;
    const auto has = [&](const std::string& flag) {
        return std::ranges::find(command->options.all(), flag, &Option::name) != command->options.all().end();
    };
    for (std::string& word : words) {
        if (!word.starts_with("--")) continue;
        const std::size_t end = std::min(word.find('='), word.size());
        const std::string flag = word.substr(0, end);
        std::string name = flag.substr(2);
        std::ranges::replace(name, '-', '_');
        const std::string present = flag_name(present_name(name));
        if (!has(flag) && has(present)) word.replace(0, end, present);
    }
    return words;
}

/// Throws UsageError for words that no option accepts.
void check_extras(const CLI::App& app, const std::string& name) {
    const std::vector<std::string> extras = app.remaining();
    if (extras.empty()) return;
    for (const std::string& word : extras) {
        if (!word.starts_with("-") || word == "-") continue;
        const std::string flag = word.substr(0, word.find('='));
        throw UsageError(
            fmt::format("{} has no option {}{}", name, shortened(flag), did_you_mean(flag, flag_names(app))));
    }
    throw UsageError(fmt::format("{} does not accept {}", name, quote(extras.front())));
}

/// Returns the positional words that follow those of the options.
std::vector<std::filesystem::path> further_inputs(const CLI::App& app) {
    std::vector<std::filesystem::path> inputs;
    for (const std::string& word : app.remaining())
        if (!word.starts_with("-")) inputs.emplace_back(word);
    return inputs;
}

/// Returns the first word that is not a flag: `coppice --help mesh` is the same as `coppice mesh --help`.
std::string find_topic(std::span<const char* const> arguments) {
    for (const char* word : arguments.subspan(1)) {
        if (!std::string_view(word).starts_with("-")) return word;
    }
    return {};
}

GivenOptions given_options(const CLI::App& app, const Command& command) {
    GivenOptions given;
    for (const Option& option : command.options.all())
        if (app.count(option.name) > 0) given.push_back(&option);
    return given;
}

}  // namespace

struct Parser::Program {
    std::span<const Command> commands;
    CLI::App app{"Coppice: converts skeletons with radii into one closed quad surface", "coppice"};

    /// Throws UsageError if there is no command of this name.
    const Command& command(const std::string& name) const {
        for (const Command& command : commands)
            if (command.name == name) return command;
        throw UsageError(
            fmt::format("there is no command {}{}", quote(name), did_you_mean(name, list_names(commands))));
    }
};

Parser::Parser(std::span<const Command> commands) : program_(std::make_unique<Program>()) {
    program_->commands = commands;
    CLI::App& app = program_->app;
    app.allow_extras();
    app.require_subcommand(0, 1);  // a file after a command may have the name of another command
    app.set_version_flag("--version", "coppice " + std::string(kVersion));
    app.set_help_flag("-h,--help", "Print the options that are used most.");
    app.set_help_all_flag("--help-all", "Print all options.");
    app.footer(
        "coppice help COMMAND prints the help of a command, coppice help COMMAND --all all of its options.");
    for (const Command& command : commands) {
        CLI::App* const sub = app.add_subcommand(command.name, command.help);
        sub->allow_extras();  // parse() reports them with the most similar name
        for (const Option& option : command.options.all()) add_option(*sub, option);
    }
    app.add_subcommand("help", "Print the help of a command.");
}

Parser::~Parser() = default;

std::string Parser::format_help(const std::string& topic, bool all) {
    if (topic.empty()) return program_->app.help();
    const Command& command = program_->command(topic);
    CLI::App& app = *program_->app.get_subcommand(command.name);
    app.footer(all ? ""
                   : fmt::format("coppice {} --help-all prints all {} options.", command.name,
                                 command.options.all().size()));
    if (!all) hide_uncommon(app, command);
    return app.help("coppice");
}

std::string Parser::help_on(std::span<const char* const> words) {
    std::string topic;
    bool all = false;
    for (const std::string word : words) {
        if (word == "--all") {
            all = true;
        } else if (topic.empty() && !word.starts_with("-")) {
            topic = word;
        } else {
            throw UsageError(fmt::format("help takes a command and --all, not '{}'", word));
        }
    }
    return format_help(topic, all);
}

Parser::Request Parser::parse(std::span<const char* const> arguments) {
    CLI::App& app = program_->app;
    const std::string first = arguments.size() > 1 ? arguments[1] : "";
    // The parser would treat the topic as a second command, and print a help for any command.
    if (first == "help") return {.text = help_on(arguments.subspan(2))};
    const Command* const command =
        first.empty() || first.starts_with("-") ? nullptr : &program_->command(first);
    try {
        std::vector<std::string> words = with_present_flags(arguments.subspan(1), command);
        std::ranges::reverse(words);  // as the parser expects them
        app.parse(std::move(words));
    } catch (const CLI::CallForHelp&) {
        return {.text = format_help(find_topic(arguments), false)};
    } catch (const CLI::CallForAllHelp&) {
        return {.text = format_help(find_topic(arguments), true)};
    } catch (const CLI::Success& request) {
        return {.text = std::string(request.what()) + "\n"};
    } catch (const CLI::ParseError& error) {
        throw UsageError(error.what());
    }
    check_extras(app, "coppice");
    if (command == nullptr) throw UsageError("no command given; coppice help lists them");
    const CLI::App& parsed = *app.get_subcommand(command->name);
    std::vector<std::filesystem::path> further;
    if (command->many) further = further_inputs(parsed);
    if (further.size() != parsed.remaining().size()) check_extras(parsed, "coppice " + command->name);
    return {.command = command, .given = given_options(parsed, *command), .further = std::move(further)};
}

}  // namespace coppice::cli
