#include "server.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <cctype>
#include <chrono>
#include <deque>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coppice/base/error.h"
#include "http_head.h"

namespace coppice::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Failure = beast::error_code;

constexpr std::size_t kPiece = 256 << 10;  // [bytes] maximum part of an upload that is read at a time
constexpr std::size_t kShortestName = 16, kLongestName = 64;  // limits of the names of clients
constexpr int kProtocol = 1;
constexpr unsigned kWorkers = 2;  // threads that compute requested geometry

/// Sets the fields that are common to all responses.
template <class Fields>
void set_common_fields(Fields& out) {
    out.set(http::field::cache_control, "no-store");
    out.set("X-Content-Type-Options", "nosniff");
    out.set("Referrer-Policy", "no-referrer");
    out.set("Cross-Origin-Opener-Policy", "same-origin");
    out.set("Cross-Origin-Resource-Policy", "same-origin");
}

/// The other end of a connection of any kind.
class Peer {
  public:
    virtual ~Peer() = default;
    virtual void cut() = 0;  ///< closes the connection without a message
    bool has_token() const { return has_token_; }

  protected:
    void note_token() { has_token_ = true; }  ///< called for a request or a hello with the token

  private:
    bool has_token_ = false;
};

/// The open connections, in the order of their creation.
class Peers {
  public:
    explicit Peers(std::size_t max_count) : max_count_(max_count) {}

    void add(const std::shared_ptr<Peer>& peer) { all_.push_back(peer); }

    /// Makes room for one more connection if the limit is reached: closes the oldest one that has not
    /// presented the token, so that programs of other users cannot lock out the owner. Returns whether there
    /// is room.
    bool make_room() {
        std::erase_if(all_, [](const auto& peer) { return peer.expired(); });
        if (all_.size() < max_count_) return true;
        const auto oldest = std::ranges::find_if(all_, [](const auto& peer) {
            const auto open = peer.lock();
            return !open || !open->has_token();
        });
        if (oldest == all_.end()) return false;
        if (const auto open = oldest->lock()) open->cut();
        all_.erase(oldest);
        return true;
    }

    void cut_all() {
        for (const auto& peer : std::exchange(all_, {})) {
            if (const auto open = peer.lock()) open->cut();
        }
    }

  private:
    std::vector<std::weak_ptr<Peer>> all_;
    std::size_t max_count_;
};

/// Returns whether the action was granted to a request with the token.
bool shows_token(const Plan& plan) {
    return !std::holds_alternative<HttpReply>(plan) && !std::holds_alternative<OpenSocket>(plan);
}

/// Data shared by all connections.
struct Shared {
    const Router& router;
    StudioEngine& engine;
    ServerLimits limits;
    Peers peers{limits.connections};
    int clients = 0;  ///< WebSockets that sent a hello with the token
    asio::io_context io{1};
    asio::thread_pool workers{kWorkers};
};

/// Counts an object during its lifetime.
class Counted {
  public:
    explicit Counted(int& count) : count_(count) { ++count_; }
    ~Counted() { --count_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;

  private:
    int& count_;
};

/// A WebSocket of a page, or of another client with the token.
class Socket final : public Peer, public StudioClient, public std::enable_shared_from_this<Socket> {
  public:
    Socket(beast::tcp_stream stream, Shared& shared)
        : shared_(shared), stream_(std::move(stream)), timer_(shared.io) {}

    void start(const http::request<http::empty_body>& request) {
        websocket::stream_base::timeout times{};
        times.handshake_timeout = std::chrono::seconds(shared_.limits.hello_seconds);
        times.idle_timeout = std::chrono::seconds(shared_.limits.idle_seconds);
        times.keep_alive_pings = true;
        beast::get_lowest_layer(stream_).expires_never();
        stream_.set_option(times);
        stream_.set_option(websocket::stream_base::decorator(
            [](websocket::response_type& response) { set_common_fields(response); }));
        stream_.read_message_max(shared_.limits.message);
        shared_.peers.add(shared_from_this());
        stream_.async_accept(request, [self = shared_from_this()](Failure failure) {
            if (failure) return;
            self->wait_for_hello();
            self->read();
        });
    }

    void send_text(std::string message) override {
        post({true, std::make_shared<const std::string>(std::move(message))});
    }
    void send_binary(StudioBytes frame) override { post({false, std::move(frame)}); }

    void cut() override {
        leave();
        beast::get_lowest_layer(stream_).close();
    }

  private:
    struct Frame {
        bool is_text;
        StudioBytes bytes;
    };

