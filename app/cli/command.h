#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/scene/file_kind.h"
#include "options.h"
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

struct Command;

/// Declares that a command with one input file and one output file can process many files, each by itself;
/// see run_batch().
struct ManyFiles {
    Command (*make)();            ///< creates the command again, with values of its own
    std::string_view input;       ///< name of the option with the input file
    std::string_view extension;   ///< extension of the outputs; empty: --name is required
    std::vector<FileKind> kinds;  ///< kinds of files that are used of a folder
};

/// A subcommand. `run` does the work after the options are parsed, and owns the values into which they are
/// stored. Throws the exceptions of the library, and UsageError.
struct Command {
    std::string name;
    std::string help;  ///< one sentence
    OptionList options;
    std::function<ExitCode(Run&, const GivenOptions&)> run;
    std::optional<ManyFiles> many = std::nullopt;  ///< set if the command can process many files
};

/// Returns the commands that need no terminal, in the order of the help.
std::vector<Command> batch_commands();
/// Adds the common options to each command.
std::vector<Command> with_common_options(std::vector<Command> commands, CommonFlags& common);

Command mesh_command();
Command extract_command();
Command sketch_command();
Command library_command();
Command compose_command();
Command check_command();
Command compare_command();
Command info_command();
Command table_command();
Command chart_command();
Command convert_command();
Command render_command();
Command view_command();
Command scan_command();
Command texture_command();
Command leaves_command();
Command tree_command();
Command species_command();
Command run_command();
Command grow_command();
Command sprout_command();
Command edit_command();
Command animate_command();
Command shell_command();
Command studio_command();
/// Describes the commands that the function returns.
Command schema_command(std::function<std::vector<Command>()> list);

/// Returns the flags of the members of MeshOptions where they differ from the names of the members; `common`
/// are the members that the short help shows.
FlagNames surface_flag_names(const std::optional<MemberNames>& common = {});
/// The same for the options of --then-mesh, which share a command with options of the skeleton.
FlagNames then_mesh_flag_names();
/// The same for LibraryFilter.
FlagNames library_flag_names();

}  // namespace coppice::cli
