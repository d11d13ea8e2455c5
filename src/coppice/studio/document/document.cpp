#include "coppice/studio/document/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "coppice/base/error.h"
#include "coppice/scene/script/statements.h"
#include "coppice/studio/document/prefix_internal.h"

namespace coppice {

using studio_internal::changed_objects;
using studio_internal::mentions;
using studio_internal::Prefix;
using studio_internal::Record;
using studio_internal::StatementText;

namespace {

constexpr std::size_t kMaxStates = 256;
constexpr std::size_t kStatesLeft = 192;      // number of kept states before and after old ones are removed
constexpr std::size_t kLastStates = 8;        // kept regardless of their run time
constexpr std::size_t kStatementsApart = 64;  // maximum number of statements between kept states
constexpr double kLong = 0.005;               // [s] run time after which a state is kept
constexpr std::size_t kLongestName = 80;
constexpr std::size_t kMaxMessage = std::size_t{64}
                                    << 10;  // [bytes] maximum length of the stored output of a statement
// one document, and undo, may each use 1/kTextShare of the memory of texts
constexpr std::uint64_t kTextShare = 4;
constexpr double kMebibyte = 1 << 20;

bool is_letter_of_name(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
}

/// Notifies a watch that no statement runs any more.
class EndOfRun {
  public:
    explicit EndOfRun(const Document::Watch& watch) : watch_(watch) {}
    ~EndOfRun() {
        if (watch_) watch_(std::nullopt);
    }
    EndOfRun(const EndOfRun&) = delete;
    EndOfRun& operator=(const EndOfRun&) = delete;

  private:
    const Document::Watch& watch_;
};

std::string name_of_change(std::string_view line) {
    const std::string_view first = line.substr(0, line.find('\n'));
    return first.size() <= kLongestName ? std::string(first)
                                        : std::string(first.substr(0, kLongestName)) + "...";
}

}  // namespace

bool studio_internal::mentions(std::string_view text, std::string_view name) {
    for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        if ((at == 0 || !is_letter_of_name(text[at - 1])) &&
            (end == text.size() || !is_letter_of_name(text[end])))
            return true;
    }
    return false;
}

std::vector<Document::Name> studio_internal::changed_objects(const SceneObjects& before,
                                                             const SceneObjects& after) {
    std::vector<Document::Name> out;
    auto a = before.begin();
    for (const auto& [name, object] : after) {
        for (; a != before.end() && a->first < name; ++a) out.push_back(a->first);
        const bool there = a != before.end() && a->first == name;
        if (!there || a->second != object) out.push_back(name);
        if (there) ++a;
    }
    for (; a != before.end(); ++a) out.push_back(a->first);
    return out;
}

std::uint64_t Document::Version::bytes() const {
    std::uint64_t out = sizeof(*this) + name.size();
    for (const StatementText& statement : statements) out += sizeof(statement) + statement.text->size();
    return out;
}

std::vector<StatementText> Document::Version::applied_to(const std::vector<StatementText>& from) const {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
    std::vector<StatementText> out(from.begin(), begin);
    out.insert(out.end(), statements.begin(), statements.end());
    out.insert(out.end(), begin + static_cast<std::ptrdiff_t>(count), from.end());
    return out;
}

/// Returns the version that restores `from`.
Document::Version Document::Version::back(const std::vector<StatementText>& from) const {
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
    return {.first = first,
            .count = statements.size(),
            .statements = {begin, begin + static_cast<std::ptrdiff_t>(count)},
            .file = nullptr,
            .name = name,
            .by = by};
}

Document::Version Document::difference(const std::vector<StatementText>& from,
                                       const std::vector<StatementText>& to) {
    const auto [a, b] = std::ranges::mismatch(from, to);
    const std::size_t first = static_cast<std::size_t>(a - from.begin());
    std::size_t last = 0;  // number of equal statements at the end
    while (last < std::min(from.size(), to.size()) - first &&
           from[from.size() - 1 - last] == to[to.size() - 1 - last])
        ++last;
    return {.first = first,
            .count = from.size() - last - first,
            .statements = {b, to.end() - static_cast<std::ptrdiff_t>(last)},
            .file = nullptr,
            .name = {},
            .by = {}};
}

Document::Document(SceneSettings settings, DocumentLimits limits)
    : settings_(std::move(settings)),
      limits_(limits),
      root_(std::make_shared<Prefix>()),
      last_(root_),
      scene_(std::make_shared<const Scene>(settings_)) {}

