#include "task_internal.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "batch_run.h"
#include "coppice/version.h"
#include "figures.h"
#include "outputs.h"
#include "parser.h"

using coppice::cli::Command;
using coppice::cli::ExitCode;
using coppice::cli::HeldObjects;

namespace {

/// Returns the commands that need no terminal, and their description.
std::vector<Command> library_commands() {
    std::vector<Command> commands = coppice::cli::batch_commands();
    commands.push_back(coppice::cli::schema_command(library_commands));
    return commands;
}

/// Returns the command of this name alone, which is faster to parse; all commands for an unknown name, so
/// that the parser reports it.
std::vector<Command> find_commands(std::string_view name) {
    std::vector<Command> all = library_commands();
    const auto found = std::ranges::find(all, name, &Command::name);
    if (found == all.end()) return all;
    return {std::move(*found)};
}

ExitCode run_words(coppice_task& task, std::span<const char* const> words) {
    if (words.empty() || std::ranges::find(words, nullptr) != words.end())
        throw coppice::cli::UsageError("no command given; the command schema lists all of them");
    std::vector<const char*> arguments{"coppice"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    coppice::cli::CommonFlags common;
    const std::vector<Command> commands =
        coppice::cli::with_common_options(find_commands(words.front()), common);
    const auto request = coppice::cli::Parser(commands).parse(arguments);
    if (request.command == nullptr) {
        task.print(request.text);
        return coppice::cli::kDone;
    }
    coppice::cli::check_outputs(request.given);
    coppice::cli::Run run(request.command->name, common, task);
    const ExitCode code = coppice::cli::run_request(run, request);
    task.report = coppice::cli::figures_json(run.report());
    return code;
}

}  // namespace

std::stop_token coppice_task::stop_token() const {
    const std::scoped_lock lock(mutex_);
    return source_.get_token();
}

void coppice_task::say(std::string_view text) {
    message += text;
    message += '\n';
}

void coppice_task::show_progress(const std::string& subject, const std::string& stage, float fraction) {
    const std::string name = subject.empty() ? stage : subject + ": " + stage;
    if (progress(progress_user, name.c_str(), double{fraction}) != 0) cancel();
}

void coppice_task::cancel() {
    const std::scoped_lock lock(mutex_);
    source_.request_stop();
}

const char* coppice_version() { return coppice::kVersion.data(); }

coppice_task* coppice_task_create() {
    try {
        return new coppice_task;
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

void coppice_task_free(coppice_task* task) { delete task; }

void coppice_task_set_progress(coppice_task* task, coppice_progress progress, void* user) {
    task->progress = progress;
    task->progress_user = user;
}

void coppice_task_cancel(coppice_task* task) { task->cancel(); }

coppice_status coppice_task_run(coppice_task* task, size_t count, const char* const* words) {
    return task->call([&] { return run_words(*task, {words, count}); });
}

const char* coppice_task_message(const coppice_task* task) { return task->message.c_str(); }
const char* coppice_task_output(const coppice_task* task) { return task->output.c_str(); }
const char* coppice_task_report(const coppice_task* task) { return task->report.c_str(); }

coppice_status coppice_task_put(coppice_task* task, const char* name, const coppice_object* object) {
    return task->call([&] {
        if (!HeldObjects::is_name(name))
            throw coppice::cli::UsageError("the name of an object in memory begins with \"memory:\"");
        task->held.put(name, object->held);
        return coppice::cli::kDone;
    });
}

coppice_object* coppice_task_take(coppice_task* task, const char* name) {
    try {
        const coppice::cli::HeldObject* const found = task->held.find(name);
        return found == nullptr ? nullptr : new coppice_object{*found};
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}
