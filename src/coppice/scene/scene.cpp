#include "coppice/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "coppice/scene/place_internal.h"

namespace coppice {

using scene_internal::placed;

namespace {

constexpr std::size_t kMaxObjects = 10'000;
constexpr std::size_t kMaxSteps = 1000;
constexpr std::uint64_t kMebibyte = 1 << 20;
constexpr std::size_t kLongestAnswer = 16 * kMebibyte;  // [bytes] maximum output of a block

std::string add_command_name(const std::string& place, const SceneCommand& command) {
    return place.empty() ? command.name : fmt::format("{}: {}", place, command.name);
}

}  // namespace

Scene::Scene(SceneSettings settings)
    : settings_(std::move(settings)), script_(settings_.variables, settings_.max_lines) {
    state_.seed = settings_.seed;
    script_.set_seed(state_.seed);
}

std::string Scene::run(std::string_view line, const std::string& place, const Context& ctx) {
    std::string output;
    const auto run_one = [&](std::string_view command, const std::string& at) {
        output += run_command(command, at, ctx);
        if (output.size() > kLongestAnswer) {
            placed(at, [] {
                throw InvalidInput(
                    "the output of the block exceeds 16 MiB; let fewer of its turns list or describe");
            });
        }
    };
    script_.take(line, place, run_one, ctx);
    return output;
}

std::string Scene::run_command(std::string_view line, const std::string& place, const Context& ctx) {
    const auto words = placed(place, [&] { return scene_words(line); });
    if (words.empty()) return {};
    const SceneCall call = placed(place, [&] { return bind_command(words, state_, settings_, ctx); });
    return placed(add_command_name(place, call.command()), [&] {
        SceneOutcome outcome = call.command().run(call);
        ctx.throw_if_cancelled();
        if (outcome.undo > 0) {
            take_back(outcome.undo);
        } else {
            apply(call, outcome);
        }
        return outcome.text;
    });
}

std::string Scene::run_text(std::string_view text, const std::string& source, const Context& ctx) {
    std::string out;
    const std::vector<SceneLine> lines = scene_lines(text, source);
    for (const auto step : scene_steps(lines, source)) {
        ctx.throw_if_cancelled();
        for (const SceneLine& line : step)
            out += run(line.text, fmt::format("{}:{}", source, line.number), ctx);
    }
    return out;
}

void Scene::apply(const SceneCall& call, const SceneOutcome& outcome) {
    if (outcome.changes.empty() && !outcome.seed) return;
    if (state_.objects.size() + outcome.changes.size() > kMaxObjects)
        throw InvalidInput(fmt::format("a scene has at most {} objects; delete some", kMaxObjects));
    double more = 0;
    for (const auto& change : outcome.changes)
        more += change.object ? static_cast<double>(change.object->bytes) : 0;
    std::string typed = call.command().records ? call.typed() : std::string();
    call.reserve(more + static_cast<double>(history_bytes_ + typed.size()));
    Step step{.before = {}, .history = state_.history.size(), .made = state_.made.size()};
    step.last_grown = state_.last_grown;
    step.seed = state_.seed;
    for (const auto& change : outcome.changes) {
        const auto found = state_.objects.find({change.kind, change.name});
        const ObjectPtr before = found == state_.objects.end() ? nullptr : found->second;
        step.before.push_back({change.kind, change.name, before});
        if (before) step.bytes += before->bytes;
        put(change.kind, change.name, change.object);
        if (change.object) state_.made.emplace_back(change.kind, change.name);
    }
    history_bytes_ += typed.size();
    if (!typed.empty()) state_.history.push_back(std::move(typed));
    if (!outcome.grown.empty()) state_.last_grown = outcome.grown;
    if (outcome.seed) {
        state_.seed = *outcome.seed;
        script_.set_seed(state_.seed);
    }
    undo_bytes_ += step.bytes;
    undo_.push_back(std::make_shared<const Step>(std::move(step)));
    forget_old_steps();
}

void Scene::put(ObjectKind kind, const std::string& name, const ObjectPtr& object) {
    const auto key = std::pair(kind, name);
    if (const auto found = state_.objects.find(key); found != state_.objects.end()) {
        state_.bytes -= found->second->bytes;
        state_.objects.erase(found);
    }
    if (!object) return;
    state_.bytes += object->bytes;
    state_.objects[key] = object;
}

void Scene::hold_tree(const std::string& name, Skeleton tree) {
    const std::uint64_t bytes = compute_memory(tree);
    put(ObjectKind::skeleton, name, std::make_shared<const SceneObject>(SceneObject{std::move(tree), bytes}));
}

void Scene::take_back(int count) {
    if (undo_.size() < static_cast<std::size_t>(count)) {
        throw InvalidInput(undo_.empty() ? "there is no command to undo"
                                         : fmt::format("only {} commands can be undone", undo_.size()));
    }
    for (; count > 0; --count) {
        const StepPtr last = std::move(undo_.back());
        const Step& step = *last;
        undo_.pop_back();
        undo_bytes_ -= step.bytes;
        for (auto change = step.before.rbegin(); change != step.before.rend(); ++change)
            put(change->kind, change->name, change->object);
        for (std::size_t i = step.history; i < state_.history.size(); ++i)
            history_bytes_ -= state_.history[i].size();
        state_.history.resize(step.history);
        state_.made.resize(step.made);
        state_.last_grown = step.last_grown;
        if (state_.seed != step.seed) script_.set_seed(step.seed);
        state_.seed = step.seed;
    }
}

void Scene::forget_old_steps() {
    const std::uint64_t most = static_cast<std::uint64_t>(settings_.max_memory) * kMebibyte / 4;
    while (undo_.size() > kMaxSteps || (undo_bytes_ > most && !undo_.empty())) {
        undo_bytes_ -= undo_.front()->bytes;
        undo_.pop_front();
    }
}

std::uint64_t SceneMemory::count_bytes(const Scene::Step& step) {
    std::uint64_t bytes = sizeof(step);
    for (const SceneOutcome::Change& change : step.before) {
        bytes += sizeof(change) + change.name.size();
        if (change.object && is_new(change.object.get())) bytes += change.object->bytes;
    }
    return bytes;
}

std::uint64_t SceneMemory::add(const Scene& scene) {
    constexpr std::uint64_t kBytesOfName = 150, kBytesOfEntry = 48;
    std::uint64_t bytes = sizeof(scene) + scene.history_bytes_;
    for (const auto& [name, object] : scene.state_.objects)
        bytes += kBytesOfName + (is_new(object.get()) ? object->bytes : 0);
    bytes += kBytesOfEntry * (scene.state_.history.size() + scene.state_.made.size());
    // Compared to a copy, a scene may have additional steps at the end and at the beginning; the steps
    // between them are shared.
    const auto& steps = scene.undo_;
    bytes += sizeof(Scene::StepPtr) * steps.size();
    for (auto step = steps.rbegin(); step != steps.rend() && is_new(step->get()); ++step)
        bytes += count_bytes(**step);
    for (auto step = steps.begin(); step != steps.end() && is_new(step->get()); ++step)
        bytes += count_bytes(**step);
    return bytes;
}

}  // namespace coppice
