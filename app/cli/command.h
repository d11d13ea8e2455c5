#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <stop_token>

#include "run.h"

namespace coppice::cli {

/// Exit codes, the same for all commands.
enum ExitCode : int {
    kDone = 0,
    kCheckFailed = 1,
    kWrongUsage = 2,
    kBadInput = 3,
    kFileTrouble = 4,
    kInterrupted = 130
};

/// A subcommand: its flags are in `app`, and `run` does the work after they are parsed. Throws what the
/// library throws, and UsageError.
struct Command {
    CLI::App* app = nullptr;
    std::shared_ptr<CommonFlags> common;
    std::function<ExitCode(Run&)> run;
};

Command mesh_command(CLI::App& app);
Command extract_command(CLI::App& app);
Command check_command(CLI::App& app);
Command compare_command(CLI::App& app);
Command info_command(CLI::App& app);
Command convert_command(CLI::App& app);
Command render_command(CLI::App& app);
Command scan_command(CLI::App& app);
Command run_command(CLI::App& app);
Command grow_command(CLI::App& app);
Command shell_command(CLI::App& app);
Command schema_command(CLI::App& app);

/// Makes a subcommand whose options are all of type Flags, shared by the parser and the work.
template <class Flags>
std::pair<Command, std::shared_ptr<Flags>> new_command(CLI::App& app, const std::string& name,
                                                       const std::string& description) {
    Command command{app.add_subcommand(name, description), std::make_shared<CommonFlags>(), {}};
    command.app->allow_extras();  // main names them, with the nearest spelling
    return {command, std::make_shared<Flags>()};
}

}  // namespace coppice::cli
