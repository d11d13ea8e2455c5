#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <new>

#include "command.h"
#include "coppice/version.h"
#include "options.h"
#include "signals.h"

namespace coppice::cli {
namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* sub : app.get_subcommands({})) names.push_back(sub->get_name());
    return names;
}

std::vector<std::string> flag_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

/// Throws a UsageError for words that nothing has taken.
void check_extras(const CLI::App& app, const std::string& name) {
    const std::vector<std::string> extras = app.remaining();
    if (extras.empty()) return;
    for (const std::string& word : extras) {
        if (!word.starts_with("-") || word == "-") continue;
        const std::string flag = word.substr(0, word.find('='));
        throw UsageError(
            fmt::format("{} has no option {}{}", name, flag, did_you_mean(flag, flag_names(app))));
    }
    throw UsageError(fmt::format("{} does not know what to do with '{}'", name, extras.front()));
}

void check_top_level(const CLI::App& app) {
    const std::vector<std::string> extras = app.remaining();
    if (!extras.empty() && !extras.front().starts_with("-")) {
        throw UsageError(fmt::format("there is no command '{}'{}", extras.front(),
                                     did_you_mean(extras.front(), subcommand_names(app))));
    }
    check_extras(app, "coppice");
    if (app.get_subcommands().empty()) throw UsageError("no command given; coppice help lists them");
}

class Program {
  public:
    Program() {
        app_.allow_extras();
        app_.set_version_flag("--version", "coppice " + std::string(kVersion));
        app_.footer("coppice help COMMAND lists the options of a command.");
        for (const auto make :
             {mesh_command, extract_command, check_command, compare_command, info_command, convert_command,
              render_command, scan_command, run_command, grow_command, shell_command, schema_command}) {
            commands_.push_back(make(app_));
            add_common_flags(*commands_.back().app, *commands_.back().common);
        }
        app_.add_subcommand("help", "Explain a command: coppice help COMMAND");
    }

    ExitCode run(int argc, const char* const* argv, Signals& signals) {
        // The parser would take the topic for a second command.
        if (argc >= 2 && std::string_view(argv[1]) == "help") return help(argc > 2 ? argv[2] : "");
        try {
            app_.parse(argc, argv);
        } catch (const CLI::Success& request) {
            app_.exit(request);  // prints the help or version that was asked for
            return kDone;
        } catch (const CLI::ParseError& error) {
            throw UsageError(error.what());
        }
        check_top_level(app_);
        for (const Command& command : commands_) {
            if (!command.app->parsed()) continue;
            check_extras(*command.app, "coppice " + command.app->get_name());
            Run work(command.app->get_name(), *command.common, signals);
            return command.run(work);
        }
        return kWrongUsage;
    }

  private:
    ExitCode help(const std::string& topic) const {
        if (topic.empty()) {
            fmt::print("{}", app_.help());
            return kDone;
        }
        for (const Command& command : commands_) {
            if (command.app->get_name() != topic) continue;
            fmt::print("{}", command.app->help("coppice"));
            return kDone;
        }
        throw UsageError(
            fmt::format("there is no command '{}'{}", topic, did_you_mean(topic, subcommand_names(app_))));
    }

    CLI::App app_{"Coppice: skeletons with radii become one closed surface of quads", "coppice"};
    std::vector<Command> commands_;
};

ExitCode fail(ExitCode code, const char* message) {
    fmt::print(stderr, "coppice: {}\n", message);
    return code;
}

ExitCode run_program(int argc, const char* const* argv) {
    Signals signals;
    try {
        const ExitCode code = Program().run(argc, argv, signals);
        if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
            return fail(kFileTrouble, "the standard output cannot be written");
        }
        return code;
    } catch (const UsageError& error) {
        return fail(kWrongUsage, error.what());
    } catch (const Cancelled& error) {
        return fail(kInterrupted, error.what());
    } catch (const IoError& error) {
        return fail(kFileTrouble, error.what());
    } catch (const Error& error) {
        return fail(kBadInput, error.what());
    } catch (const std::bad_alloc&) {
        return fail(kBadInput, "there is not enough memory for this input with these options");
    } catch (const std::exception& error) {
        return fail(kBadInput,
                    fmt::format("this should not happen, please report it: {}", error.what()).c_str());
    }
}

}  // namespace
}  // namespace coppice::cli

int main(int argc, char** argv) { return coppice::cli::run_program(argc, argv); }