    /// Called on the engine's thread; hands over to the thread of the connections. The queue of a client that
    /// does not read is limited.
    void post(Frame frame) {
        const std::size_t bytes = frame.bytes->size();
        if (waiting_.fetch_add(bytes) + bytes > shared_.limits.waiting && waiting_ != bytes) {
            waiting_.fetch_sub(bytes);
            // Closed at once: closing in order would wait for the page to read.
            asio::post(shared_.io, [self = shared_from_this()] { self->cut(); });
            return;
        }
        asio::post(shared_.io, [self = shared_from_this(), frame = std::move(frame)]() mutable {
            self->queue_.push_back(std::move(frame));
            if (self->queue_.size() == 1) self->write();
        });
    }

    void write() {
        if (closing_) return;
        const Frame& frame = queue_.front();
        stream_.text(frame.is_text);
        stream_.async_write(asio::buffer(*frame.bytes),
                            [self = shared_from_this()](Failure failure, std::size_t) {
                                self->waiting_.fetch_sub(self->queue_.front().bytes->size());
                                self->queue_.pop_front();
                                if (failure) return self->leave();
                                if (!self->queue_.empty()) self->write();
                            });
    }

    void wait_for_hello() {
        timer_.expires_after(std::chrono::seconds(shared_.limits.hello_seconds));
        timer_.async_wait([self = shared_from_this()](Failure failure) {
            if (!failure && self->name_.empty())
                self->close(websocket::close_code::policy_error, "the client sent no hello");
        });
    }

    void read() {
        stream_.async_read(buffer_, [self = shared_from_this()](Failure failure, std::size_t) {
            if (failure) return self->leave();
            const std::string message = beast::buffers_to_string(self->buffer_.cdata());
            self->buffer_.consume(self->buffer_.size());
            if (!self->stream_.got_text())
                return self->close(websocket::close_code::unknown_data, "messages must be text");
            if (!self->name_.empty()) {
                self->shared_.engine.post(self->name_, message);
            } else if (!self->greet(message)) {
                return;
            }
            self->read();
        });
    }

    /// Checks the first message, which identifies the client; later ones are for the engine.
    bool greet(const std::string& message) {
        const auto hello = nlohmann::json::parse(message, nullptr, false);
        const auto text = [&](const char* field) {
            const auto found = hello.is_object() ? hello.find(field) : hello.end();
            return hello.is_object() && found != hello.end() && found->is_string() ? found->get<std::string>()
                                                                                   : std::string();
        };
        const std::string client = text("client");
        const bool is_name =
            client.size() >= kShortestName && client.size() <= kLongestName &&
            std::ranges::all_of(client, [](unsigned char c) { return std::isalnum(c) != 0; });
        if (text("type") != "hello" || !is_name) {
            close(websocket::close_code::policy_error, "the first message must be a hello");
        } else if (!shared_.router.knows(text("token"))) {
            close(websocket::close_code::policy_error,
                  "This page has the token of another studio; open it again from the terminal.");
        } else if (hello.value("version", nlohmann::json()) != kProtocol) {
            close(websocket::close_code::policy_error, "The studio has another version; reload the page.");
        } else if (shared_.clients >= shared_.limits.clients) {
            close(websocket::close_code::try_again_later, "too many pages are open");
        } else {
            note_token();
            counted_.emplace(shared_.clients);
            name_ = client;
            timer_.cancel();
            shared_.engine.join(name_, shared_from_this());
            return true;
        }
        return false;
    }

    void close(websocket::close_code code, const char* reason) {
        if (closing_) return;
        closing_ = true;
        timer_.cancel();
        if (!name_.empty()) shared_.engine.leave(name_, this);
        stream_.async_close({code, reason}, [self = shared_from_this()](Failure) {});
    }

    void leave() {
        closing_ = true;
        timer_.cancel();
        if (!name_.empty()) shared_.engine.leave(name_, this);
    }

    Shared& shared_;
    std::optional<Counted> counted_;  ///< counts among the clients after the hello
    websocket::stream<beast::tcp_stream> stream_;
    asio::steady_timer timer_;
    beast::flat_buffer buffer_;
    std::string name_;  ///< of the client; empty before its hello
    std::deque<Frame> queue_;
    std::atomic<std::size_t> waiting_ = 0;  ///< [bytes] in the queue or on the way to it
    bool closing_ = false;
};

/// An HTTP connection: one request after the other, until one requests a WebSocket.
class Connection final : public Peer, public std::enable_shared_from_this<Connection> {
  public:
    Connection(tcp::socket socket, Shared& shared) : shared_(shared), stream_(std::move(socket)) {}

    void start() {
        shared_.peers.add(shared_from_this());
        read_head();
    }

    void cut() override { stream_.close(); }

  private:
    void wait_at_most(int seconds) { stream_.expires_after(std::chrono::seconds(seconds)); }

