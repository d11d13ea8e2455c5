#!/usr/bin/env python3
"""shell_terminal.py PROGRAM: coppice shell in a terminal: completion, history, Ctrl-C while typing and while running."""

import os
import pty
import select
import sys
import termios
import time

PATIENCE = 60  # [s] maximum time to an answer
PROMPT = "coppice> "


def edits_line(terminal):
    """Returns whether the shell waits for keys, so that Ctrl-C is a key of the line and not a signal."""
    return not termios.tcgetattr(terminal)[3] & termios.ISIG


def answer(terminal, expected):
    """Returns the output up to the expected text and the next prompt at which a line is edited."""
    text, end = "", time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                text += os.read(terminal, 65536).decode(errors="replace")
            except OSError:
                break
        at = text.find(expected)
        if at >= 0 and PROMPT in text[at + len(expected):] and text.endswith(PROMPT) and edits_line(terminal):
            return text
    sys.exit(f"no '{expected}' and prompt in: {text!r}")


def say(terminal, keys, expected):
    os.write(terminal, keys.encode())
    return answer(terminal, expected)


def main():
    child, terminal = pty.fork()
    if child == 0:
        os.environ["TERM"] = "xterm"
        os.execv(sys.argv[1], ["coppice", "shell"])
    answer(terminal, "help lists the commands")
    say(terminal, "sph\tcrown\n", "crown\r\n")
    say(terminal, "describe cr\t\n", "sphere")
    say(terminal, "this goes\x03list\n", "solid      crown")
    say(terminal, "bogus\n", "there is no command 'bogus'")
    say(terminal, "\x1b[A\x1b[A\n", "solid      crown")
    os.write(terminal, b"for i in 1..2\nsphere ball${i}\n")
    say(terminal, "end\n", "end\r\n")
    say(terminal, "list\n", "solid      ball1 ball2 crown")
    say(terminal, "delete ball1 ball2\n", "ball2\r\n")
    os.write(terminal, b"render crown crown.png width=2048 height=2048 samples=4096\n")
    while edits_line(terminal):
        time.sleep(0.01)
    time.sleep(0.5)  # the command takes minutes; Ctrl-C must arrive while it runs
    say(terminal, "\x03", "interrupted")
    say(terminal, "list\n", "solid      crown")
    os.write(terminal, b"quit\n")
    _, status = os.waitpid(child, 0)
    sys.exit(os.waitstatus_to_exitcode(status))


if __name__ == "__main__":
    main()
