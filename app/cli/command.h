#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

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

/// The options that stood on the command line.
using GivenOptions = std::vector<const Option*>;

/// A subcommand: `run` does the work after its options are parsed, and keeps alive what they store into.
/// Throws what the library throws, and UsageError.
struct Command {
    std::string name;
    std::string help;  ///< one sentence without a full stop, which the help adds
    OptionList options;
    std::function<ExitCode(Run&, const GivenOptions&)> run;
};

/// All of them, in the order of the help, with the options that all have.
std::vector<Command> all_commands(CommonFlags& common);

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
Command run_command();
Command grow_command();
Command sprout_command();
Command edit_command();
Command animate_command();
Command shell_command();
Command studio_command();
Command schema_command();

/// What the members of MeshOptions are called where not after themselves.
FlagNames surface_flag_names();
/// The same where they are the surface of --then-mesh, beside options of the skeleton.
FlagNames then_mesh_flag_names();
/// The same of LibraryFilter.
FlagNames library_flag_names();

}  // namespace coppice::cli
