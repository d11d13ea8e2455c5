#include "batch_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <fstream>
#include <mutex>
#include <new>
#include <thread>

#include "batch_plan.h"
#include "catch_errors.h"
#include "coppice/base/hash.h"
#include "coppice/io_database/batch_journal.h"
#include "coppice/version.h"
#include "csv_file.h"
#include "files.h"
#include "tree_row.h"

namespace coppice::cli {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

/// The surroundings of a command that processes one of many files: collects its messages.
class ItemHost : public Host {
  public:
    explicit ItemHost(Host& host) : host_(host) {}

    std::stop_token stop_token() const override { return host_.stop_token(); }
    void forget_stop() override {}
    void print(std::string_view) override {}
    void say(std::string_view message) override { said.emplace_back(message); }
    bool shows_progress() const override { return false; }
    void show_progress(const std::string&, const std::string&, float) override {}
    void clear_progress() override {}
    void finish(const std::string&, const std::string&) override {}
    void limit_memory(int, unsigned) override {}  // one limit for all files
    HeldObjects* held_objects() override { return host_.held_objects(); }

    std::vector<std::string> said;

  private:
    Host& host_;
};

/// Copies the value of an option to the same option of another object of the command.
void copy_value(const Option& from, const Option& to) {
    const auto copy = [&](auto target) {
        const auto source = std::get<decltype(target)>(from.target);
        if constexpr (std::is_same_v<decltype(target), ChoiceRef>)
            target.set(source.index());
        else
            *target = *source;
    };
    std::visit(copy, to.target);
}

void set_path(const Option& option, const fs::path& path) {
    if (auto* const* many = std::get_if<std::vector<fs::path>*>(&option.target))
        **many = {path};
    else
        *std::get<fs::path*>(option.target) = path;
}

void add_text(Hash& hash, std::string_view text) { hash.add(text.size()).add(std::span<const char>(text)); }

/// Adds the content of a regular file; returns whether it could be read.
bool add_content(Hash& hash, const fs::path& path) {
    std::error_code error;
    if (!fs::is_regular_file(path, error)) return false;
    std::ifstream file(path, std::ios::binary);
    std::vector<char> block(1 << 16);
    while (file) {
        file.read(block.data(), static_cast<std::streamsize>(block.size()));
        hash.add(std::span<const char>(block.data(), static_cast<std::size_t>(file.gcount())));
    }
    return file.eof();
}

void add_option(Hash& hash, const Option& option) {
    add_text(hash, option.name);
    const auto add_path = [&](const fs::path& path) {
        add_text(hash, path.string());
        add_content(hash, path);
    };
    const auto add = [&](auto target) {
        using Target = decltype(target);
        if constexpr (std::is_same_v<Target, ChoiceRef>) {
            add_text(hash, target.name());
        } else if constexpr (std::is_same_v<Target, fs::path*>) {
            add_path(*target);
        } else if constexpr (std::is_same_v<Target, std::vector<fs::path>*>) {
            for (const fs::path& path : *target) add_path(path);
        } else if constexpr (std::is_same_v<Target, std::vector<std::string>*>) {
            for (const std::string& text : *target) add_text(hash, text);
        } else if constexpr (std::is_same_v<Target, std::optional<Vec3d>*>) {
            if (*target) hash.add((*target)->x).add((*target)->y).add((*target)->z);
        } else {
            hash.add(*target);
        }
    };
    std::visit(add, option.target);
}

/// Adds single figures under their names, those of a nested object under both names.
void add_figures(Json& row, const Json& figures, const std::string& prefix = {}) {
    for (const auto& [name, figure] : figures.items()) {
        if (figure.is_object())
            add_figures(row, figure, name == "figures" ? prefix : prefix + name + "_");
        else if (!figure.is_array())
            row[prefix + name] = figure;
    }
}

std::string text_of_time(double seconds) {
    const auto whole = static_cast<std::uint64_t>(seconds);
    if (whole < 120) return fmt::format("{} s", whole);
    return whole < 7200 ? fmt::format("{} min", whole / 60) : fmt::format("{} h", whole / 3600);
}

/// State of a file in a batch.
enum class ItemState { open, made, kept, check_failed, failed };
constexpr std::array<std::string_view, 5> kStateNames{"open", "done", "done", "check failed", "failed"};

struct ItemResult {
    ItemState state = ItemState::open;
    Json row;
    bool out_of_memory = false;
};

/// One run of a command over many files.
class BatchRun {
  public:
    BatchRun(Run& run, const Parser::Request& request, FileBatch batch)
        : run_(run), request_(request), batch_(std::move(batch)), results_(batch_.items.size()) {
        add_text(options_, kVersion);
        add_text(options_, request.command->name);
        const Command plain = request.command->many->make();
        for (const Option& option : plain.options.all())
            if (!is_file_of_item(option)) add_option(options_, find_option(*request.command, option.name));
    }

    ExitCode list();
    ExitCode process();

