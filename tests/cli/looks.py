"""Properties of files that are measured without the program: of images, texts, tables and maps."""

import csv
import sqlite3
import struct
import zlib


def nearest(left, above, corner):
    to_left, to_above, to_corner = abs(above - corner), abs(left - corner), abs(left + above - 2 * corner)
    if to_left <= to_above and to_left <= to_corner:
        return left
    return above if to_above <= to_corner else corner


# Filters of the rows of a PNG, which predict a byte from those to the left, above, and upper left.
PREDICTIONS = [lambda left, above, corner: 0, lambda left, above, corner: left, lambda left, above, corner: above,
               lambda left, above, corner: (left + above) // 2, nearest]


def unfiltered(rows, width, depth):
    """Decodes the rows of a PNG, each of which begins with the type of its filter."""
    before = bytes(width * depth)
    for kind, row in rows:
        line, predict = bytearray(depth) + row, PREDICTIONS[kind]
        for i, (above, corner) in enumerate(zip(before, bytes(depth) + before)):
            line[i + depth] = (line[i + depth] + predict(line[i], above, corner)) % 256
        before = bytes(line[depth:])
        yield before


def read_picture(name):
    """Returns width, height, bytes per pixel and the bytes of the rows of a PNG."""
    with open(name, "rb") as file:
        data = file.read()
    width, height, bits, kind = struct.unpack(">IIBB", data[16:26])
    depth, packed, at = {2: 3, 6: 4}[kind], b"", 8
    assert data[:8] == b"\x89PNG\r\n\x1a\n" and bits == 8
    while at < len(data):
        size, chunk = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if chunk == b"IDAT" else b""
        at += size + 12
    raw = zlib.decompress(packed)
    assert len(raw) == height * (width * depth + 1)
    return width, height, depth, raw


def look_at_size(name):
    """Returns the size of an image, and checks that it is complete."""
    width, height, _, _ = read_picture(name)
    return {"width": width, "height": height}


def look_at_picture(name):
    """Returns statistics of an image; fractions are in percent of its pixels."""
    width, height, depth, raw = read_picture(name)
    stride = width * depth + 1
    rows = [(raw[y * stride], raw[y * stride + 1:(y + 1) * stride]) for y in range(height)]
    pixels = [line[i:i + depth] for line in unfiltered(rows, width, depth) for i in range(0, width * depth, depth)]
    share = 100 / len(pixels)
    return {"width": width, "height": height, "shades": len(set(pixels)),
            "clear": share * sum(p[3] == 0 for p in pixels) if depth == 4 else 0,
            "colored": share * sum(max(p[:3]) - min(p[:3]) > 100 for p in pixels)}


def look_at_text(name):
    with open(name, encoding="utf-8") as file:
        lines = file.read().splitlines()
    return {"lines": len(lines), "first": lines[0]}


def look_at_table(name):
    """Returns the numbered rows of a table, and their count; cells are numbers where possible."""
    with open(name, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [{"rows": len(rows)}] + [{key: number_or_text(cell) for key, cell in row.items()} for row in rows]


def number_or_text(cell):
    try:
        return float(cell)
    except ValueError:
        return cell


def look_at_geopackage(name):
    """Returns the number of features and the coordinate reference system of each layer of a GeoPackage."""
    database = sqlite3.connect(f"file:{name}?mode=ro", uri=True)
    return {table: {"features": database.execute(f'SELECT count(geom) FROM "{table}"').fetchone()[0], "srs": srs}
            for table, srs in database.execute("SELECT table_name, srs_id FROM gpkg_contents")}


LOOKS = {"picture": look_at_picture, "size": look_at_size, "text": look_at_text, "table": look_at_table, "geopackage": look_at_geopackage}
