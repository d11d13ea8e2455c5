#include <fmt/format.h>

#include <filesystem>
#include <new>

#include "command.h"
#include "coppice/system/file.h"
#include "memory.h"
#include "messages.h"
#include "outputs.h"
#include "parser.h"
#include "signals.h"
#include "streams.h"

namespace coppice::cli {
namespace {

ExitCode run_command_line(std::span<const char* const> arguments, Signals& signals) {
    CommonFlags common;
    const std::vector<Command> commands = all_commands(common);
    const Parser::Request request = Parser(commands).parse(arguments);
    if (request.command == nullptr) {
        print(request.text);
        return kDone;
    }
    check_outputs(request.given);
    Run run(request.command->name, common, signals);
    return request.command->run(run, request.given);
}

ExitCode fail(ExitCode code, const char* message) {
    say(message);
    return code;
}

ExitCode run_program(std::span<const char* const> arguments) {
    open_standard_streams();
    Signals signals;
    try {
        const ExitCode code = run_command_line(arguments, signals);
        flush_output();
        return code;
    } catch (const UsageError& error) {
        return fail(kWrongUsage, error.what());
    } catch (const Cancelled& error) {
        return fail(kInterrupted, error.what());
    } catch (const IoError& error) {
        return fail(kFileTrouble, error.what());
    } catch (const Error& error) {
        return fail(kBadInput, error.what());
    } catch (const std::filesystem::filesystem_error& error) {
        return fail(kFileTrouble, fmt::format("cannot use {}: {}", error.path1().string(),
                                              file_error_text(error.code().value()))
                                      .c_str());
    } catch (const std::bad_alloc&) {
        return fail(kBadInput, out_of_memory_text());
    } catch (const std::exception& error) {
        return fail(kBadInput,
                    fmt::format("this is a defect of coppice, please report it: {}", error.what()).c_str());
    }
}

}  // namespace
}  // namespace coppice::cli

int main(int argc, char** argv) { return coppice::cli::run_program({argv, static_cast<std::size_t>(argc)}); }
