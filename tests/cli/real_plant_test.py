#!/usr/bin/env python3
"""A real maize plant, photographed on a turntable by calibrated cameras, from silhouettes to a mesh; if ../shared/data exists."""
import json, subprocess, sys, tempfile
from pathlib import Path

program, source = sys.argv[1:]
data = Path(source).parent / "shared" / "data" / "images" / "phenomenal_plant_1"
if not data.exists():
    sys.exit(77)


def run(*args):
    subprocess.run([program, *map(str, args)], check=True)


with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    camera = {"phenomenal": str(data / "calibration_cameras.json")}
    views = [camera | {"name": f"side {a}", "camera": "side", "angle": a, "image": str(data / "side" / f"{a}.png")} for a in (0, 60, 120)]
    views.append(camera | {"name": "top", "camera": "top", "angle": 0, "image": str(data / "top_0.png")})
    (folder / "views.sketch.json").write_text(json.dumps({"format": "coppice-sketch", "version": 1, "views": views}))
    run("sketch", folder / "views.sketch.json", "--trace", "-o", folder / "plant.sketch.json")
    run("sketch", folder / "plant.sketch.json", "-o", folder / "plant.swc", "--report", folder / "report.json")
    run("mesh", folder / "plant.swc", "-o", folder / "plant.ply", "--report", folder / "mesh.json")
    run("render", folder / "plant.swc", "-o", folder / "over.png", "--over", data / "side" / "60.png", "--camera", f"{folder}/views.sketch.json:side 60",
        "--samples", "1")
    counts = json.loads((folder / "report.json").read_text())["counts"]
    info = json.loads(subprocess.run([program, "info", str(folder / "plant.swc"), "--json"], check=True, capture_output=True, text=True).stdout)
    print(counts["branches"], counts["refused"], info)
    # It has twelve leaves; the side camera shows it 1,025 pixels high, 1.166 mm each at its distance.
    assert counts["trees"] == 1 and counts["refused"] <= 3, counts
    assert 10 <= counts["branches"] <= 60, counts
    height = info["size_m"][2]
    assert 1.1 < height < 1.25, height