    void read_head() {
        head_.emplace();
        head_->header_limit(kMaxHead);
        head_->body_limit(std::numeric_limits<std::uint64_t>::max());  // the router limits the size
        wait_at_most(has_token() ? shared_.limits.idle_seconds : shared_.limits.hello_seconds);
        http::async_read_header(
            stream_, buffer_, *head_,
            [self = shared_from_this()](Failure failure, std::size_t) { self->take_head(failure); });
    }

    void take_head(Failure failure) {
        if (failure == http::error::header_limit) return refuse(431, "the head of the request is too long");
        if (failure == http::error::end_of_stream || failure == http::error::partial_message) return;
        if (failure.category() == make_error_code(http::error::bad_method).category())
            return refuse(400, "this is not an HTTP request");
        if (failure) return;  // closed by the client, or timed out
        Plan plan = shared_.router.plan(to_http_head(head_->get()));
        if (shows_token(plan)) note_token();
        std::visit([this](auto& wanted) { serve(wanted); }, plan);
    }

    /// Sends a response and reads no further: the following bytes may be the body of the refused request.
    void refuse(int status, const char* text) {
        is_last_ = true;
        send(sentence(status, text));
    }

    void serve(HttpReply& reply) {
        is_last_ = !head_->is_done() || !head_->keep_alive();
        send(std::move(reply));
    }

    void serve(SendBlob& wanted) {
        is_last_ = !head_->keep_alive();
        stream_.expires_never();
        asio::post(shared_.workers, [self = shared_from_this(), wanted = std::move(wanted)] {
            HttpReply reply = make_reply([&] { return self->shared_.router.blob(wanted); });
            asio::post(self->shared_.io,
                       [self, reply = std::move(reply)]() mutable { self->send(std::move(reply)); });
        });
    }

    void serve(SendFile& wanted) {
        is_last_ = !head_->keep_alive();
        send(make_reply([&] { return shared_.router.file(wanted); }));
    }

    void serve(OpenSocket&) {
        if (shared_.clients >= shared_.limits.clients) return refuse(503, "too many pages are open");
        const auto socket = std::make_shared<Socket>(std::move(stream_), shared_);
        socket->start(head_->get());
    }

    void serve(TakeFile& wanted) {
        try {
            upload_.emplace(shared_.router, std::move(wanted));
        } catch (const Router::Exists& error) {
            return refuse(409, error.what());
        } catch (const Error& error) {
            return refuse(403, error.what());
        }
        const bool asks_first = beast::iequals(head_->get()[http::field::expect], "100-continue");
        body_.emplace(std::move(*head_));
        piece_.resize(kPiece);
        if (!asks_first) return take_body();
        go_on_ = {http::status::continue_, 11};
        http::async_write(stream_, go_on_, [self = shared_from_this()](Failure failure, std::size_t) {
            if (!failure) self->take_body();
        });
    }

    void take_body() {
        if (body_->is_done()) {
            is_last_ = !body_->keep_alive();
            HttpReply reply = make_reply([&] { return upload_->commit(); });
            upload_.reset();
            return send(std::move(reply));
        }
        wait_at_most(shared_.limits.idle_seconds);
        auto& body = body_->get().body();
        body.data = piece_.data();
        body.size = piece_.size();
        http::async_read(stream_, buffer_, *body_, [self = shared_from_this()](Failure failure, std::size_t) {
            self->take_piece(failure);
        });
    }

    void take_piece(Failure failure) {
        if (failure && failure != http::error::need_buffer) {
            upload_.reset();  // an incomplete upload is removed
            return;
        }
        try {
            upload_->write({piece_.data(), piece_.size() - body_->get().body().size});
        } catch (const Error& error) {
            upload_.reset();
            return refuse(507, error.what());
        }
        take_body();
    }

    /// Converts errors while a response is made to responses.
    template <class Make>
    static HttpReply make_reply(Make&& make) {
        try {
            return std::forward<Make>(make)();
        } catch (const InvalidInput& error) {
            return sentence(400, error.what());
        } catch (const Error& error) {
            return sentence(500, error.what());
        } catch (const std::bad_alloc&) {
            return sentence(507,
                            "there is not enough memory for this; show less, or allow more by --max-memory");
        } catch (const std::exception&) {
            return sentence(500, "this is a defect of coppice, please report it");
        }
    }

    template <class Body>
    void fill_head(http::response<Body>& out, const HttpReply& reply) {
        out.version(11);
        out.result(static_cast<unsigned>(reply.status));
        out.set(http::field::content_type, reply.type);
        set_common_fields(out);
        for (const auto& [name, value] : reply.fields) out.set(name, value);
        out.keep_alive(!is_last_);
        out.prepare_payload();
    }