Document::~Document() = default;
Document::Document(Document&&) noexcept = default;
Document& Document::operator=(Document&&) noexcept = default;

std::vector<StatementText> Document::texts() const {
    std::vector<StatementText> out;
    for (const PrefixPtr& p : last_->path()) out.push_back(p->statement);
    return out;
}

Document::PrefixPtr Document::find_prefix(const std::vector<StatementText>& statements) const {
    PrefixPtr last = root_;
    for (const StatementText& statement : statements)
        last = last->with({statement.text, find_edition(*statement.text)});
    return last;
}

Document::PrefixPtr Document::find_prefix(std::string_view text) const {
    const std::vector<SceneSection> statements = find_sections(text);
    if (statements.size() > kMaxLines)
        throw InvalidInput(fmt::format("the text has more than {} lines", kMaxLines));
    const std::vector<PrefixPtr> old = last_->path();
    PrefixPtr last = root_;
    for (std::size_t i = 0; i < statements.size(); ++i) {
        const bool same = i < old.size() && last == old[i]->before && old[i]->text() == statements[i].text;
        last = same ? old[i] : last->with(find_statement(statements[i].text));
    }
    check_room(*last);
    return last;
}

void Document::check_room(const Prefix& last) const {
    const std::uint64_t room = limits_.texts / kTextShare;
    if (last.list_bytes <= room) return;
    throw InvalidInput(fmt::format("the text exceeds the limit of {:.1f} MiB; allow more memory",
                                   static_cast<double>(room) / kMebibyte));
}

std::size_t Document::run(const std::string& line, const std::optional<Name>& about, const Context& ctx) {
    const std::vector<SceneSection> statements = find_sections(line);
    if (statements.empty()) throw InvalidInput("the line is empty");
    const std::size_t at = place_for(about);
    const std::vector<PrefixPtr> old = last_->path();
    PrefixPtr last = at == 0 ? root_ : old[at - 1];
    for (const SceneSection& statement : statements) last = last->with(find_statement(statement.text));
    check_room(*last);
    if (Reached own = reach(last->path(), at + statements.size(), ctx); own.error)
        std::rethrow_exception(own.error);
    for (std::size_t i = at; i < old.size(); ++i) last = last->with(old[i]->statement);
    check_room(*last);
    Reached reached = reach(last->path(), goal() + statements.size(), ctx);
    change(last, std::move(reached), {.name = statements.front().text});
    return at + statements.size() - 1;
}

void Document::set_text(std::string_view text, const TextChange& how, const Context& ctx) {
    PrefixPtr last = find_prefix(text);
    const bool stays = last == last_;
    Reached reached = reach(last->path(), std::min(how.count.value_or(last->depth), last->depth), ctx);
    if (stays) {
        show(std::move(last), std::move(reached));
    } else {
        change(std::move(last), std::move(reached), how);
    }
}

void Document::open(std::string_view text, const std::string& file, const Context& ctx) {
    PrefixPtr last = find_prefix(text);
    Reached reached = reach(last->path(), last->depth, ctx);
    change(std::move(last), std::move(reached), {.name = file.empty() ? "a new scene" : "opening " + file});
    file_ = std::make_shared<std::string>(file);
}

void Document::begin_with(std::string_view text, const std::string& file) {
    show(find_prefix(text),
         {.ran = 0, .scene = std::make_shared<const Scene>(settings_), .failure = {}, .error = {}});
    file_ = std::make_shared<std::string>(file);
    done_.clear();
    undone_.clear();
}

void Document::run_to(std::size_t count, const Context& ctx) {
    show(last_, reach(last_->path(), std::min(count, size()), ctx));
}

void Document::undo(std::size_t count, const Context& ctx) { step(done_, undone_, count, "undone", ctx); }
void Document::redo(std::size_t count, const Context& ctx) { step(undone_, done_, count, "redone", ctx); }

void Document::step(std::deque<Version>& from, std::deque<Version>& to, std::size_t count,
                    const char* subject, const Context& ctx) {
    if (count > from.size()) {
        throw InvalidInput(from.empty() ? fmt::format("there is nothing to be {}", subject)
                                        : fmt::format("only {} changes can be {}", from.size(), subject));
    }
    std::vector<StatementText> list = texts();
    std::vector<Version> back;
    for (std::size_t i = 0; i < count; ++i) {
        const Version& version = from[from.size() - 1 - i];
        back.push_back(version.back(list));
        list = version.applied_to(list);
    }
    PrefixPtr goal = find_prefix(list);
    Reached reached = reach(goal->path(), goal->depth, ctx);
    for (Version& version : back) {
        version.file = std::exchange(file_, std::move(from.back().file));
        from.pop_back();
        to.push_back(std::move(version));
    }
    joinable_ = false;
    show(std::move(goal), std::move(reached));
}

