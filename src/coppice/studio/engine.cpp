#include "coppice/studio/engine.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>
#include <utility>

#include "coppice/base/error.h"
#include "coppice/studio/memory_budget_internal.h"
#include "coppice/studio/session.h"

namespace coppice {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxAnswers = 256;   // stored answers of a client
constexpr std::size_t kMaxWaiting = 4096;  // queued messages of a client
constexpr std::size_t kMaxNames = 64;      // known clients, including disconnected ones
constexpr std::chrono::milliseconds kProgressApart{50};
constexpr std::chrono::milliseconds kMaxOverrun{
    60};  // run time after which a preview is cancelled for a newer one
constexpr std::chrono::milliseconds kRunsLong{
    100};  // run time after which all clients are notified of a statement
constexpr int kVersion = 1;

struct Message {
    std::string client;
    Json request;
    std::uint64_t id = 0;
    std::size_t bytes = 0;
};

/// A client that is or was connected.
struct Client {
    std::shared_ptr<StudioClient> connection;  ///< null: disconnected
    std::uint64_t taken = 0;                   ///< last id received
    std::uint64_t answered = 0;                ///< last id answered
    std::deque<std::pair<std::uint64_t, std::string>> answers;
    std::size_t answer_bytes = 0;
    std::size_t waiting = 0;  ///< number of its messages in the queue
    std::uint64_t seen = 0;   ///< time of its last join
};

/// The running statement, as sent to the clients.
struct Running {
    std::size_t statement = 0;
    std::string text;  ///< its first line
};

std::string refusal(std::uint64_t id, const char* kind, const char* error) {
    return Json{{"re", id}, {"ok", false}, {"error", error}, {"kind", kind}}.dump();
}

/// Returns whether the nesting of brackets does not exceed the maximum of messages: JSON is parsed
/// recursively.
bool is_shallow(std::string_view text) {
    constexpr int kDeepest = 64;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\\' && quoted) {
            ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (!quoted && (c == '[' || c == '{')) {
            if (++depth > kDeepest) return false;
        } else if (!quoted && (c == ']' || c == '}')) {
            --depth;
        }
    }
    return true;
}

std::string get_type(const Json& request) {
    const auto found = request.find("type");
    return found != request.end() && found->is_string() ? found->get<std::string>() : std::string();
}

}  // namespace

class StudioEngine::State {
  public:
    explicit State(const StudioOptions& options)
        : shares_(options.scene.max_memory),
          blobs_(shares_.blobs / 2),
          session_(options, blobs_, [this](const std::string& client, StudioBytes frame) {
              const std::scoped_lock lock(mutex_);
              const auto found = clients_.find(client);
              if (found != clients_.end() && found->second.connection)
                  found->second.connection->send_binary(std::move(frame));
          }) {
        session_.watch({.runs = [this](const auto& running) { runs(running); },
                        .grown = [this](const StudioGrown& g) { grown(g); }});
        publish();
        herald_ = std::jthread([this](const std::stop_token& end) { tell_of_what_runs(end); });
        thread_ = std::jthread([this](const std::stop_token& end) { work(end); });
    }

    ~State() {
        thread_.request_stop();
        herald_.request_stop();
        cancel();
        wake_.notify_all();
    }

    void join(const std::string& name, std::shared_ptr<StudioClient> connection) {
        const std::scoped_lock lock(mutex_);
        Client& client = clients_[name];
        client.connection = std::move(connection);
        client.seen = ++joined_;
        Json welcome{
            {"type", "welcome"}, {"version", kVersion}, {"folder", folder_}, {"answered", client.answered}};
        welcome["state"] = *latest_;
        if (reported_) say_what_runs(welcome["state"]);
        client.connection->send_text(welcome.dump());
        forget_names();
    }

    void leave(const std::string& name, const StudioClient* connection) {
        const std::scoped_lock lock(mutex_);
        const auto found = clients_.find(name);
        if (found != clients_.end() && found->second.connection.get() == connection)
            found->second.connection = nullptr;
    }

    void post(const std::string& name, const std::string& text) {
        Json request = is_shallow(text) ? Json::parse(text, nullptr, false) : Json();
        const std::scoped_lock lock(mutex_);
        const auto found = clients_.find(name);
        if (found == clients_.end() || !found->second.connection) return;
        Client& client = found->second;
        const std::uint64_t id = get_id(request);
        if (id == 0) {
            client.connection->send_text(refusal(
                0, "input",
                "a message must be a JSON object with an id of at least 1 and a nesting of at most 64"));
            return;
        }
        if (id <= client.taken) return repeat(name, client, id);
        client.taken = id;
        if (get_type(request) == "cancel") {
            running_.request_stop();
            answer(client, id, Json{{"re", id}, {"ok", true}}.dump());
            return;
        }
        if (client.waiting >= kMaxWaiting || waiting_bytes_ + text.size() > shares_.messages / 2) {
            answer(client, id, refusal(id, "busy", "too many requests are waiting; wait for their answers"));
            return;
        }
        if (get_type(request) == "preview") drop_previews(name, client);
        leave_preview(name, get_type(request) == "preview");
        ++client.waiting;
        waiting_bytes_ += text.size();
        queue_.push_back({name, std::move(request), id, text.size()});
        wake_.notify_all();
    }

