"""Tests of how `coppice studio` starts and ends."""
import json
import os
import re
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import time
import unittest

from studio_client import Studio

PROGRAM = sys.argv.pop(1)


def refused(*arguments):
    run = subprocess.run([PROGRAM, "studio", "--no-browser", *arguments], capture_output=True, text=True, timeout=20, check=False)
    return run.returncode, run.stderr


class Starting(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="studio starting ")

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def test_wrong_beginnings_are_told(self):
        code, errors = refused(os.path.join(self.folder, "missing.coppice"))
        self.assertEqual(code, 4)
        self.assertIn("missing.coppice", errors)
        with socket.create_server(("127.0.0.1", 0)) as taken:
            code, errors = refused(self.folder, "--port", str(taken.getsockname()[1]))
        self.assertEqual(code, 4)
        self.assertIn("--port", errors)
        self.assertEqual(refused(self.folder, "--port", "70000")[0], 2)
        code, errors = refused(self.folder, "--page", self.folder)
        self.assertEqual(code, 3)
        self.assertIn("npm run build", errors)

    def test_only_this_machine_is_listened_to(self):
        with Studio(PROGRAM, self.folder) as studio:
            with open("/proc/net/tcp", encoding="ascii") as table:
                lines = [line.split() for line in table if f":{studio.port:04X} " in line and " 0A " in line]
            self.assertEqual([line[1] for line in lines], [f"0100007F:{studio.port:04X}"])

    def test_the_token_is_nowhere_to_be_seen(self):
        with Studio(PROGRAM, self.folder) as studio:
            self.assertEqual(stat.S_IMODE(os.stat(studio.doorway).st_mode), 0o600)
            self.assertNotIn(studio.token, studio.said)
            with open(f"/proc/{studio.process.pid}/cmdline", "rb") as file:
                self.assertNotIn(studio.token.encode(), file.read())
            doorway = studio.doorway
        self.assertFalse(os.path.exists(doorway))

    def test_ctrl_c_ends_it_within_a_second_whatever_runs(self):
        for how in [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]:
            with self.subTest(how), Studio(PROGRAM, self.folder) as studio, studio.client() as client:
                client.must("run", line="sphere crown radius=3")
                client.post("run", line="pointset generate crown poisson count=3000000 name=p")
                time.sleep(0.3)
                begun = time.monotonic()
                self.assertEqual(studio.end(how), 0)
                self.assertLess(time.monotonic() - begun, 2)  # one second plus the delay of a busy machine

    def test_ctrl_c_ends_it_while_its_scene_is_opened(self):
        path = self.write("long.coppice", "sphere crown radius=3\npointset generate crown poisson count=3000000 name=p\n")
        for wait in [0, 0.05, 0.3]:
            with self.subTest(wait), Studio(PROGRAM, self.folder, opened=path) as studio:
                time.sleep(wait)
                self.assertEqual(studio.end(), 0)

    def test_a_killed_studio_loses_nothing(self):
        path = self.write("tree.coppice", "sphere s\n")
        studio = Studio(PROGRAM, self.folder, opened=path)
        home = studio.home
        with studio.client() as client:
            self.assertFalse(client.state["recovered"])
            client.must("run", line="sphere t radius=2")
        studio.end(signal.SIGKILL)
        with open(path, encoding="utf-8") as file:
            self.assertEqual(file.read(), "sphere s\n")
        kept = {"XDG_STATE_HOME": home}
        with Studio(PROGRAM, self.folder, opened=path, environment=kept) as studio, studio.client() as client:
            self.assertEqual([s["text"] for s in client.state["statements"]], ["sphere s", "sphere t radius=2"])
            self.assertTrue(client.state["recovered"])
            self.assertFalse(client.state["saved"])
            client.must("save")
        with Studio(PROGRAM, self.folder, opened=path, environment=kept) as studio, studio.client() as client:
            self.assertFalse(client.state["recovered"])
            self.assertEqual(len(client.state["statements"]), 2)

    def test_two_studios_of_one_scene_have_a_journal_each(self):
        path = self.write("tree.coppice", "sphere s\n")
        with Studio(PROGRAM, self.folder, opened=path) as one:
            with Studio(PROGRAM, self.folder, opened=path, environment={"XDG_STATE_HOME": one.home}) as other:
                with one.client() as a, other.client() as b:
                    a.must("run", line="sphere a")
                    b.must("run", line="sphere b")
            found = []
            for root, _, names in os.walk(one.home):
                for name in names:
                    if name.endswith(".coppice"):
                        with open(os.path.join(root, name), encoding="utf-8") as file:
                            found.append(file.read())
        self.assertEqual(sorted(found), ["sphere s\nsphere a\n", "sphere s\nsphere b\n"])

    def test_a_scene_that_fails_opens_as_far_as_it_goes(self):
        path = self.write("tree.coppice", "sphere s\nnonsense\nsphere t\n")
        with Studio(PROGRAM, self.folder, opened=path) as studio, studio.client() as client:
            client.until(lambda: client.state["error"] is not None)
            self.assertEqual((client.state["ran"], len(client.state["statements"])), (1, 3))
            self.assertEqual(client.state["error"]["line"], 2)

    def test_a_long_scene_does_not_hold_up_the_page(self):
        path = self.write("long.coppice", "sphere crown radius=3\npointset generate crown poisson count=2000000 name=p\n")
        begun = time.monotonic()
        with Studio(PROGRAM, self.folder, opened=path) as studio:
            status = studio.ask("GET", "/")[0]
            with studio.client() as client:
                self.assertEqual(len(client.state["statements"]), 2)
            waited = time.monotonic() - begun
            with studio.client() as client:
                client.must("cancel")
        self.assertEqual(status, 200)
        self.assertLess(waited, 20)

    def test_another_file_is_named_to_the_page(self):
        path = self.write("a tree&b.swc", "1 1 0 0 0 1 -1\n")
        with Studio(PROGRAM, self.folder, opened=path) as studio:
            self.assertTrue(studio.address.endswith("&import=a%20tree%26b.swc"), studio.address)

    def test_the_page_is_in_the_program(self):
        with Studio(PROGRAM, self.folder) as studio:
            for name in ["/", "/app.js", "/app.css", "/worker.js"]:
                status, fields, body = studio.ask("GET", name, Authorization=None)
                self.assertEqual(status, 200)
                self.assertGreater(len(body), 20)
                self.assertEqual(fields["cache-control"], "no-store")
            nonces = {re.search(rb'name="nonce" content="([^"]+)"', studio.ask("GET", "/")[2]).group(1) for _ in range(3)}
            self.assertEqual(len(nonces), 3)

    def test_memory_is_held(self):
        with Studio(PROGRAM, self.folder, "--max-memory", "300") as studio, studio.client() as client:
            client.must("run", line="sphere crown radius=3")
            reply = client.request("run", line="pointset generate crown poisson count=50000000 name=p")
            self.assertFalse(reply["ok"], json.dumps(reply))
            self.assertIn("memory", reply["error"])
            self.assertTrue(client.must("run", line="sphere t")["ok"])
            with open(f"/proc/{studio.process.pid}/status", encoding="ascii") as file:
                peak = int(re.search(r"VmHWM:\s+(\d+)", file.read()).group(1)) / 1024
            self.assertLess(peak, 320)


if __name__ == "__main__":
    unittest.main()
