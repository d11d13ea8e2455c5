#!/usr/bin/env python3
"""film_test.py PROGRAM: films by a fake ffmpeg that works, fails, or ends at once, and without ffmpeg."""

import os
import pathlib
import subprocess
import sys
import tempfile

WORKS = '#!/bin/sh\nfor last; do :; done\nexec cat > "$last"\n'
FAILS = "#!/bin/sh\ncat > /dev/null\nexit 1\n"
ENDS = "#!/bin/sh\nexit 1\n"
SIZE, FRAMES = 32, 2


def animate(program, folder, script):
    """Returns exit code, output, and the bytes of the film, if any; checks that no hidden file is left."""
    tools = folder / "tools"
    tools.mkdir()
    if script:
        (tools / "ffmpeg").write_text(script)
        (tools / "ffmpeg").chmod(0o755)
    (folder / "tree.swc").write_text("1 1 0 0 0 0.2 -1\n2 1 0 0 2 0.1 1\n")
    words = [program, "animate", "tree.swc", "-o", "film.mp4", "--wind-speed", "9", "--duration", "0.2", "--rate", "10",
             "--width", str(SIZE), "--height", str(SIZE), "--samples", "1", "--no-ground"]
    search = str(tools) + (":/usr/bin:/bin" if script else "")
    run = subprocess.run(words, cwd=folder, env={**os.environ, "PATH": search}, capture_output=True, text=True, check=False)
    film = folder / "film.mp4"
    hidden = [p.name for p in folder.iterdir() if p.name.startswith(".")]
    return run.returncode, run.stderr.strip(), film.read_bytes() if film.exists() else None, hidden


def wrong(program):
    cases = [(WORKS, 0, "", 4 * SIZE * SIZE * FRAMES), (FAILS, 4, "ffmpeg failed", None), (ENDS, 4, "ffmpeg", None),
             (None, 3, "films are made by ffmpeg, which is not found; install it", None)]
    for script, code, text, size in cases:
        with tempfile.TemporaryDirectory() as folder:
            found, said, film, hidden = animate(program, pathlib.Path(folder), script)
        if found != code or text not in said or (len(film) if film is not None else None) != size or hidden:
            yield f"{script!r}: exit code {found}, said {said!r}, film of {film and len(film)} bytes, left {hidden}"


if __name__ == "__main__":
    faults = list(wrong(os.path.abspath(sys.argv[1])))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)