bool Document::rerun(const std::string& file, const Context& ctx) {
    constexpr std::size_t kMaxFiles = 1000;
    if (file.empty()) return false;
    if (files_.size() >= kMaxFiles) {
        files_.clear();  // every statement that reads a file is run again
        oldest_edition_ = ++edition_;
    }
    files_[file] = ++edition_;
    PrefixPtr last = find_prefix(texts());
    if (last == last_) return false;
    Reached reached = reach(last->path(), goal(), ctx);
    show(std::move(last), std::move(reached));
    return true;
}

std::uint32_t Document::find_edition(const std::string& text) const {
    std::uint32_t out = oldest_edition_;
    for (const auto& [file, edition] : files_) {
        if (edition > out && mentions(text, file)) out = edition;
    }
    return out;
}

StatementText Document::find_statement(const std::string& text) const {
    return {std::make_shared<const std::string>(text), find_edition(text)};
}

/// Returns the number of statements that need not run, because the state after them is stored.
std::size_t Document::known(const std::vector<PrefixPtr>& path, std::size_t count) const {
    std::size_t recorded = 0, out = 0;
    while (recorded < count && path[recorded]->record) {
        ++recorded;
        if (path[recorded - 1]->state) out = recorded;
    }
    return out;
}

void Document::run_one(Prefix& prefix, Scene& scene, const Context& ctx) const {
    const SceneObjects before = scene.state().objects;
    const auto start = std::chrono::steady_clock::now();
    const std::uint32_t line = prefix.before->lines + 1;
    std::string message = run_section(scene, prefix.text(), line, file_->empty() ? "scene" : *file_, ctx);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (message.size() > kMaxMessage) message = message.substr(0, kMaxMessage) + "\n...\n";
    if (root_->tree_bytes() + message.size() > limits_.texts / 2) message.clear();
    prefix.note({std::move(message), changed_objects(before, scene.state().objects), took.count()});
}

Document::Reached Document::reach(const std::vector<PrefixPtr>& path, std::size_t count,
                                  const Context& ctx) const {
    std::size_t k = known(path, count);
    std::shared_ptr<const Scene> state =
        k == 0 ? std::make_shared<const Scene>(settings_) : path[k - 1]->state;
    if (k > 0) path[k - 1]->used = ++clock_;
    if (k == count) return {.ran = k, .scene = std::move(state), .failure = {}, .error = {}};
    Scene scene = *state;
    const EndOfRun end(watch_);
    double unkept = 0;
    std::size_t apart = 0;
    Reached out;
    for (; k < count; ++k) {
        if (watch_) watch_(Running{k, path[k]->text()});
        // A failed command leaves the scene unchanged, a failed block does not.
        const bool block = path[k]->text().find('\n') != std::string::npos;
        std::optional<Scene> before;
        if (block) before = scene;
        try {
            run_one(*path[k], scene, ctx);
        } catch (const Cancelled&) {
            throw;
        } catch (const Error& error) {
            out.failure = Failure{k, path[k]->before->lines + 1, error.what()};
            out.error = std::current_exception();
            if (before) scene = std::move(*before);
            break;
        }
        unkept += path[k]->record->seconds;
        if (unkept < kLong && ++apart < kStatementsApart && count - k > kLastStates) continue;
        keep(path[k], std::make_shared<const Scene>(scene));
        unkept = 0;
        apart = 0;
    }
    out.ran = k;
    out.scene = std::make_shared<const Scene>(std::move(scene));
    forget_old_states(*out.scene);
    return out;
}

void Document::keep(const PrefixPtr& prefix, std::shared_ptr<const Scene> state) const {
    if (!prefix->state) kept_.push_back(prefix);
    uncounted_ += SceneMemory().add(*state);
    prefix->state = std::move(state);
    prefix->used = ++clock_;
}

