#!/usr/bin/env python3
"""others.py COPPICE JUDGE OUT CLOUD=SKELETON...: compares skeletons that another program extracted from clouds with those of `coppice extract`, as
Markdown in OUT/others.md. JUDGE is a program that reads a cloud (X Y Z rows) and a skeleton (SWC) and prints figures as a JSON object with the names in
COLUMNS. All files are written to OUT."""
import json
import os
import subprocess
import sys

COLUMNS = (("length, m", "length_m", "{:.0f}"), ("volume, m3", "volume_m3", "{:.3g}"), ("explained", "explained", "{:.2f}"), ("unsupported", "unsupported", "{:.3f}"),
           ("turns back", "zigzag", "{:.3f}"), ("grows outward", "fatter_than_parent", "{:.3f}"), ("diameter, cm", "dbh_skeleton_m", "{:.1f}"),
           ("stem longer than straight", "stem_wobble", "{:.3f}"))


def convert(coppice, source, target):
    if not os.path.exists(target):
        subprocess.run([coppice, "convert", source, "-o", target, "--quiet"], check=True)
    return target


def judged(judge, cloud, skeleton):
    done = subprocess.run([sys.executable, judge, cloud, skeleton], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def shown(figures, key, form):
    value = figures.get(key)
    if value is None:
        return "–"
    return form.format(100 * value if key == "dbh_skeleton_m" else value)


def row(coppice, judge, out, cloud, skeleton):
    name = os.path.splitext(os.path.basename(cloud))[0]
    points = convert(coppice, cloud, os.path.join(out, name + ".xyz"))
    theirs = convert(coppice, skeleton, os.path.join(out, name + "_theirs.swc"))
    ours = os.path.join(out, name + ".swc")
    done = subprocess.run([coppice, "extract", cloud, "-o", ours, "--quiet"], check=False)
    if done.returncode not in (0, 1):
        return f"| {name} | failed |"
    both = [judged(judge, points, s) for s in (theirs, ours)]
    seen = shown({"dbh_skeleton_m": both[0].get("dbh_cloud_m")}, "dbh_skeleton_m", "{:.1f}")
    cells = [", ".join(shown(figures, key, form) for figures in both) for _, key, form in COLUMNS]
    return f"| {name} | {seen} | {' | '.join(cells)} | {'yes' if done.returncode == 1 else ''} |"


def main():
    coppice, judge, out, *pairs = sys.argv[1:]
    os.makedirs(out, exist_ok=True)
    lines = ["| cloud | diameter of the points, cm | " + " | ".join(title for title, _, _ in COLUMNS) + " | in doubt |", "| --- |" + " --- |" * (len(COLUMNS) + 2)]
    lines += [row(coppice, judge, out, *pair.split("=")) for pair in pairs]
    text = "\n".join(lines) + "\n"
    with open(os.path.join(out, "others.md"), "w", encoding="utf-8") as file:
        file.write(text)
    print(text)


if __name__ == "__main__":
    main()