  private:
    bool is_file_of_item(const Option& option) const {
        return option.name == request_.command->many->input || option.name == "--output";
    }
    std::optional<std::uint64_t> state_of(const BatchItem& item) const;
    bool is_finished(const BatchItem& item, std::uint64_t state, Json& row);
    void open_journal();
    void process_item(std::size_t index, unsigned threads);
    ItemResult run_command(const BatchItem& item, unsigned threads) const;
    void work(unsigned threads);
    void process_all(const Context& ctx);
    void process_alone();
    void show_progress(const Context& ctx, steady_clock::time_point start);
    std::size_t count(ItemState state) const {
        return static_cast<std::size_t>(std::ranges::count(results_, state, &ItemResult::state));
    }
    void write_table() const;
    ExitCode finish();

    Run& run_;
    const Parser::Request& request_;
    const FileBatch batch_;
    Hash options_;
    std::mutex mutex_;  ///< guards all members below
    std::optional<BatchJournal> journal_;
    std::vector<ItemResult> results_;
    std::size_t next_ = 0;
    unsigned working_ = 0;  ///< number of threads that have not ended
    std::exception_ptr failure_;
    std::condition_variable changed_;
};

/// Returns a hash of everything that the result depends on; nullopt for files that cannot be read twice.
std::optional<std::uint64_t> BatchRun::state_of(const BatchItem& item) const {
    Hash hash = options_;
    if (!add_content(hash, item.input)) return std::nullopt;
    return hash.value();
}

/// Returns whether the journal has the item with this state and the result exists; then sets its row.
bool BatchRun::is_finished(const BatchItem& item, std::uint64_t state, Json& row) {
    const auto entry = journal_ ? journal_->find(item.output.filename().string()) : std::nullopt;
    if (!entry || entry->state != state) return false;
    row = Json::parse(entry->row, nullptr, false);
    std::error_code error;
    return row.is_object() && row.value("bytes", std::uintmax_t{0}) == fs::file_size(item.output, error) &&
           !error;
}

void BatchRun::open_journal() { journal_.emplace(batch_.folder / kBatchJournal); }

/// Prints the files that would be processed.
ExitCode BatchRun::list() {
    std::error_code error;
    if (run_.flags().batch.resume && fs::exists(batch_.folder / kBatchJournal, error)) open_journal();
    std::size_t kept = 0;
    for (const BatchItem& item : batch_.items) {
        Json row;
        const auto state = state_of(item);
        if (state && is_finished(item, *state, row)) {
            ++kept;
            continue;
        }
        run_.print(fmt::format("{} -> {}\n", item.input.string(), item.output.string()));
    }
    run_.finish(fmt::format("{}: {} files to process, {} finished", batch_.folder.string(),
                            grouped(batch_.items.size() - kept), grouped(kept)));
    return kDone;
}

/// Runs the command for one file, with options of its own.
ItemResult BatchRun::run_command(const BatchItem& item, unsigned threads) const {
    const auto start = steady_clock::now();
    const Command command = request_.command->many->make();
    GivenOptions given;
    for (const Option& option : command.options.all()) {
        copy_value(find_option(*request_.command, option.name), option);
        if (is_file_of_item(option)) set_path(option, option.name == "--output" ? item.output : item.input);
        if (is_file_of_item(option) || is_given(request_.given, option.name)) given.push_back(&option);
    }
    ItemHost host(run_.host());
    Run run(command.name, {.threads = static_cast<int>(threads), .report = {}, .quiet = true, .batch = {}},
            host);
    ItemResult result;
    std::string error;
    const auto work = [&] {
        try {
            return command.run(run, given);
        } catch (const std::bad_alloc&) {
            result.out_of_memory = true;
            renew_memory_limit();
            throw;
        }
    };
    const ExitCode code = catch_errors(work, [&](const char* text) { error = text; });
    if (code == kInterrupted) throw Cancelled();
    result.state = code == kDone          ? ItemState::made
                   : code == kCheckFailed ? ItemState::check_failed
                                          : ItemState::failed;
    std::error_code missing;
    const std::uintmax_t bytes = fs::file_size(item.output, missing);
    Json& row = result.row;
    row["input"] = item.input.string();
    row["output"] = item.output.filename().string();
    row["status"] = kStateNames[static_cast<std::size_t>(result.state)];
    row["bytes"] = known(bytes, !missing && result.state != ItemState::failed);
    if (result.state != ItemState::failed) add_figures(row, run.counts());
    std::vector<std::string> warnings = host.said;
    for (const Json& warning : run.warnings()) warnings.push_back(warning.get<std::string>());
    row["warnings"] = fmt::format("{}", fmt::join(warnings, "; "));
    row["seconds"] = std::chrono::duration<double>(steady_clock::now() - start).count();
    if (!error.empty()) row["error"] = error;
    return result;
}

/// Processes a file unless its result is finished, and records the result.
void BatchRun::process_item(std::size_t index, unsigned threads) {
    const BatchItem& item = batch_.items[index];
    const std::string name = item.output.filename().string();
    const auto state = state_of(item);
    {
        const std::scoped_lock lock(mutex_);
        ItemResult& result = results_[index];
        if (run_.flags().batch.resume && state && is_finished(item, *state, result.row)) {
            result.state =
                result.row["status"] == kStateNames[static_cast<std::size_t>(ItemState::check_failed)]
                    ? ItemState::check_failed
                    : ItemState::kept;
            return;
        }
        if (journal_->find(name)) journal_->remove({&name, 1});
    }
    ItemResult result = run_command(item, threads);
    const std::scoped_lock lock(mutex_);
    if (state && result.state != ItemState::failed) journal_->record({name, *state, result.row.dump()});
    results_[index] = std::move(result);
}

/// Processes files until none is left.
void BatchRun::work(unsigned threads) {
    std::unique_lock lock(mutex_);
    try {
        while (next_ < batch_.items.size() && !failure_) {
            const std::size_t index = next_++;
            lock.unlock();
            process_item(index, threads);
            lock.lock();
        }
    } catch (...) {
        if (!lock.owns_lock()) lock.lock();
        if (!failure_) failure_ = std::current_exception();
    }
    --working_;
    changed_.notify_all();
}

void BatchRun::show_progress(const Context& ctx, steady_clock::time_point start) {
    const std::size_t all = batch_.items.size(), done = all - count(ItemState::open);
    const double seconds = std::chrono::duration<double>(steady_clock::now() - start).count();
    const double rate = static_cast<double>(done) / std::max(seconds, 1e-3);
    run_.set_subject(
        fmt::format("{} of {}, {} failed, {:.1f} per second{}", grouped(done), grouped(all),
                    grouped(count(ItemState::failed)), rate,
                    done == 0 ? "" : ", " + text_of_time(static_cast<double>(all - done) / rate) + " left"));
    ctx.report(static_cast<float>(done) / static_cast<float>(all));
}

/// Processes all files: as many at the same time as there are threads; a few files use several threads each.
void BatchRun::process_all(const Context& ctx) {
    const auto start = steady_clock::now();
    working_ = std::min<unsigned>(run_.threads(), static_cast<unsigned>(batch_.items.size()));
    const unsigned each = run_.threads() / working_;
    std::vector<std::jthread> workers;
    std::unique_lock lock(mutex_);
    for (unsigned w = working_; w > 0; --w) workers.emplace_back([this, each] { work(each); });
    while (working_ > 0) {
        changed_.wait_for(lock, std::chrono::milliseconds(200));
        show_progress(ctx, start);
    }
    lock.unlock();
    workers.clear();
    run_.set_subject({});
    if (failure_) std::rethrow_exception(failure_);
    process_alone();
}

/// Processes files again for which the memory was insufficient together with others, one at a time.
void BatchRun::process_alone() {
    if (run_.threads() == 1) return;
    for (std::size_t i = 0; i < results_.size(); ++i)
        if (results_[i].out_of_memory) process_item(i, run_.threads());
}

void BatchRun::write_table() const {
    std::vector<Json> rows;
    for (const ItemResult& result : results_)
        if (result.state != ItemState::open) rows.push_back(result.row);
    write_file(batch_.folder / kTreeTable, to_csv(rows));
}

ExitCode BatchRun::finish() {
    const std::size_t failed = count(ItemState::failed), faulty = count(ItemState::check_failed);
    const std::size_t made = count(ItemState::made), kept = count(ItemState::kept);
    constexpr std::size_t kMaxListed = 5;
    std::size_t listed = 0;
    for (const ItemResult& result : results_)
        if (result.state == ItemState::failed && listed++ < kMaxListed)
            run_.warn(result.row["error"].get<std::string>());
    if (failed > kMaxListed) run_.warn(fmt::format("{} more files failed", grouped(failed - kMaxListed)));
    run_.counts().update({{"files", results_.size()},
                          {"made", made},
                          {"kept", kept},
                          {"check_failed", faulty},
                          {"failed", failed},
                          {"passed_over", batch_.passed_over}});
    run_.finish(fmt::format("{}: {} files, {} made, {} kept, {}{} failed; see {}", batch_.folder.string(),
                            grouped(results_.size()), grouped(made), grouped(kept),
                            faulty == 0 ? "" : grouped(faulty) + " did not pass the check, ", grouped(failed),
                            (batch_.folder / kTreeTable).string()));
    return failed > 0 ? kFileTrouble : faulty > 0 ? kCheckFailed : kDone;
}

ExitCode BatchRun::process() {
    create_folder(batch_.folder);
    open_journal();
    if (!run_.flags().batch.resume) {
        std::vector<std::string> names;
        for (const BatchItem& item : batch_.items) names.push_back(item.output.filename().string());
        journal_->remove(names);
    }
    try {
        run_.stage("files", [&](const Context& ctx) { process_all(ctx); });
    } catch (const Cancelled&) {
        write_table();
        throw;
    }
    write_table();
    return finish();
}

}  // namespace

ExitCode run_request(Run& run, const Parser::Request& request) {
    std::optional<FileBatch> batch = plan_file_batch(run, request);
    if (!batch) return request.command->run(run, request.given);
    BatchRun all(run, request, std::move(*batch));
    return run.flags().batch.dry_run ? all.list() : all.process();
}

}  // namespace coppice::cli
