"""A running studio and a client that uses only sockets, for the tests in this folder."""
import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import tempfile
import time

TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10


class Studio:
    """`coppice studio` in a folder; a context manager that ends it."""

    def __init__(self, program, folder, *options, opened=None, environment=None):
        self.folder = folder
        self.home = tempfile.mkdtemp(prefix="studio home ")
        variables = dict(os.environ, XDG_STATE_HOME=self.home, XDG_RUNTIME_DIR=self.home, XDG_CONFIG_HOME=self.home)
        variables.update(environment or {})
        self.process = subprocess.Popen([program, "studio", str(opened or folder), "--no-browser", *options], env=variables,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.said = self.process.stdout.readline()
        found = re.search(r"browser: (.+)$", self.said)
        if not found:
            self.process.kill()
            raise RuntimeError(f"the studio did not start: {self.said}{self.process.stderr.read()}")
        self.doorway = found.group(1)
        with open(self.doorway, encoding="utf-8") as file:
            self.address = re.search(r"url=([^\"]+)", file.read()).group(1)
        self.port = int(re.search(r":(\d+)/", self.address).group(1))
        self.token = re.search(r"token=([^&\"]+)", self.address).group(1)
        self.host = f"127.0.0.1:{self.port}"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self, how=signal.SIGINT):
        """Ends the studio and returns its exit code."""
        if self.process.poll() is None:
            self.process.send_signal(how)
        try:
            return self.process.wait(10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self.process.stdout.close()
            self.process.stderr.close()

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), 20)

    def raw(self, data, wait=20):
        """Sends bytes unchanged; returns the answer up to its end or a pause."""
        with self.connect() as connection:
            connection.settimeout(wait)
            try:
                connection.sendall(data)
            except (BrokenPipeError, ConnectionResetError):
                pass
            return read_answer(connection)

    def ask(self, method, target, fields=None, body=b"", **kept):
        """Sends a request; returns (status, fields, body). `kept` replaces default fields, or removes them by None."""
        all_fields = {"Host": self.host, "Authorization": f"Bearer {self.token}", "Origin": f"http://{self.host}",
                      "Connection": "close"}
        if body or method == "PUT":
            all_fields["Content-Length"] = str(len(body))
        all_fields.update(fields or {})
        all_fields.update({k.replace("_", "-"): v for k, v in kept.items()})
        head = f"{method} {target} HTTP/1.1\r\n" + "".join(f"{k}: {v}\r\n" for k, v in all_fields.items() if v is not None) + "\r\n"
        return parse_answer(self.raw(head.encode("latin-1") + body))

    def client(self, name=None, **options):
        return Client(self, name, **options)


def read_answer(connection):
    out = b""
    try:
        while piece := connection.recv(1 << 16):
            out += piece
    except (socket.timeout, ConnectionResetError):
        pass
    return out


def parse_answer(data):
    head, _, body = data.partition(b"\r\n\r\n")
    lines = head.decode("latin-1").split("\r\n")
    status = int(lines[0].split(" ")[1]) if lines[0].startswith("HTTP/") else 0
    fields = {k.strip().lower(): v.strip() for k, _, v in (line.partition(":") for line in lines[1:])}
    return status, fields, body


class Closed(Exception):
    def __init__(self, code, reason):
        super().__init__(f"{code} {reason}")
        self.code, self.reason = code, reason


