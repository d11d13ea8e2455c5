#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "coppice/studio/engine.h"
#include "router.h"

namespace coppice::server {

/// A port of this machine that is bound before the server answers requests.
class Listener {
  public:
    /// Listens at 127.0.0.1 only; `port` 0 selects a free port. Throws IoError if the port is in use.
    explicit Listener(std::uint16_t port);
    ~Listener();
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;

    std::uint16_t port() const;  ///< the actual port

  private:
    friend class Server;
    struct Sockets;
    std::unique_ptr<Sockets> sockets_;
};

/// Limits of the resources of connections.
struct ServerLimits {
    int clients = 16;  ///< maximum number of WebSockets
    /// maximum number of all connections; those without the token are closed first
    std::size_t connections = 128;
    std::size_t message = std::size_t{1} << 20;  ///< [bytes] maximum size of a message of a client
    std::size_t waiting = std::size_t{256}
                          << 20;  ///< [bytes] maximum size of the queue of a client that does not read
    int hello_seconds = 15;       ///< maximum time without a request or a hello, before the token arrives
    int idle_seconds = 60;        ///< maximum time without a request or a keep-alive, after that
    int transfer_seconds = 600;   ///< maximum time for one body
};

/// Serves HTTP and WebSocket for an engine: docs/library/studio-protocol.md. One thread serves all
/// connections, a few others do long work, so that no connection waits for another.
class Server {
  public:
    Server(Listener& listener, const Router& router, StudioEngine& engine, ServerLimits limits = {});
    ~Server();

    /// Serves until a stop is requested.
    void run(const std::stop_token& stop);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace coppice::server
