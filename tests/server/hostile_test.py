"""Hostile requests to the port of the studio, as sent by foreign pages, other programs and broken clients: each row of the table is
one request with its permitted answers, and after each the studio must still answer its own page."""
import os
import struct
import sys
import tempfile
import time
import unittest

from studio_client import BINARY, CLOSE, PING, TEXT, Client, Closed, Studio, parse_answer

PROGRAM = sys.argv.pop(1)
ENDS = 0  # the connection ends without an answer


def rows(studio):
    """Returns (label, request, permitted statuses) of each request."""
    host, token = studio.host, studio.token
    own = f"Host: {host}\r\n"
    bearer = f"Authorization: Bearer {token}\r\n"
    origin = f"Origin: http://{host}\r\n"
    end = "Connection: close\r\n\r\n"

    def get(target, *fields, method="GET", version="HTTP/1.1", body=""):
        return f"{method} {target} {version}\r\n" + "".join(fields) + end + body

    upgrade = "Upgrade: websocket\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
    out = []
    # Host names of other machines: DNS rebinding.
    for name in ["evil.example", f"evil.example:{studio.port}", "127.0.0.1", f"127.0.0.1:{studio.port + 1}", f"[::1]:{studio.port}",
                 f"0.0.0.0:{studio.port}", f"127.0.0.1:{studio.port}@evil.example", f"127.0.0.1:{studio.port}.", "localhost", "\x00"]:
        out.append((f"host {name!r}", get("/", f"Host: {name}\r\n"), [421, 400]))
    out.append(("no host", get("/"), [421]))
    out.append(("two hosts", get("/", own, own), [421, 400]))
    out.append(("host in the target", get(f"http://{host}/", "Host: evil.example\r\n"), [421]))
    out.append(("blob under another name", get("/blob/x", "Host: evil.example\r\n", bearer), [421]))
    # Foreign origins.
    for name in ["http://evil.example", "null", f"https://{host}", f"http://{host}.evil.example", f"http://localhost:{studio.port}", "file://",
                 f"http://{host}/", ""]:
        out.append((f"socket of {name!r}", get("/ws", own, f"Origin: {name}\r\n", upgrade), [403]))
        out.append((f"upload of {name!r}", get("/file/x.swc", own, bearer, f"Origin: {name}\r\n", "Content-Length: 1\r\n", method="PUT", body="1"), [403]))
    out.append(("socket without origin", get("/ws", own, upgrade), [403]))
    out.append(("upload without origin", get("/file/x.swc", own, bearer, "Content-Length: 1\r\n", method="PUT", body="1"), [403]))
    # Tokens.
    for said in ["", "Bearer", "Bearer ", "Bearer x", f"Bearer {token[:-1]}", f"Bearer {token}x", f"bearer {token}", f"Basic {token}", f"Bearer {'A' * 43}"]:
        out.append((f"token {said[:9]!r}", get("/file/secret.swc", own, f"Authorization: {said}\r\n"), [401]))
    out.append(("no token", get("/file/secret.swc", own), [401]))
    out.append(("token as a cookie", get("/file/secret.swc", own, f"Cookie: token={token}\r\n"), [401]))
    out.append(("token in the address", get(f"/file/secret.swc?token={token}", own), [400]))
    out.append(("two tokens", get("/file/secret.swc", own, bearer, bearer), [401]))
    out.append(("blob without token", get("/blob/1-axes-plain", own), [401]))
    out.append(("upload without token", get("/file/x.swc", own, origin, "Content-Length: 1\r\n", method="PUT", body="1"), [401]))
    # Paths out of the folder.
    for name in ["../outside.swc", "..%2foutside.swc", "%2e%2e/outside.swc", "..%5coutside.swc", "/etc/passwd", "%2fetc%2fpasswd", "a/../../outside.swc",
                 ".hidden", "folder/.hidden", "link.swc", "linked/outside.swc", "%00", "secret.swc%00.txt", "secret.swc/", "./secret.swc/.", "~/x",
                 "%c0%ae%c0%ae/outside.swc", "....//outside.swc", "folder//../..//outside.swc", "file:%2f%2f%2fetc%2fpasswd", "fifo"]:
        out.append((f"reading {name}", get(f"/file/{name}", own, bearer), [404, 400]))
        out.append((f"writing {name}", get(f"/file/{name}", own, bearer, origin, "Content-Length: 4\r\nX-Overwrite: yes\r\n", method="PUT", body="evil"), [403, 400, 404]))
    out.append(("overwriting", get("/file/secret.swc", own, bearer, origin, "Content-Length: 4\r\n", method="PUT", body="evil"), [409]))
    out.append(("writing a folder", get("/file/folder", own, bearer, origin, "Content-Length: 4\r\nX-Overwrite: yes\r\n", method="PUT", body="evil"), [403]))
    for name in ["/../app.js", "/%2e%2e/etc/passwd", "//etc/passwd", "/app.js/..", "/.git/config", "/src/app.ts", "/@fs/etc/passwd", "/index.html%00"]:
        out.append((f"page {name}", get(name, own), [404, 400]))
    # Methods and bodies.
    for method in ["POST", "DELETE", "PATCH", "OPTIONS", "TRACE", "HEAD", "PROPFIND", "X" * 40]:
        out.append((f"{method[:8]} of the page", get("/", own, method=method), [405, 400]))
        out.append((f"{method[:8]} of a file", get("/file/secret.swc", own, bearer, origin, method=method), [405, 400]))
    out.append(("preflight", get("/file/secret.swc", own, "Origin: http://evil.example\r\n", "Access-Control-Request-Method: PUT\r\n", method="OPTIONS"), [401, 405]))
    out.append(("body with GET", get("/", own, "Content-Length: 3\r\n", body="abc"), [400]))
    out.append(("chunks", get("/file/x.swc", own, bearer, origin, "Transfer-Encoding: chunked\r\n", method="PUT", body="4\r\nevil\r\n0\r\n\r\n"), [411]))
    out.append(("chunks and length", get("/file/x.swc", own, bearer, origin, "Transfer-Encoding: chunked\r\nContent-Length: 4\r\n", method="PUT", body="evil"), [400, 411]))
    out.append(("two lengths", get("/file/x.swc", own, bearer, origin, "Content-Length: 4\r\nContent-Length: 5\r\n", method="PUT", body="evil"), [400, 411]))
    out.append(("no length", get("/file/x.swc", own, bearer, origin, method="PUT"), [411]))
    out.append(("too long", get("/file/x.swc", own, bearer, origin, "Content-Length: 3000000\r\n", method="PUT", body="evil"), [413]))
    out.append(("negative length", get("/file/x.swc", own, bearer, origin, "Content-Length: -4\r\n", method="PUT"), [400]))
    out.append(("length out of range", get("/file/x.swc", own, bearer, origin, f"Content-Length: {'9' * 30}\r\n", method="PUT"), [400]))
    # Invalid or too long HTTP.
    out.append(("long address", get("/" + "a" * 5000, own), [400]))
    out.append(("long field", get("/", own, f"X: {'a' * 9000}\r\n"), [431]))
    out.append(("many fields", get("/", own, "X: a\r\n" * 4000), [431]))
    out.append(("version 9", get("/", own, version="HTTP/9.9"), [400]))
    out.append(("version 0.9", "GET /\r\n\r\n", [400, ENDS]))
    out.append(("empty request", "\r\n\r\n", [400, ENDS]))
    out.append(("bytes", "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", [400, ENDS]))
    out.append(("another protocol", "*1\r\n$4\r\nPING\r\n", [400, ENDS]))
    out.append(("mail", "EHLO evil.example\r\n", [400, ENDS]))
    out.append(("line ends within a field", get("/", own, "X: a\r\n b\r\n"), [200, 400]))
    out.append(("blank before the colon", get("/", f"Host : {host}\r\n"), [400, 421]))
    out.append(("bare line end", f"GET / HTTP/1.1\nHost: {host}\n\n", [400, ENDS]))
    out.append(("null in the target", get("/\x00", own), [400]))
    out.append(("smuggled request", get("/", own, "Content-Length: 10\r\n", body="GET /file/"), [400]))
    # Invalid WebSockets.
    out.append(("socket without upgrade", get("/ws", own, origin), [426]))
    out.append(("socket by POST", get("/ws", own, origin, upgrade, method="POST"), [405]))
    out.append(("socket without key", get("/ws", own, origin, "Upgrade: websocket\r\n"), [400, 426]))
    out.append(("socket of version 8", f"GET /ws HTTP/1.1\r\n{own}{origin}Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                "Sec-WebSocket-Version: 8\r\n\r\n", [400, 426]))
    return out


class Hostile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.outside = tempfile.mkdtemp(prefix="studio hostile ")
        cls.folder = os.path.join(cls.outside, "work")
        os.makedirs(os.path.join(cls.folder, "folder"))
        for name in ["outside.swc", "work/secret.swc", "work/.hidden", "work/folder/.hidden"]:
            with open(os.path.join(cls.outside, name), "w", encoding="utf-8") as file:
                file.write("precious")
        os.symlink("../outside.swc", os.path.join(cls.folder, "link.swc"))
        os.symlink("..", os.path.join(cls.folder, "linked"))
        os.mkfifo(os.path.join(cls.folder, "fifo"))
        cls.studio = Studio(PROGRAM, cls.folder, "--max-upload", "2")

    @classmethod
    def tearDownClass(cls):
        assert cls.studio.end() == 0

    def listing(self):
        return sorted(os.path.join(root, name) for root, _, names in os.walk(self.outside) for name in names)

    def test_requests(self):
        before = self.listing()
        table = rows(self.studio)
        self.assertGreaterEqual(len(table), 100)
        for label, request, right in table:
            with self.subTest(label):
                status, fields, body = parse_answer(self.studio.raw(request.encode("latin-1"), 5))
                self.assertIn(status, right, (label, body[:200]))
                self.assertNotIn(b"precious", body)
                self.assertNotIn(self.studio.token.encode(), body)
                self.assertFalse([f for f in fields if f.startswith("access-control")], label)
                self.assertLess(len(body), 2000 if status != 200 else 1 << 20)
                if status:
                    self.assertEqual(fields.get("x-content-type-options"), "nosniff")
                self.assertEqual(self.studio.ask("GET", "/file/secret.swc")[2], b"precious")
        self.assertEqual(self.listing(), before)  # no file was added or removed

    def test_first_messages(self):
        hello = {"type": "hello", "version": 1, "token": self.studio.token, "client": "c" * 20}
        wrong = [("token", dict(hello, token="x" * 43)), ("empty", {}), ("version", dict(hello, version=2)), ("list", []),
                 ("name", dict(hello, client="short")), ("long name", dict(hello, client="c" * 65)), ("odd name", dict(hello, client="../" * 8)),
                 ("number", dict(hello, token=5)), ("request first", {"id": 1, "type": "run", "line": "sphere s"})]
        for label, message in wrong:
            with self.subTest(label), Client(self.studio, hello=False) as client:
                client.send(message)
                with self.assertRaises(Closed) as closed:
                    client.receive()
                self.assertEqual(closed.exception.code, 1008)
                self.assertNotIn(self.studio.token, closed.exception.reason)

    def test_frames(self):
        """An invalid frame ends its own connection with the specified code, and no other connection."""
        wrong = [("binary", lambda c: c.send_frame(BINARY, b"x"), [1003]),
                 ("no text", lambda c: c.send_frame(TEXT, b"\xff\xfe"), [1007, 1002]),
                 ("not masked", lambda c: c.send_frame(TEXT, b"{}", masked=False), [1002]),
                 ("reserved bits", lambda c: c.send_frame(TEXT, b"{}", first=0xF1), [1002]),
                 ("unknown kind", lambda c: c.send_frame(5, b"{}"), [1002]),
                 ("too long", lambda c: c.send_frame(TEXT, b"[" * (2 << 20)), [1009, 1006]),
                 ("length out of range", lambda c: c.connection.sendall(b"\x81\xff" + struct.pack(">Q", 1 << 62) + b"abcd"), [1009, 1002]),
                 ("long ping", lambda c: c.send_frame(PING, b"x" * 200), [1002]),
                 ("endless fragments", self.send_pieces, [1009, 1006]),
                 ("continuation without start", lambda c: c.send_frame(0, b"{}"), [1002]),
                 ("invalid close", lambda c: c.send_frame(CLOSE, b"\x00"), [1002, 1005])]
        with Client(self.studio) as good:
            for label, send, codes in wrong:
                with self.subTest(label), Client(self.studio) as client:
                    try:
                        send(client)
                        with self.assertRaises(Closed) as closed:
                            while True:
                                client.receive()
                        self.assertIn(closed.exception.code, codes)
                    except (BrokenPipeError, ConnectionResetError):
                        self.assertIn(1006, codes)
                    self.assertTrue(good.must("ping"))

    @staticmethod
    def send_pieces(client):
        client.send_frame(TEXT, b'{"id": 1, "type": "', final=False)
        for _ in range(64):
            client.send_frame(0, b"x" * 65536, final=False)

    def test_messages(self):
        """Invalid messages are answered with an error message."""
        with Client(self.studio) as client:
            for text in ["", "{", "null", "7", '"x"', "[" * 100_000, '{"id": 0}', '{"id": -1}', '{"id": "1"}', '{"id": 1.5}', '{"a":' * 50_000, "\u0000"]:
                client.send_frame(TEXT, text.encode())
            self.assertTrue(client.must("ping")["ok"])
            for kind, fields in [("nothing", {}), ("run", {}), ("run", {"line": 5}), ("run", {"line": "rm -rf /"}), ("show", {"kind": "solid"}),
                                 ("show", {"kind": "no", "name": "x"}), ("ran", {"count": -1}), ("ran", {"count": 1e300}), ("undo", {"count": 1e9}), ("text", {"text": "x", "revision": 99999}),
                                 ("open", {"file": "../outside.swc"}), ("open", {"file": "/etc/passwd"}), ("open", {"file": "fifo"}), ("save", {"file": "../x.coppice"}),
                                 ("save", {"file": "secret.swc"}), ("run", {"line": "loadtree t \"../outside.swc\""}), ("run", {"line": "loadtree t /etc/passwd"}),
                                 ("run", {"line": "loadtree t link.swc"}), ("aside", {"line": "save recipe \"../x.coppice\""}), ("aside", {"line": "save recipe .hidden"}),
                                 ("library", {"file": "../outside.swc"}), ("preview", {"seq": 1, "line": "loadmesh m \"linked/outside.swc\""}),
                                 ("sketch", {"sketch": {"views": [{"image": "../../etc/passwd"}]}}), ("trace", {"sketch": {}}), ("picture", {"objects": "x", "file": "y.png"}),
                                 ("export", {"kind": "skeleton", "name": "none", "file": "x.glb"}), ("program", {"item": 0}), ("ping", {"time": [[[[]]]]})]:
                with self.subTest(kind, fields=fields):
                    reply = client.request(kind, **fields)
                    if kind != "ping":
                        self.assertFalse(reply["ok"], (kind, fields))
                        self.assertLess(len(reply["error"]), 600)
                        self.assertNotIn("precious", reply["error"])

    def test_gets_change_nothing(self):
        with Client(self.studio) as client:
            revision = client.state["revision"]
            for target in ["/", "/app.js", "/blob/x", "/file/secret.swc", "/ws", "/file/run", "/run?line=sphere%20s"]:
                self.studio.ask("GET", target)
            client.must("ping")
            self.assertEqual(client.state["revision"], revision)

    def test_too_many_pages(self):
        clients = []
        try:
            with self.assertRaises(Closed) as closed:
                for _ in range(40):
                    clients.append(Client(self.studio))
            self.assertEqual(closed.exception.code, 503)
            self.assertGreaterEqual(len(clients), 8)
            self.assertTrue(clients[0].must("ping"))
        finally:
            for client in clients:
                client.connection.close()

    def test_slow_heads_hold_up_nobody(self):
        held = [self.studio.connect() for _ in range(60)]
        for connection in held:
            connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
        self.assertEqual(self.studio.ask("GET", "/file/secret.swc")[2], b"precious")
        for connection in held:
            connection.close()

    def must_let_in(self):
        """Checks that the owner can read files and open a page."""
        self.assertEqual(self.studio.ask("GET", "/file/secret.swc")[2], b"precious")
        with Client(self.studio) as client:
            self.assertTrue(client.must("ping"))

    def test_connections_without_the_token_make_room(self):
        """Idle connections and sockets without a hello neither lock out the owner nor close open pages."""
        with Client(self.studio) as good:
            silent = {"idle": self.studio.connect, "without hello": lambda: Client(self.studio, hello=False).connection}
            for label, connect in silent.items():
                with self.subTest(label):
                    held = [connect() for _ in range(200)]
                    self.must_let_in()
                    held[0].settimeout(20)
                    self.assertEqual(held[0].recv(1 << 16), b"", "the oldest connection must be closed")
                    self.assertTrue(good.must("ping"))
                    for connection in held:
                        connection.close()

    def test_silent_connections_end(self):
        with self.studio.connect() as silent:
            silent.settimeout(30)
            begun = time.monotonic()
            self.assertEqual(silent.recv(1), b"")
            self.assertLess(time.monotonic() - begun, 25)

    def test_cut_uploads_leave_nothing(self):
        before = self.listing()
        with self.studio.connect() as connection:
            connection.sendall((f"PUT /file/cut.swc HTTP/1.1\r\nHost: {self.studio.host}\r\nAuthorization: Bearer {self.studio.token}\r\n"
                                f"Origin: http://{self.studio.host}\r\nContent-Length: 100000\r\n\r\n").encode() + b"x" * 5000)
        self.assertEqual(self.studio.ask("GET", "/file/cut.swc")[0], 404)
        self.assertEqual(self.listing(), before)


if __name__ == "__main__":
    unittest.main()
