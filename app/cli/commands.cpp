#include <utility>

#include "command.h"

namespace coppice::cli {

std::vector<Command> batch_commands() {
    std::vector<Command> commands;
    for (const auto make :
         {mesh_command,    extract_command, sketch_command,  library_command, compose_command,
          check_command,   compare_command, info_command,    table_command,   chart_command,
          convert_command, render_command,  view_command,    scan_command,    texture_command,
          leaves_command,  tree_command,    species_command, run_command,     grow_command,
          sprout_command,  edit_command,    animate_command}) {
        commands.push_back(make());
    }
    return commands;
}

std::vector<Command> with_common_options(std::vector<Command> commands, CommonFlags& common) {
    for (Command& command : commands) {
        if (command.many) add_batch_options(command.options, common.batch);
        add_common_options(command.options, common);
    }
    return commands;
}

}  // namespace coppice::cli