    StudioBytes blob(std::string_view key) { return blobs_.get(key); }

  private:
    static std::uint64_t get_id(const Json& request) {
        if (!request.is_object()) return 0;
        const auto found = request.find("id");
        return found != request.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
    }

    void repeat(const std::string& name, Client& client, std::uint64_t id) {
        for (const auto& [known, text] : client.answers) {
            if (known == id) return client.connection->send_text(text);
        }
        const bool waits =
            std::ranges::any_of(queue_, [&](const Message& m) { return m.client == name && m.id == id; });
        if (waits || (doing_ == std::pair(name, id))) return;
        client.connection->send_text(
            refusal(id, "busy",
                    "this request was already done, and its answer is no longer stored; request it again"));
    }

    void answer(Client& client, std::uint64_t id, std::string text) {
        client.answered = std::max(client.answered, id);
        if (client.connection) client.connection->send_text(text);
        client.answer_bytes += text.size();
        client.answers.emplace_back(id, std::move(text));
        // The newest answer is always stored, regardless of its length.
        while (client.answers.size() > kMaxAnswers ||
               (client.answers.size() > 1 && client.answer_bytes > shares_.messages / 2 / kMaxNames)) {
            client.answer_bytes -= client.answers.front().second.size();
            client.answers.pop_front();
        }
    }

    /// Removes the waiting previews of a client: only its newest one counts.
    void drop_previews(const std::string& name, Client& client) {
        std::erase_if(queue_, [&](const Message& m) {
            if (m.client != name || get_type(m.request) != "preview") return false;
            answer(client, m.id, Json{{"re", m.id}, {"ok", true}, {"dropped", true}}.dump());
            --client.waiting;
            waiting_bytes_ -= m.bytes;
            return true;
        });
    }

    /// Cancels a slow preview when its client sends another request.
    void leave_preview(const std::string& name, bool for_another) {
        if (previewing_ != name) return;
        if (!for_another || Clock::now() - began_ > kMaxOverrun) running_.request_stop();
    }

    void forget_names() {
        while (clients_.size() > kMaxNames) {
            auto oldest = clients_.end();
            for (auto at = clients_.begin(); at != clients_.end(); ++at) {
                if (at->second.connection || at->second.waiting > 0) continue;
                if (oldest == clients_.end() || at->second.seen < oldest->second.seen) oldest = at;
            }
            if (oldest == clients_.end()) return;
            clients_.erase(oldest);
        }
    }

    void cancel() {
        const std::scoped_lock lock(mutex_);
        running_.request_stop();
    }

    void work(const std::stop_token& end) {
        run_what_was_opened();
        while (true) {
            Message message;
            Context ctx;
            {
                std::unique_lock lock(mutex_);
                wake_.wait(lock, [&] { return end.stop_requested() || !queue_.empty(); });
                if (end.stop_requested()) return;
                message = std::move(queue_.front());
                queue_.pop_front();
                waiting_bytes_ -= message.bytes;
                doing_ = {message.client, message.id};
                running_ = std::stop_source();
                previewing_ = get_type(message.request) == "preview" ? message.client : std::string();
                began_ = Clock::now();
                ctx.stop = running_.get_token();
            }
            handle(message, ctx);
        }
    }

    /// Runs the document at the start; there is no client to answer, and `cancel` stops it.
    void run_what_was_opened() {
        if ((*latest_)["statements"].empty()) return;
        const Message message{.client = {}, .request = {{"type", "ran"}}, .id = 0, .bytes = 0};
        Context ctx;
        {
            const std::scoped_lock lock(mutex_);
            ctx.stop = running_.get_token();
        }
        do_request(message, ctx);
        publish();
    }

    Json do_request(const Message& message, Context& ctx) {
        request_ = &message;
        ctx.progress = [this](float fraction) { progress(fraction); };
        Json reply = session_.answer(message.client, message.request, ctx);
        request_ = nullptr;
        return reply;
    }

    void handle(const Message& message, Context& ctx) {
        Json reply = do_request(message, ctx);
        if (get_type(message.request) == "preview" && reply.value("kind", "") == "cancelled")
            reply = {{"ok", true}, {"dropped", true}};
        reply["re"] = message.id;
        const bool changed = session_.revision() != revision_;
        if (changed || was_reported()) publish();
        if (changed) {
            try {
                session_.keep_journal();
            } catch (const Error& error) {
                reply["warning"] = error.what();
            }
        }
        const std::scoped_lock lock(mutex_);
        doing_ = {};
        previewing_.clear();
        Client& client = clients_[message.client];
        --client.waiting;
        answer(client, message.id, reply.dump(-1, ' ', false, Json::error_handler_t::replace));
    }

