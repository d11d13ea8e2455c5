"""Tests of the studio protocol over real connections: docs/library/studio-protocol.md."""
import os
import sys
import tempfile
import threading
import time
import unittest

from studio_client import Client, Closed, Studio, read_header

PROGRAM = sys.argv.pop(1)


class Protocol(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="studio protocol ")
        self.studio = Studio(PROGRAM, self.folder)

    def tearDown(self):
        self.assertEqual(self.studio.end(), 0)

    def test_a_session_from_nothing_to_an_export(self):
        with self.studio.client() as client:
            self.assertEqual(client.state["statements"], [])
            client.must("run", line="sphere crown center=0,0,4 radius=2")
            client.must("run", line="pointset generate crown poisson count=300 name=fill")
            client.must("run", line="grow tree fill root=0,0,0")
            kinds = {(o["kind"], o["name"]) for o in client.state["objects"]}
            self.assertEqual(kinds, {("solid", "crown"), ("points", "fill"), ("skeleton", "tree")})
            shown = client.must("show", kind="skeleton", name="tree", form="surface", surface={})
            blob = client.blob(shown["key"])
            self.assertEqual(read_header(blob)["kind"], "surface")
            done = client.must("export", kind="skeleton", name="tree", file="tree.glb")
            path = os.path.join(self.folder, "tree.glb")
            self.assertEqual(os.path.getsize(path), done["bytes"])
            status, fields, body = self.studio.ask("GET", "/file/tree.glb")
            self.assertEqual((status, body[:4]), (200, b"glTF"))
            self.assertEqual(fields["content-disposition"], "attachment")
            client.must("save", file="tree.coppice")
            self.assertTrue(client.state["saved"])
            with open(os.path.join(self.folder, "tree.coppice"), encoding="utf-8") as file:
                self.assertEqual([s["text"] for s in client.state["statements"]], file.read().splitlines())

    def test_images_of_materials_have_their_type(self):
        with self.studio.client() as client:
            client.must("run", line="limb t 0,0,0 0,0,1 radius=0.1")
            client.must("run", line="material bark oak width=32")
            client.must("run", line="mesh t levels=0 uv=bark material=bark")
            images = client.must("material", name="t")["images"][0]  # of bark
            self.assertEqual(sorted(images), ["color", "normal", "occlusion", "roughness"])
            status, fields, body = self.studio.ask("GET", f"/blob/{images['color']}")
            self.assertEqual((status, fields["content-type"], body[:4]), (200, "image/png", b"\x89PNG"))
            self.assertEqual(fields["x-content-type-options"], "nosniff")
            for name in ["bark.png", "..%2fbark.png", "%2fetc%2fpasswd"]:
                self.assertEqual(self.studio.ask("GET", f"/blob/{name}")[0], 404)

    def test_uploads_and_downloads_are_the_same_bytes(self):
        data = os.urandom(5 << 20)
        status, _, body = self.studio.ask("PUT", "/file/scan.las", body=data)
        self.assertEqual((status, body), (200, b'{"bytes":5242880,"file":"scan.las"}'))
        self.assertEqual(self.studio.ask("GET", "/file/scan.las")[2], data)
        self.assertEqual(self.studio.ask("PUT", "/file/scan.las", body=b"x")[0], 409)
        self.assertEqual(self.studio.ask("PUT", "/file/scan.las", {"X-Overwrite": "yes"}, body=b"x")[0], 200)
        self.assertEqual(self.studio.ask("GET", "/file/scan.las")[2], b"x")
        self.assertEqual(self.studio.ask("PUT", "/file/slow.las", {"Expect": "100-continue"}, body=b"x")[0], 100)

    def test_all_tabs_see_every_change(self):
        with self.studio.client() as one, self.studio.client() as other:
            one.must("run", line="sphere a")
            other.until(lambda: len(other.state["statements"]) == 1)
            self.assertEqual(other.state["by"], one.name)
            other.must("undo")
            one.until(lambda: not one.state["statements"])
            self.assertEqual(one.state["redo"], ["sphere a"])
            reply = one.request("text", text="sphere b", revision=1)
            self.assertEqual(reply["kind"], "input")  # the other tab has changed the document since revision 1

    def test_nothing_runs_twice_and_nothing_is_lost(self):
        """A connection is closed at different moments; the client reconnects and sends unanswered requests again."""
        name, sent = "a" * 20, {}
        client = self.studio.client(name)
        for number in range(1, 60):
            message = {"id": number, "type": "run", "line": f"sphere s{number} radius={number}"}
            sent[number] = message
            client.send(message)
            if number % 7 == 3:  # closed before or while the request is answered
                client.connection.close()
                known, client = client.answers, self.studio.client(name)
                client.answers.update(known)
                for again in sorted(set(sent) - set(known)):
                    client.send(sent[again])
        for number in sent:
            self.assertTrue(client.answer(number)["ok"], client.answers[number])
        self.assertEqual([s["text"] for s in client.state["statements"]], [m["line"] for m in sent.values()])
        client.connection.close()

    def test_a_page_that_does_not_read_is_cut_and_others_go_on(self):
        with self.studio.client() as good, self.studio.client() as lazy:
            good.must("run", line="sphere s")
            lazy.connection.setsockopt(1, 8, 4096)
            line = "x" * 60_000
            try:
                for _ in range(6000):  # each is refused with an error message; 6000 states and answers accumulate
                    lazy.post("aside", line="list")
                    lazy.post("ping", time=line)
            except (BrokenPipeError, ConnectionResetError):
                pass
            self.assertTrue(good.must("ping")["ok"])
            good.must("run", line="sphere t")

    def test_cancel_goes_past_what_runs(self):
        with self.studio.client() as client:
            client.must("run", line="sphere crown radius=3")
            number = client.post("run", line="for i in 1..400\n pointset generate crown poisson count=20000 name=p${i}\nend")
            time.sleep(0.3)
            begun = time.monotonic()
            client.must("cancel")
            self.assertEqual(client.answer(number)["kind"], "cancelled")
            self.assertLess(time.monotonic() - begun, 10)
            self.assertEqual(len(client.state["statements"]), 1)

    def test_previews_come_before_their_answer(self):
        with self.studio.client() as client:
            client.must("run", line="sphere s")
            number = client.post("preview", seq=1, line="translate s 1 0 0", about={"kind": "solid", "name": "s"})
            client.until(lambda: client.frames or number in client.answers)
            self.assertTrue(client.frames)
            self.assertEqual(read_header(client.frames[0])["seq"], 1)
            self.assertTrue(client.answer(number)["ok"])
            self.assertEqual(len(client.state["statements"]), 1)

    def test_many_at_once(self):
        """Several clients at the same time: the document contains every line once, in any order."""
        failures = []

        def work(at):
            try:
                with self.studio.client() as client:
                    for i in range(20):
                        client.must("run", line=f"sphere s{at}_{i}")
                        key = client.must("show", kind="solid", name=f"s{at}_{i}", form="coarse")["key"]
                        read_header(client.blob(key))
            except Exception as error:  # pylint: disable=broad-except
                failures.append(error)

        threads = [threading.Thread(target=work, args=(at,)) for at in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        with self.studio.client() as client:
            texts = [s["text"] for s in client.state["statements"]]
            self.assertEqual(sorted(texts), sorted(f"sphere s{a}_{i}" for a in range(6) for i in range(20)))


if __name__ == "__main__":
    unittest.main()