void Document::forget_old_states(const Scene& now) const {
    const auto forget = [&] {
        kept_.front()->state = nullptr;
        kept_.pop_front();
    };
    const bool many = kept_.size() > kMaxStates;
    if (many || counted_ + uncounted_ > limits_.states) {
        std::ranges::sort(kept_, {}, [](const PrefixPtr& p) { return p->used; });
        // Keeps states from the newest to the oldest, until their memory in addition to the current scene
        // reaches the limit.
        SceneMemory memory;
        memory.add(now);
        counted_ = uncounted_ = 0;
        std::size_t keep = 0;
        for (; keep < std::min(kept_.size(), many ? kStatesLeft : kMaxStates); ++keep) {
            const std::uint64_t bytes = memory.add(*kept_[kept_.size() - 1 - keep]->state);
            if (counted_ + bytes > limits_.states) break;
            counted_ += bytes;
        }
        while (kept_.size() > keep) forget();
    }
    // States keep their statement lists alive.
    while (root_->tree_bytes() > limits_.texts / 2 && !kept_.empty()) forget();
}

void Document::forget_old_versions() {
    std::uint64_t bytes = 0;
    for (const auto* versions : {&done_, &undone_}) {
        for (const Version& version : *versions) bytes += version.bytes();
    }
    while (bytes > limits_.texts / kTextShare && done_.size() + undone_.size() > 0) {
        std::deque<Version>& versions = done_.empty() ? undone_ : done_;
        bytes -= versions.front().bytes();
        versions.pop_front();
    }
}

void Document::show(PrefixPtr last, Reached reached) {
    last_ = std::move(last);
    ran_ = reached.ran;
    scene_ = std::move(reached.scene);
    failure_ = std::move(reached.failure);
    ++revision_;
}

void Document::change(PrefixPtr last, Reached reached, TextChange how) {
    std::string name = name_of_change(how.name);
    const std::vector<StatementText> before = texts();
    show(std::move(last), std::move(reached));
    const std::vector<StatementText> now = texts();
    const bool joins =
        how.joins && joinable_ && !done_.empty() && done_.back().name == name && done_.back().by == how.by;
    Version version = difference(now, joins ? done_.back().applied_to(before) : before);
    version.file = file_;
    version.name = std::move(name);
    version.by = std::move(how.by);
    if (joins) done_.pop_back();
    done_.push_back(std::move(version));
    undone_.clear();
    joinable_ = true;
    forget_old_versions();
}

std::vector<Document::Statement> Document::statements() const {
    std::vector<Statement> out;
    for (const PrefixPtr& p : last_->path()) {
        const bool has_run = out.size() < ran_ && p->record;
        out.push_back({p->text(), p->before->lines + 1, has_run ? p->record->message : std::string()});
    }
    return out;
}

std::string Document::text() const {
    std::string out;
    for (const PrefixPtr& p : last_->path()) out += p->text() + "\n";
    return out;
}

std::size_t Document::size() const { return last_->depth; }

std::vector<std::string> Document::undo_names(std::size_t most) const {
    std::vector<std::string> out;
    for (std::size_t i = done_.size() - std::min(most, done_.size()); i < done_.size(); ++i)
        out.push_back(done_[i].name);
    return out;
}

std::vector<std::string> Document::redo_names(std::size_t most) const {
    std::vector<std::string> out;
    for (std::size_t i = undone_.size() - std::min(most, undone_.size()); i < undone_.size(); ++i)
        out.push_back(undone_[i].name);
    return out;
}

std::map<Document::Name, std::size_t> Document::makers() const {
    std::map<Name, std::size_t> out;
    const std::vector<PrefixPtr> path = last_->path();
    for (std::size_t i = 0; i < ran_; ++i) {
        for (const Name& name : path[i]->record->changed) out[name] = i;
    }
    return out;
}

std::size_t Document::place_for(const std::optional<Name>& about) const {
    if (!about) return ran_;
    const auto all = makers();
    const auto made = all.find(*about);
    if (made == all.end()) return ran_;
    const std::vector<PrefixPtr> path = last_->path();
    for (std::size_t i = made->second + 1; i < path.size(); ++i) {
        if (mentions(path[i]->text(), about->second)) return made->second + 1;
    }
    return ran_;
}

std::shared_ptr<const Scene> Document::scene_behind(std::size_t count, const Context& ctx) const {
    if (count == ran_) return scene_;
    Reached reached = reach(last_->path(), std::min(count, ran_), ctx);
    if (reached.error) std::rethrow_exception(reached.error);
    return reached.scene;
}

}  // namespace coppice