    /// Sends the current state to all clients.
    void publish() {
        revision_ = session_.revision();
        auto state = std::make_shared<const Json>(session_.state());
        Json event = *state;
        event["type"] = "state";
        const std::string text = event.dump(-1, ' ', false, Json::error_handler_t::replace);
        const std::scoped_lock lock(mutex_);
        folder_ = session_.folder();
        latest_ = std::move(state);
        reported_.reset();
        send_to_all(text);
    }

    bool was_reported() {
        const std::scoped_lock lock(mutex_);
        return reported_.has_value();
    }

    void runs(const std::optional<Document::Running>& running) {
        statement_.reset();
        if (running) {
            statement_ = running->statement;
            progress(0);
        }
        const std::scoped_lock lock(mutex_);
        const bool begins = running && !runs_;
        runs_.reset();
        if (!running) return;
        runs_ = Running{running->statement, std::string(running->text.substr(0, running->text.find('\n')))};
        if (!begins) return;
        tell_at_ = Clock::now() + kRunsLong;
        herald_wake_.notify_all();
    }

    /// Notifies all clients of slow statements, whether they report progress or not.
    void tell_of_what_runs(const std::stop_token& end) {
        std::unique_lock lock(mutex_);
        // After a stop request, waiting returns at once, even while a statement runs.
        while (herald_wake_.wait(lock, end, [&] { return runs_.has_value(); }) && !end.stop_requested()) {
            const Clock::time_point at = tell_at_;
            if (Clock::now() < at) {
                herald_wake_.wait_until(lock, end, at, [&] { return !runs_ || tell_at_ != at; });
                continue;
            }
            tell_at_ = Clock::now() + kRunsLong;
            if (reported_ == runs_->statement) continue;
            reported_ = runs_->statement;
            Json event = *latest_;
            event["type"] = "state";
            say_what_runs(event);
            send_to_all(event.dump(-1, ' ', false, Json::error_handler_t::replace));
        }
    }

    void say_what_runs(Json& state) const {
        state["running"] = *reported_;
        state["doing"] = runs_ ? runs_->text : std::string();
    }

    void progress(float fraction) {
        const auto now = Clock::now();
        if (now - progressed_ < kProgressApart) return;
        progressed_ = now;
        Json event{{"type", "progress"},
                   {"statement", nullptr},
                   {"request", get_type(request_->request)},
                   {"by", request_->client},
                   {"fraction", fraction}};
        if (statement_) event["statement"] = *statement_;
        send_event(event);
    }

    void grown(const StudioGrown& g) {
        send_event({{"type", "grown"},
                    {"statement", g.statement},
                    {"key", g.key},
                    {"nodes", g.nodes},
                    {"until", g.until}});
    }

    void send_event(const Json& event) {
        const std::string text = event.dump(-1, ' ', false, Json::error_handler_t::replace);
        const std::scoped_lock lock(mutex_);
        send_to_all(text);
    }

    void send_to_all(const std::string& text) {
        for (auto& [name, client] : clients_) {
            if (client.connection) client.connection->send_text(text);
        }
    }

    const MemoryBudget shares_;
    BlobStore blobs_;
    std::mutex mutex_;  ///< guards the members up to the session
    std::condition_variable wake_;
    std::deque<Message> queue_;
    std::size_t waiting_bytes_ = 0;
    std::pair<std::string, std::uint64_t> doing_;  ///< client and id of the current request
    std::map<std::string, Client> clients_;
    std::stop_source running_;  ///< of the current request
    std::string previewing_;    ///< client of the current preview; empty: none
    Clock::time_point began_;   ///< start of the current request
    std::shared_ptr<const Json> latest_;
    std::string folder_;
    std::uint64_t joined_ = 0;
    std::optional<Running> runs_;          ///< the running statement
    std::optional<std::size_t> reported_;  ///< the running statement that clients were notified of
    Clock::time_point tell_at_;            ///< time of the next notification
    std::condition_variable_any herald_wake_;

    StudioSession session_;  ///< only used by the engine's thread, as are the following members
    std::uint64_t revision_ = 0;
    const Message* request_ = nullptr;      ///< the current request
    std::optional<std::size_t> statement_;  ///< the running statement
    Clock::time_point progressed_;
    std::jthread herald_;
    std::jthread thread_;  ///< destroyed before the members that it uses
};

StudioEngine::StudioEngine(const StudioOptions& options) : state_(std::make_unique<State>(options)) {}
StudioEngine::~StudioEngine() = default;

void StudioEngine::join(const std::string& name, std::shared_ptr<StudioClient> client) {
    state_->join(name, std::move(client));
}
void StudioEngine::leave(const std::string& name, const StudioClient* client) { state_->leave(name, client); }
void StudioEngine::post(const std::string& name, const std::string& message) { state_->post(name, message); }
StudioBytes StudioEngine::blob(std::string_view key) const { return state_->blob(key); }

}  // namespace coppice
