#include "batch_run.h"
#include "catch_errors.h"
#include "command.h"
#include "messages.h"
#include "outputs.h"
#include "parser.h"
#include "signals.h"
#include "streams.h"
#include "terminal.h"

namespace coppice::cli {
namespace {

/// Returns all commands in the order of the help.
std::vector<Command> program_commands() {
    std::vector<Command> commands = batch_commands();
    commands.push_back(shell_command());
    commands.push_back(studio_command());
    commands.push_back(schema_command(program_commands));
    return commands;
}

ExitCode run_command_line(std::span<const char* const> arguments, Signals& signals) {
    CommonFlags common;
    const std::vector<Command> commands = with_common_options(program_commands(), common);
    const Parser::Request request = Parser(commands).parse(arguments);
    if (request.command == nullptr) {
        print(request.text);
        return kDone;
    }
    check_outputs(request.given);
    Terminal terminal(signals);
    Run run(request.command->name, common, terminal);
    return run_request(run, request);
}

ExitCode run_program(std::span<const char* const> arguments) {
    open_standard_streams();
    Signals signals;
    return catch_errors(
        [&] {
            const ExitCode code = run_command_line(arguments, signals);
            flush_output();
            return code;
        },
        say);
}

}  // namespace
}  // namespace coppice::cli

int main(int argc, char** argv) { return coppice::cli::run_program({argv, static_cast<std::size_t>(argc)}); }
