#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "coppice/studio/engine.h"
#include "router.h"

namespace coppice::server {

/// A port of this machine that is listened at, before anything is answered there.
class Listener {
  public:
    /// At 127.0.0.1 and nowhere else; `port` 0 takes one that is free. Throws IoError where it is taken.
    explicit Listener(std::uint16_t port);
    ~Listener();
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

    std::uint16_t port() const;  ///< the one that it got

  private:
    friend class Server;
    struct Sockets;
    std::unique_ptr<Sockets> sockets_;
};

/// What connections may cost.
struct ServerLimits {
    int clients = 16;                              ///< WebSockets of pages at once
    std::size_t connections = 128;                 ///< of any kind at once; those without the token make room
    std::size_t message = std::size_t{1} << 20;    ///< [bytes] from a client
    std::size_t waiting = std::size_t{256} << 20;  ///< [bytes] for a client that does not read them
    int hello_seconds = 15;                        ///< without a request or a hello, until the token comes
    int idle_seconds = 60;                         ///< without a request or a sign of life, after that
    int transfer_seconds = 600;                    ///< for one body
};

/// Speaks HTTP and WebSocket for an engine: docs/library/studio-protocol.md. All connections are served by
/// one thread, what takes long by a few others; none waits for another.
class Server {
  public:
    Server(Listener& listener, const Router& router, StudioEngine& engine, ServerLimits limits = {});
    ~Server();

    /// Serves until a stop is asked for.
    void run(const std::stop_token& stop);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice::server