class Client:
    """A WebSocket of the protocol. Received messages are sorted into answers by number, binary frames, and events."""

    def __init__(self, studio, name=None, hello=True, token=None):
        self.studio = studio
        self.name = name or base64.b32encode(os.urandom(15)).decode().strip("=")
        self.last = 0
        self.answers, self.frames, self.events = {}, [], []
        self.state = None
        self.connection = studio.connect()
        self.buffer = b""
        key = base64.b64encode(os.urandom(16)).decode()
        self.connection.sendall(f"GET /ws HTTP/1.1\r\nHost: {studio.host}\r\nOrigin: http://{studio.host}\r\nUpgrade: websocket\r\n"
                                f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        while b"\r\n\r\n" not in self.buffer:
            piece = self.connection.recv(4096)
            if not piece:
                raise Closed(0, "no upgrade")
            self.buffer += piece
        head, _, self.buffer = self.buffer.partition(b"\r\n\r\n")
        status = parse_answer(head + b"\r\n\r\n")[0]
        if status != 101:
            raise Closed(status, "no upgrade")
        if hello:
            self.send({"type": "hello", "version": 1, "token": token or studio.token, "client": self.name})
            self.until(lambda: self.state is not None)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.connection.close()

    def send_frame(self, kind, data, final=True, masked=True, first=None):
        mask = os.urandom(4)
        head = bytes([(0x80 if final else 0) | kind]) if first is None else bytes([first])
        length = len(data)
        bit = 0x80 if masked else 0
        if length < 126:
            head += bytes([bit | length])
        elif length < 1 << 16:
            head += bytes([bit | 126]) + struct.pack(">H", length)
        else:
            head += bytes([bit | 127]) + struct.pack(">Q", length)
        if masked:
            pattern = (mask * (length // 4 + 1))[:length]
            data = (int.from_bytes(data, "big") ^ int.from_bytes(pattern, "big")).to_bytes(length, "big")
            head += mask
        self.connection.sendall(head + data)

    def send(self, message):
        self.send_frame(TEXT, json.dumps(message).encode())

    def take(self, count):
        while len(self.buffer) < count:
            piece = self.connection.recv(1 << 16)
            if not piece:
                raise Closed(1006, "cut")
            self.buffer += piece
        out, self.buffer = self.buffer[:count], self.buffer[count:]
        return out

    def read_frame(self):
        first, second = self.take(2)
        length = second & 127
        if length == 126:
            length = struct.unpack(">H", self.take(2))[0]
        elif length == 127:
            length = struct.unpack(">Q", self.take(8))[0]
        data = self.take(length)
        if not first & 0x80:
            rest, data2 = self.read_frame()
            return first & 15, data + data2
        return first & 15, data

    def receive(self, wait=20):
        """Receives and sorts one message."""
        self.connection.settimeout(wait)
        kind, data = self.read_frame()
        if kind == CLOSE:
            raise Closed(struct.unpack(">H", data[:2])[0] if len(data) >= 2 else 1005, data[2:].decode())
        if kind == PING:
            self.send_frame(PONG, data)
        elif kind == BINARY:
            self.frames.append(data)
        elif kind == TEXT:
            message = json.loads(data)
            if "re" in message:
                self.answers[message["re"]] = message
            else:
                self.events.append(message)
                if message["type"] == "state":
                    self.state = message
                elif message["type"] == "welcome":
                    self.state = message["state"]

    def until(self, true, wait=20):
        end = time.monotonic() + wait
        while not true():
            left = end - time.monotonic()
            if left <= 0:
                raise TimeoutError(f"the condition was not met within {wait} s")
            self.receive(left)

    def post(self, kind, /, **fields):
        """Sends a request and returns its number."""
        self.last += 1
        self.send({"id": self.last, "type": kind, **fields})
        return self.last

    def answer(self, number, wait=60):
        self.until(lambda: number in self.answers, wait)
        return self.answers[number]

    def request(self, kind, /, **fields):
        """Sends a request and returns its answer, which may be an error."""
        return self.answer(self.post(kind, **fields))

    def must(self, kind, /, **fields):
        reply = self.request(kind, **fields)
        if not reply["ok"]:
            raise AssertionError(f"{kind} {fields}: {reply}")
        return reply

    def blob(self, key):
        status, _, body = self.studio.ask("GET", f"/blob/{key}")
        assert status == 200, (key, status, body)
        return body


def read_header(blob):
    """Returns the JSON header of a geometry blob."""
    assert blob[:4] == b"CPB1", blob[:16]
    length = struct.unpack("<I", blob[4:8])[0]
    return json.loads(blob[8:8 + length])