    void send(HttpReply reply) {
        reply_ = std::move(reply);
        if (auto* file = std::get_if<Descriptor>(&reply_.body)) return send_file(*file);
        const auto* text = std::get_if<std::string>(&reply_.body);
        const std::string& bytes = text != nullptr ? *text : *std::get<StudioBytes>(reply_.body);
        bytes_.emplace();
        bytes_->body() = {bytes.data(), bytes.size()};
        fill_head(*bytes_, reply_);
        write(*bytes_);
    }

    void send_file(Descriptor& open) {
        beast::file_posix file;
        file.native_handle(open.release());
        Failure failure;
        file_.emplace();
        file_->body().reset(std::move(file), failure);
        if (failure) return send(sentence(500, "the file cannot be read"));
        fill_head(*file_, reply_);
        write(*file_);
    }

    template <class Body>
    void write(http::response<Body>& out) {
        wait_at_most(shared_.limits.transfer_seconds);
        http::async_write(stream_, out, [self = shared_from_this()](Failure failure, std::size_t) {
            self->reply_ = {};
            if (failure) return;
            if (!self->is_last_) return self->read_head();
            self->end();
        });
    }

    /// Reads the remaining input for a moment: closing at once would discard the response to a client that is
    /// still sending.
    void end() {
        Failure ignored;
        stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        piece_.resize(kPiece);
        wait_at_most(2);
        drain();
    }

    void drain() {
        stream_.async_read_some(asio::buffer(piece_),
                                [self = shared_from_this()](Failure failure, std::size_t) {
                                    if (!failure) self->drain();
                                });
    }

    Shared& shared_;
    beast::tcp_stream stream_;
    beast::flat_buffer buffer_{kPiece + kMaxHead};
    std::optional<http::request_parser<http::empty_body>> head_;
    std::optional<http::request_parser<http::buffer_body>> body_;
    std::optional<Router::Upload> upload_;
    std::string piece_;
    bool is_last_ = false;  ///< the connection closes after this response
    HttpReply reply_;
    http::response<http::empty_body> go_on_;
    std::optional<http::response<http::span_body<const char>>> bytes_;
    std::optional<http::response<http::file_body>> file_;
};

}  // namespace

struct Listener::Sockets {
    asio::io_context io{1};  // Used only to listen: the server takes over the descriptor.
    tcp::acceptor acceptor{io};
};

Listener::Listener(std::uint16_t port) : sockets_(std::make_unique<Sockets>()) {
    Failure failure;
    const tcp::endpoint here(asio::ip::address_v4::loopback(), port);
    auto& acceptor = sockets_->acceptor;
    acceptor.open(here.protocol(), failure);
    if (!failure) acceptor.set_option(asio::socket_base::reuse_address(true), failure);
    if (!failure) acceptor.bind(here, failure);
    if (!failure) acceptor.listen(asio::socket_base::max_listen_connections, failure);
    if (failure)
        throw IoError(
            fmt::format("the server cannot use port {} of this machine ({}); choose another one by --port, "
                        "or 0 for a free one",
                        port, failure.message()));
}

Listener::~Listener() = default;

std::uint16_t Listener::port() const { return sockets_->acceptor.local_endpoint().port(); }

struct Server::State {
    State(Listener& listener, const Router& router, StudioEngine& engine, ServerLimits limits)
        : shared{.router = router, .engine = engine, .limits = limits},
          acceptor(shared.io),
          pause(shared.io) {
        acceptor.assign(tcp::v4(), listener.sockets_->acceptor.release());
    }

    ~State() {
        shared.workers.stop();
        shared.workers.join();
        shared.peers.cut_all();
    }

    void accept() {
        acceptor.async_accept([this](Failure failure, tcp::socket socket) {
            if (!failure && shared.peers.make_room()) {
                Failure ignored;
                socket.set_option(tcp::no_delay(true), ignored);
                std::make_shared<Connection>(std::move(socket), shared)->start();
            }
            if (!failure) return accept();
            // For example no free descriptors: other connections may close in the interval.
            pause.expires_after(std::chrono::milliseconds(100));
            pause.async_wait([this](Failure stopped) {
                if (!stopped) accept();
            });
        });
    }

    Shared shared;
    tcp::acceptor acceptor;
    asio::steady_timer pause;
};

Server::Server(Listener& listener, const Router& router, StudioEngine& engine, ServerLimits limits)
    : state_(std::make_unique<State>(listener, router, engine, limits)) {}

Server::~Server() = default;

void Server::run(const std::stop_token& stop) {
    asio::io_context& io = state_->shared.io;
    const std::stop_callback on_stop(stop, [&io] { io.stop(); });
    state_->accept();
    while (!io.stopped()) {
        try {
            io.run();
        } catch (const std::bad_alloc&) {
            continue;  // the connection that caused it is closed; the others continue
        }
    }
}

}  // namespace coppice::server
